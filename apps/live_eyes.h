#pragma once

#include <memory>
#include <string>

#include "devices/lcm/link.h"
#include "scene/play/run.h"
#include "scene/watch/eye_frames.h"

/// The pictures and the scene of a live session, over LCM.
namespace headpin::apps {

/// Draws both eyes in a separate process.
///
/// @param how        raw or png, on HEADPIN_EYES at the URL; none: drawn, and shown to nobody
/// @param gl         as render::open_context
/// @param gives_way  to everything else the machine does
std::unique_ptr<scene::FramesBeside> open_eyes(const scene::Stage& stage, const std::string& how,
                                               const std::string& url, const std::string& gl,
                                               bool gives_way);

/// Prints why another OpenGL context than the first one draws.
void say_instead_of(const char* command, const scene::Eyes& eyes);

/// Prints which parts of the scenario's mesh files are not drawn.
void say_not_drawn(const char* command, const scene::Scenario& scenario);

/// Publishes the scene for Drake's viewer at the frame rate, and all of it every five seconds for
/// later viewers.
class Viewer : public scene::Observer {
 public:
  /// @param link  must outlive this
  explicit Viewer(devices::LcmLink& link) : link_(link) {}

  void start(const scene::Session& session) override { show(session, true); }
  void tick(const scene::Session& session) override;

 private:
  void show(const scene::Session& session, bool whole);

  devices::LcmLink& link_;
  std::int64_t frame_ = 0;
};

}  // namespace headpin::apps
