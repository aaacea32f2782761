#include "scene/live/lcm_views.h"

#include <array>
#include <functional>
#include <future>
#include <vector>

#include "render/png.h"
#include "scene/watch/viewer.h"

namespace headpin::scene {

void LcmEyes::add(const EyeFrame& frame) {
  std::array<std::vector<std::uint8_t>, 2> files;
  if (png_) {  // side by side
    auto left = std::async(std::launch::async, render::encode_png, std::cref(frame.images[0]),
                           pixel_aspect_);
    files[1] = render::encode_png(frame.images[1], pixel_aspect_);
    files[0] = left.get();
  }
  link_.publish({.sequence = static_cast<std::int32_t>(frame.number),
                 .time = frame.time,
                 .width = frame.images[0].width,
                 .height = frame.images[0].height,
                 .png = png_,
                 .left = png_ ? files[0] : frame.images[0].rgb,
                 .right = png_ ? files[1] : frame.images[1].rgb});
}

void LcmScene::tick(const Session& session) {
  const std::int64_t fps = session.scenario().rates.frame_hz;
  if (tick_time(frame_, fps) > session.now()) return;
  show(session, frame_ % (5 * fps) == 0);
  ++frame_;
}

void LcmScene::show(const Session& session, bool whole) {
  if (whole) link_.publish(viewer_links(session));
  link_.publish(session.now(), viewer_poses(session));
}

}  // namespace headpin::scene
