#include "apps/python/module.h"

#include "devices/base/version.h"

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
}
