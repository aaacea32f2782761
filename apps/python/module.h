#pragma once

#include <pybind11/pybind11.h>

/// The Python module `headpin._headpin`. Each part of it adds its functions and classes.
namespace headpin::python {

namespace py = pybind11;

}  // namespace headpin::python
