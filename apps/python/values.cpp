#include "apps/python/values.h"

namespace headpin::python {

namespace py = pybind11;

namespace {

/// One value inside another. A list that holds itself ends as Python's RecursionError.
class Deeper {
 public:
  Deeper() {
    if (Py_EnterRecursiveCall(" in a value") != 0) throw py::error_already_set();
  }
  ~Deeper() { Py_LeaveRecursiveCall(); }
  Deeper(const Deeper&) = delete;
  Deeper& operator=(const Deeper&) = delete;
};

/// The values of a list, or the pairs of a dict, with commas.
template <typename Each>
std::string joined(const py::handle& values, char open, char close, const Each& each) {
  std::string all(1, open);
  for (const py::handle one : values) all += (all.size() > 1 ? ", " : "") + each(one);
  return all + close;
}

/// TOML's and JSON's texts are written alike, but TOML takes no halves of a letter, and no U+007F. A half
/// that the text has itself stays one, which TOML refuses.
std::string text_in_toml(const py::handle& text) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  const py::object all =
      dumps(text, py::arg("ensure_ascii") = false).attr("replace")("\x7f", "\\u007f");
  return all.attr("encode")("utf-8", "backslashreplace").cast<std::string>();
}

/// A number in digits, also one of a class that has other words for it, such as an enum.
std::string digits(const PyTypeObject& type, const py::handle& number) {
  PyObject* made = type.tp_repr(number.ptr());
  if (!made) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

}  // namespace

std::string to_toml(const py::handle& value) {
  const Deeper deeper;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value)) return digits(PyLong_Type, value);
  if (py::isinstance<py::float_>(value)) return digits(PyFloat_Type, value);
  if (py::isinstance<py::str>(value)) return text_in_toml(value);
  if (py::hasattr(value, "tolist")) {  // numpy's longdouble stays what it is
    const py::object plain = value.attr("tolist")();
    if (!py::type::of(plain).is(py::type::of(value))) return to_toml(plain);
  }
  if (py::isinstance<py::dict>(value)) {
    return joined(value.attr("items")(), '{', '}', [](const py::handle& pair) {
      const auto [key, one] = pair.cast<std::pair<py::str, py::object>>();
      return std::string(key) + " = " + to_toml(one);
    });
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return joined(value, '[', ']', [](const py::handle& one) { return to_toml(one); });
  }
  throw py::type_error("expected a number, bool, text, list or dict, found " +
                       std::string(py::str(py::type::of(value))));
}

}  // namespace headpin::python
