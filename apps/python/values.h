#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/pybind11.h>

/// Values between C++ and Python.
namespace headpin::python {

/// A text; bytes that are not UTF-8 are replaced, as in `--json`.
inline pybind11::str to_text(std::string_view text) {
  PyObject* made =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
  if (!made) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::str>(made);
}

/// None, bool, int, float, str, list or dict, with the order of the keys.
template <typename Json>
pybind11::object to_python(const Json& json) {
  if (json.is_null()) return pybind11::none();
  if (json.is_boolean()) return pybind11::bool_(json.template get<bool>());
  if (json.is_number_unsigned()) return pybind11::int_(json.template get<std::uint64_t>());
  if (json.is_number_integer()) return pybind11::int_(json.template get<std::int64_t>());
  if (json.is_number()) return pybind11::float_(json.template get<double>());
  if (json.is_string()) return to_text(json.template get_ref<const std::string&>());
  if (json.is_array()) {
    pybind11::list list;
    for (const Json& one : json) list.append(to_python(one));
    return list;
  }
  pybind11::dict dict;
  for (const auto& [key, value] : json.items()) dict[to_text(key)] = to_python(value);
  return dict;
}

/// How messages call the values that become a T.
template <typename T>
constexpr std::string_view name_of_type() {
  if (std::is_same_v<T, bool>) return "True or False";
  if (std::is_integral_v<T>) return "a whole number";
  if (std::is_floating_point_v<T>) return "a number";
  if (std::is_same_v<T, pybind11::dict>) return "a dict";
  return "whole numbers";
}

/// The value of an argument.
/// @throws pybind11::type_error  for another type, naming the argument; also for True and False as a number
template <typename T>
T argument(std::string_view name, const pybind11::handle& value) {
  try {
    const bool is_dict = pybind11::hasattr(value, "keys");
    const bool is_bool = pybind11::isinstance<pybind11::bool_>(value);
    constexpr bool kOfNumber = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
    const bool fits = kOfNumber ? !is_bool : !std::is_same_v<T, pybind11::dict> || is_dict;
    if (fits) return value.cast<T>();
  } catch (const pybind11::cast_error&) {
    PyErr_Clear();  // the words below are ours
  }
  const std::string found = pybind11::repr(value);
  throw pybind11::type_error(
      fmt::format("{}: expected {}, found {}", name, name_of_type<T>(), found.substr(0, 60)));
}

/// A value as scenarios write it in TOML, for `set={"ball.mass": 5}`: a number, bool, text, or a
/// list or dict of such. Arrays of numpy are lists.
/// @throws pybind11::type_error  for anything else
std::string to_toml(const pybind11::handle& value);

}  // namespace headpin::python
