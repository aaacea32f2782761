#include "apps/python/module.h"

#include "devices/base/version.h"

PYBIND11_MODULE(_headpin, module) {
  module.doc() = "The compiled part of headpin.";
  module.attr("__version__") = headpin::devices::software_version();
  headpin::python::add_engine(module);
  headpin::python::add_many(module);
  headpin::python::add_session(module);
}
