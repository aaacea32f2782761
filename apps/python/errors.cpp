#include "apps/python/errors.h"

#include <cerrno>

#include "apps/python/module.h"
#include "apps/python/values.h"

namespace headpin::python {

namespace {

/// Sets an OSError with its errno. The words stay ours: Python says others where there is a filename.
void set_os_error(const py::handle& kind, int number, const char* words) {
  const py::object error = kind(to_text(words));
  error.attr("errno") = number;
  PyErr_SetObject(kind.ptr(), error.ptr());
}

/// The errors that Python has a class for.
void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const FileMissing& error) {
    set_os_error(PyExc_FileNotFoundError, ENOENT, error.what());
  } catch (const NotPermitted& error) {
    set_os_error(PyExc_PermissionError, EACCES, error.what());
  } catch (const FileIsThere& error) {
    set_os_error(PyExc_FileExistsError, EEXIST, error.what());
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
