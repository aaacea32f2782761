#pragma once

#include <vector>

#include "apps/python/module.h"
#include "devices/base/sample.h"

namespace headpin::python {

/// The classes TrackerSample and MouseSample.
void add_samples(py::module_& module);

/// @param what  a sample, samples, or rows of the tables `trackers` or `buttons` (docs/tables.md)
/// @throws std::invalid_argument  for something else, and for poses and times that are none
std::vector<devices::Sample> samples_of(const py::object& what);

}  // namespace headpin::python
