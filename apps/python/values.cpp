#include "apps/python/values.h"

namespace headpin::python {

namespace py = pybind11;

namespace {

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

}  // namespace

std::string to_toml(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value)) {
    return py::str(py::repr(value));
  }
  if (py::isinstance<py::str>(value)) return text_in_toml(value);
  if (py::hasattr(value, "tolist")) return to_toml(value.attr("tolist")());
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
