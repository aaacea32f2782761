#pragma once

#include <memory>
#include <optional>
#include <string>

#include <pybind11/pybind11.h>

#include "apps/python/open_trial.h"

namespace headpin::python {

struct FramesWanted {
  std::string eye;  ///< left, right or both
  bool depth = false, ids = false;
  std::optional<std::int64_t> fps;
  std::optional<std::string> look;
  std::string gl;
};

/// Draws frames of a trial: one Frame for a number, a list for several.
pybind11::object frames(const std::shared_ptr<OpenTrial>& trial, const pybind11::object& numbers,
                        const FramesWanted& wanted);

inline constexpr const char* kFramesWords =
    R"(Draws what the eyes saw; simulates the trial up to there.

    numbers   number of a frame, from 0: gives one Frame; or several numbers: gives a list of Frames
    eye       "left", "right" or "both"; with both, all arrays get a first axis of two, left first
    depth     also the distance of each pixel along the viewing axis
    ids       also the object that each pixel shows
    fps       frame rate; default: that of the scenario
    look      rendering quality, as --look of `headpin frames`; default: that of the trial
    gl        OpenGL, as --gl of `headpin frames`; default: the first that works

Many frames in one call are much faster than one call each.
Raises ValueError for a frame that the trial does not have, RuntimeError when nothing can be drawn.)";

}  // namespace headpin::python
