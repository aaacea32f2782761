#include "scene/watch/eye_frames.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace headpin::scene {

namespace {

/// Draws a frame and its wanted extras.
void draw_frame(Eyes& eyes, Glimpse g, const FrameExtras& extras, EyeFrame& frame) {
  g.X_WC = extras.X_WC;
  frame.views = extras.pictures ? see(eyes, g, frame.images) : views_of(eyes, g);
  if (!extras.labels) return;
  frame.labels = see_labels(eyes, g);
  frame.items = list_of(eyes, g).items;
}

}  // namespace

FrameRecord record_of(const EyeFrame& frame) {
  FrameRecord record;
  record.time = frame.time;
  record.frame = frame.number;
  record.tick = frame.tick;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    record.X_WE[eye] = frame.views[eye].X_WE;
    record.hash[eye] = render::pixel_hash(frame.images[eye]);
  }
  return record;
}

void FrameByFrame::tick(const Session& session) {
  for (; frame_.number < plan_.frames; ++frame_.number) {
    frame_.time = tick_time(frame_.number, plan_.fps);
    if (frame_.time > session.now()) break;
    if (!plan_.wanted(frame_.number)) continue;
    frame_.tick = session.tick;
    const Pose X_WD = head_pose(session, frame_.time).value_or(plan_.X_WD_first);
    draw_frame(eyes_, before_.glimpse(session, frame_.time, X_WD), plan_.extras, frame_);
    for (FrameSink* sink : sinks_) sink->add(frame_);
    plan_.progress(++drawn_);
  }
  // If every frame is at a tick, nothing is drawn between ticks.
  if (session.scenario().rates.physics_hz % plan_.fps != 0) before_.keep(session);
}

FramesAsShown::FramesAsShown(Eyes& eyes, TrialPlayer& recorded, Plan plan,
                             std::vector<FrameSink*> sinks)
    : eyes_(eyes), recorded_(recorded), plan_(std::move(plan)), sinks_(std::move(sinks)) {
  if (!recorded.has_frames()) {
    throw std::runtime_error(
        "the trial has no recorded frames; expected one that was recorded live");
  }
}

void FramesAsShown::tick(const Session& session) {
  while (const std::optional<FrameRecord> recorded = recorded_.next_frame(session.tick)) {
    if (!plan_.wanted(recorded->frame)) continue;
    if (const auto X_WD = head_pose(session)) draw(*recorded, session, *X_WD);
  }
}

void FramesAsShown::draw(const FrameRecord& recorded, const Session& session, const Pose& X_WD) {
  frame_.number = recorded.frame;
  frame_.tick = session.tick;
  frame_.time = session.now();
  draw_frame(eyes_, glimpse(session, X_WD), plan_.extras, frame_);
  if (plan_.compare) {
    compare(recorded);
    ++compared_;
  }
  for (FrameSink* sink : sinks_) sink->add(frame_);
  plan_.progress(++drawn_);
}

void FramesAsShown::compare(const FrameRecord& recorded) const {
  const FrameRecord drawn = record_of(frame_);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (drawn.hash[eye] == recorded.hash[eye]) continue;
    throw std::runtime_error(
        fmt::format("frame {} (tick {}, {:.6f} s) differs from the recording, first difference in "
                    "the {} eye: expected picture {:016x}, found {:016x}, drawn by {}",
                    frame_.number, frame_.tick, seconds(frame_.time), eye == 0 ? "left" : "right",
                    recorded.hash[eye], drawn.hash[eye], eyes_.renderer.description()));
  }
}

}  // namespace headpin::scene
