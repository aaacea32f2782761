#pragma once

#include <pybind11/pybind11.h>

/// The Python module `headpin._headpin`. Each part of it adds its functions and classes.
namespace headpin::python {

namespace py = pybind11;

void add_engine(py::module_& module);  ///< headpin.engine
void add_errors(py::module_& module);
void add_frames(py::module_& module);
void add_many(py::module_& module);  ///< replay_many
void add_replay(py::module_& module);
void add_session(py::module_& module);  ///< Session, TrackerSample, MouseSample
void add_trial(py::module_& module);

}  // namespace headpin::python
