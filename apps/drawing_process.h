#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "scene/live/frames_beside.h"

/// Draws a live session's frames in a separate process: if it crashes, only pictures are missing.
namespace headpin::apps {

/// The options of the process.
struct DrawingOrder {
  std::string scenario;  ///< TOML, whole
  std::string eyes;      ///< raw or png, on HEADPIN_EYES at the URL; none: shown to nobody
  std::string url;
  std::string gl;          ///< as render::open_context
  bool gives_way = false;  ///< lowers its priority, if ticks have no real-time priority
  bool first = false;      ///< first start, not a restart: it reports its speed
};

/// Draws in the started process, by the options.
using DrawerMaker = std::unique_ptr<scene::FrameDrawer> (*)(const DrawingOrder& order);

/// Starts the process, and starts it again when it ends or does not answer for half a minute. After
/// three failures without a frame, it is not started again.
///
/// @throws std::runtime_error  with the message of the first process, if that cannot draw
std::unique_ptr<scene::FrameDrawer> draw_in_a_process(DrawingOrder order);

/// The main function of the process: draws the frames that are requested on standard input, a
/// socket, until it is closed.
/// @throws std::runtime_error  when standard input is not such a socket
void serve_frames(DrawerMaker maker);

}  // namespace headpin::apps
