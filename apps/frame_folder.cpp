#include "apps/frame_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "base/output_file.h"
#include "render/flow.h"
#include "render/png.h"
#include "scene/looks/looks.h"

namespace headpin::apps {

namespace {

constexpr std::array<const char*, 2> kEyes = {"left", "right"};
constexpr const char* kIndex = "frames.csv";

/// The rows of both eyes side by side.
template <typename T>
std::vector<T> beside(const std::vector<T>& left, const std::vector<T>& right, int width) {
  std::vector<T> both;
  both.reserve(left.size() + right.size());
  for (auto l = left.begin(), r = right.begin(); l != left.end(); l += width, r += width) {
    both.insert(both.end(), l, l + width);
    both.insert(both.end(), r, r + width);
  }
  return both;
}

render::Labels side_by_side(const render::Labels& left, const render::Labels& right) {
  return {2 * left.width, left.height, beside(left.id, right.id, left.width),
          beside(left.depth, right.depth, left.width)};
}

/// Depth in millimetres: 0 without an object, at most 65535.
std::uint16_t millimetres(float depth) {
  if (!std::isfinite(depth)) return 0;
  return static_cast<std::uint16_t>(std::lround(std::clamp(1000.0F * depth, 0.0F, 65535.0F)));
}

using Flow = std::vector<std::array<float, 2>>;

/// Middlebury's format: a number that tells the byte order, width, height, and the flow of each
/// pixel.
void write_flo(const std::string& path, const Flow& flow, std::int32_t width, std::int32_t height) {
  constexpr float kTag = 202021.25F;
  base::OutputFile file(path, {.overwrite = true, .durable = false});
  file.write(&kTag, sizeof kTag);
  file.write(&width, sizeof width);
  file.write(&height, sizeof height);
  file.write(flow.data(), flow.size() * sizeof flow[0]);
  file.commit();
}

}  // namespace

FrameFolder::FrameFolder(base::OutputFolder& folder, const FrameFiles& files, double pixel_aspect,
                         const std::map<std::uint32_t, std::string>& objects)
    : folder_(folder), files_(files), pixel_aspect_(pixel_aspect), index_(folder_.file(kIndex)) {
  index_ << "frame,time_s,tick";
  for (const char* eye : kEyes) {
    for (const char* name : {"x", "y", "z", "qw", "qx", "qy", "qz"})
      index_ << ',' << eye << '_' << name;
    index_ << ',' << eye << "_hash";
  }
  index_ << '\n';
  if (files_.ids) write_names(objects);
}

void FrameFolder::write_names(const std::map<std::uint32_t, std::string>& objects) {
  base::OutputText names(folder_.file("ids.csv"));
  names << "id,is\n0,nothing\n";
  for (const auto& [id, name] : objects) names << fmt::format("{},{}\n", id, name);
  names.close();
}

void FrameFolder::add(const scene::EyeFrame& frame) {
  const bool wanted = frame.number != files_.flow_to;
  if (wanted) write_row(frame);
  wait();
  writing_ = std::async(std::launch::async, [this, frame, wanted] {
    if (before_) write_flow(*before_, frame);
    if (wanted) write_files(frame);
    if (files_.flow) before_ = frame;
  });
}

void FrameFolder::write_row(const scene::EyeFrame& frame) {
  index_ << fmt::format("{},{:.6f},{}", frame.number, seconds(frame.time), frame.tick);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Pose& X_WE = frame.views[eye].X_WE;
    index_ << fmt::format(",{},{},{},{},{},{},{},{:016x}", X_WE.p.x(), X_WE.p.y(), X_WE.p.z(),
                          X_WE.q.w(), X_WE.q.x(), X_WE.q.y(), X_WE.q.z(),
                          render::pixel_hash(frame.images[eye]));
  }
  index_ << '\n';
}

void FrameFolder::write_files(const scene::EyeFrame& frame) {
  if (files_.side_by_side) {
    const std::string stem = fmt::format("both_{:06}", frame.number);
    render::write_png(folder_.file(stem + ".png"),
                      render::side_by_side(frame.images[0], frame.images[1]), pixel_aspect_);
    if (files_.labels()) write_labels(side_by_side(frame.labels[0], frame.labels[1]), stem);
    return;
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::string stem = fmt::format("{}_{:06}", kEyes[eye], frame.number);
    render::write_png(folder_.file(stem + ".png"), frame.images[eye], pixel_aspect_);
    if (files_.labels()) write_labels(frame.labels[eye], stem);
  }
}

void FrameFolder::write_flow(const scene::EyeFrame& before, const scene::EyeFrame& after) {
  std::array<Flow, 2> flow;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    flow[eye] = render::flow({before.views[eye], before.items}, before.labels[eye],
                             {after.views[eye], after.items});
  }
  const int width = before.labels[0].width, height = before.labels[0].height;
  const auto file = [&](const char* name) {
    return folder_.file(fmt::format("{}_{:06}.flo", name, before.number)).string();
  };
  if (files_.side_by_side) {
    return write_flo(file("both"), beside(flow[0], flow[1], width), 2 * width, height);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    write_flo(file(kEyes[eye]), flow[eye], width, height);
  }
}

void FrameFolder::write_labels(const render::Labels& labels, const std::string& stem) {
  const auto write_grey = [&](const char* what, const std::vector<std::uint16_t>& values) {
    render::write_png16(folder_.file(fmt::format("{}_{}.png", stem, what)), values, labels.width,
                        labels.height, pixel_aspect_);
  };
  std::vector<std::uint16_t> values(labels.id.size());
  if (files_.ids) {
    std::ranges::transform(labels.id, values.begin(), [](std::uint32_t id) {
      return static_cast<std::uint16_t>(std::min<std::uint32_t>(id, 65535));
    });
    write_grey("ids", values);
  }
  if (!files_.depth) return;
  std::ranges::transform(labels.depth, values.begin(), millimetres);
  write_grey("depth", values);
  base::OutputFile raw(folder_.file(stem + "_depth.raw").string(),
                       {.overwrite = true, .durable = false});
  raw.write(labels.depth.data(), labels.depth.size() * sizeof(float));
  raw.commit();
}

void FrameFolder::finish() {
  wait();
  index_.close();
}

void FrameFolder::commit() {
  folder_.commit(kIndex);
}

void FrameFolder::wait() {
  if (writing_.valid()) writing_.get();
}

}  // namespace headpin::apps
