#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "scene/watch/eye_frames.h"

/// A live session's frames, drawn in a process of its own: when that crashes, pictures are missing
/// and nothing else is.
namespace headpin::apps {

/// What the process is told before the first frame.
struct DrawingOrder {
  std::string scenario;  ///< TOML, whole
  std::string eyes;      ///< raw or png, on HEADPIN_EYES at the URL; none: shown to nobody
  std::string url;
  std::string gl;          ///< as render::open_context
  bool gives_way = false;  ///< to others: what ticks are made by is not before them anyhow
  bool first = false;      ///< and not one that is started again: says how fast it is
};

/// Does the work in the process that is started: draws with what it makes of the order.
using DrawerMaker = std::unique_ptr<scene::FrameDrawer> (*)(const DrawingOrder& order);

/// Starts the process, and starts it again when it ends or says nothing for half a minute. After
/// three ends in a row without a frame there are no more pictures.
///
/// @throws std::runtime_error  with what the process says, when the first one does not come to draw
std::unique_ptr<scene::FrameDrawer> draw_in_a_process(DrawingOrder order);

/// What the process does: frames that are asked for at standard input, a socket, until that closes.
/// @throws std::runtime_error  when standard input is no such thing
void serve_frames(DrawerMaker maker);

}  // namespace headpin::apps
