#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/output_folder.h"

/// Draws the frames of a folder in parts, by several processes or after an interruption.
namespace headpin::apps {

struct FrameParts {
  std::string folder;                  ///< the result; parts are in FOLDER.parts until then
  std::string trial;                   ///< its file
  std::vector<std::string> arguments;  ///< of `headpin frames`, but for trial, folder and frames
  std::vector<std::int64_t> frames;    ///< rising
  bool flow = false;                   ///< of each part's last frame to the next part's first
  int jobs = 1;                        ///< processes at a time
  bool resume = false;                 ///< continues with existing parts, and keeps them
  std::string made_by;                 ///< identifies the renderer: parts of others are refused
  std::function<void(std::int64_t frames)> progress;
};

/// What came of the parts.
struct DrawnParts {
  std::int64_t frames = 0;         ///< in the folder; fewer than wanted where some cannot be drawn
  std::int64_t there_already = 0;  ///< wanted ones of parts that were drawn before
};

/// Draws each part with a separate `headpin frames`, into a folder that is complete or absent, and
/// joins the parts. The files are the same as those of one run.
///
/// @param result  of `folder`; is committed
/// @throws std::runtime_error  with the message of a process that fails, or when existing parts are
///                             of another job
/// @throws base::Busy         when another headpin draws them
/// @throws Stopped             by a signal; with `resume`, finished parts stay
DrawnParts draw_in_parts(const FrameParts& parts, base::OutputFolder& result);

}  // namespace headpin::apps
