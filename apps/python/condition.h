#pragma once

#include <pybind11/pybind11.h>

#include "scene/stage/condition.h"

namespace headpin::python {

/// The condition that keyword arguments ask for: the options of the commands, and `set`, a dict of keys of the
/// scenario.
/// @throws std::invalid_argument  for a value that the commands refuse
scene::Condition condition_of(const pybind11::kwargs& words);

/// What docstrings say about these arguments.
inline constexpr const char* kConditionWords = R"(What is not given stays as in the trial:
    friction, elasticity   of every object, 0 to 1; those of two objects in contact multiply
    shape                  collision shape of the skittles: "ellipsoid" or "true"
    response               collision response: "paper", "coulomb", ... (headpin help replay)
    detection              "converged" or "paper"
    iterations             cap on the iterations of a detection query, 5 to 20
    warm                   whether queries of paper detection start from the last normal
    set                    dict of any other keys of the scenario: {"ball.mass": 5.0}
Raises ValueError for a value or key that the commands refuse.)";

}  // namespace headpin::python
