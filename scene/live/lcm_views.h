#pragma once

#include <cstdint>
#include <string>

#include "devices/lcm/link.h"
#include "scene/play/run.h"
#include "scene/watch/eye_frames.h"

/// The pictures and the scene of a live session, over LCM.
namespace headpin::scene {

/// Publishes the pictures of both eyes, raw or as PNG.
class LcmEyes : public FrameSink {
 public:
  /// @param pixel_aspect  width by height of a pixel, as a PNG file has it
  LcmEyes(const std::string& url, bool png, double pixel_aspect)
      : link_(url), png_(png), pixel_aspect_(pixel_aspect) {}

  void add(const EyeFrame& frame) override;

 private:
  devices::LcmLink link_;
  bool png_;
  double pixel_aspect_;
};

/// Publishes the scene for Drake's viewer at the frame rate, and all of it every five seconds for
/// later viewers.
class LcmScene : public Observer {
 public:
  /// @param link  must outlive this
  explicit LcmScene(devices::LcmLink& link) : link_(link) {}

  void start(const Session& session) override { show(session, true); }
  void tick(const Session& session) override;

 private:
  void show(const Session& session, bool whole);

  devices::LcmLink& link_;
  std::int64_t frame_ = 0;
};

}  // namespace headpin::scene
