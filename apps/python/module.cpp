#include "apps/python/module.h"

#include "devices/base/version.h"

namespace headpin::python {
namespace {

/// Refuses every use of an object without a value: only `__new__` made it, or its own `__init__` uses it
/// before it calls that of its class. pybind11 would take memory for a value, and what is in there for one.
void refuse_objects_without_value(const py::module_& module) {
  for (const auto& [name, what] : py::dict(module.attr("__dict__"))) {
    if (!py::isinstance<py::type>(what)) continue;
    py::detail::type_info* const type =
        py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(what.ptr()));
    if (type == nullptr) continue;  // an exception
    type->operator_new = [](std::size_t /*size*/) -> void* {
      throw py::type_error(
          "expected an object that was made by a call of its class; found one whose __init__ was "
          "not called");
    };
  }
}

}  // namespace
}  // namespace headpin::python

PYBIND11_MODULE(_headpin, module) {
  using namespace headpin::python;
  module.doc() = "The compiled part of headpin.";
  module.attr("__version__") = headpin::devices::software_version();
  add_errors(module);
  add_frames(module);  // before add_replay and add_trial, whose signatures name their classes
  add_replay(module);
  add_trial(module);
  add_engine(module);
  add_many(module);
  add_session(module);
  refuse_objects_without_value(module);
  refuse_objects_without_value(module.attr("_engine"));
}
