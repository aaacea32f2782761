#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "files/output_folder.h"

/// Frames of a folder drawn part by part, by several processes or after a stop.
namespace headpin::apps {

struct FrameParts {
  std::string folder;                  ///< what it becomes; parts are in FOLDER.parts until then
  std::string trial;                   ///< its file
  std::vector<std::string> arguments;  ///< of `headpin frames`, but for trial, folder and frames
  std::vector<std::int64_t> frames;    ///< rising
  int jobs = 1;                        ///< processes at a time
  bool resume = false;                 ///< goes on with the parts that are there, and keeps them
  std::string made_by;                 ///< of what draws: parts of another are refused
  std::function<void(std::int64_t frames)> progress;
};

/// Has each part drawn by a `headpin frames` of its own, into a folder that is whole or not there,
/// and puts them together: the same files as drawn in one go.
///
/// @param result  of `folder`; is committed
/// @return        how many frames were there already
/// @throws std::runtime_error  with what a process says that fails, or when the parts that are
///                             there are of something else
/// @throws files::Busy         when another of us draws them
/// @throws Stopped             when told to; with `resume`, the parts that are done stay
std::int64_t draw_in_parts(const FrameParts& parts, files::OutputFolder& result);

}  // namespace headpin::apps
