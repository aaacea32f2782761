#include "apps/python/errors.h"

#include "apps/python/module.h"

namespace headpin::python {

namespace {

/// The errors that Python has a class for.
void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const FileMissing& error) {
    PyErr_SetString(PyExc_FileNotFoundError, error.what());
  } catch (const NotPermitted& error) {
    PyErr_SetString(PyExc_PermissionError, error.what());
  } catch (const FileIsThere& error) {
    PyErr_SetString(PyExc_FileExistsError, error.what());
  } catch (const NotWritten& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace

void add_errors(py::module_& module) {
  py::register_exception_translator(translate);
  auto& damaged = py::register_exception<DamagedTrial>(module, "DamagedTrial", PyExc_RuntimeError);
  damaged.attr("__module__") = "headpin";
  damaged.attr("__doc__") = "The file is no trial, or too little of it can be read.";
}

}  // namespace headpin::python
