#include "apps/python/condition.h"

#include <algorithm>
#include <initializer_list>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/python/values.h"
#include "engine/response.h"

namespace headpin::python {

namespace py = pybind11;
using scene::Detection;
using scene::SkittleShape;

namespace {

double number(const std::string& key, const py::handle& value) {
  const double found = value.cast<double>();
  if (found >= 0.0 && found <= 1.0) return found;
  throw std::invalid_argument(fmt::format("{}: expected 0 to 1, found {}", key, found));
}

std::int64_t cap(const py::handle& value) {
  const auto found = value.cast<std::int64_t>();
  if (found >= 5 && found <= 20) return found;
  throw std::invalid_argument(fmt::format("iterations: expected 5 to 20, found {}", found));
}

std::string one_of(const std::vector<std::string>& names, const std::string& key,
                   const py::handle& value) {
  const std::string found = py::str(value);
  if (std::ranges::find(names, found) != names.end()) return found;
  throw std::invalid_argument(
      fmt::format("{}: expected one of {}, found {}", key, fmt::join(names, ", "), found));
}

template <scene::Choice T>
T one_of(std::initializer_list<T> values, const std::string& key, const py::handle& value) {
  std::vector<std::string> names;
  for (const T one : values) names.emplace_back(scene::name_of(one));
  return *scene::value_named<T>(one_of(names, key, value));
}

std::vector<std::string> responses() {
  std::vector<std::string> names;
  for (const engine::Response& response : engine::responses()) names.emplace_back(response.name);
  return names;
}

void take(scene::Condition& condition, const std::string& key, const py::handle& value) {
  if (key == "friction") {
    condition.friction = number(key, value);
  } else if (key == "elasticity") {
    condition.elasticity = number(key, value);
  } else if (key == "shape") {
    condition.shape = one_of({SkittleShape::ellipsoid, SkittleShape::parts}, key, value);
  } else if (key == "response") {
    condition.response = one_of(responses(), key, value);
  } else if (key == "detection") {
    condition.detection = one_of({Detection::converged, Detection::paper}, key, value);
  } else if (key == "iterations") {
    condition.iterations = cap(value);
  } else if (key == "warm") {
    condition.warm = value.cast<bool>();
  } else if (key == "set") {
    for (const auto& [name, one] : value.cast<py::dict>()) {
      condition.set.push_back(std::string(py::str(name)) + "=" + to_toml(one));
    }
  } else {
    throw py::type_error(fmt::format("unexpected argument '{}'", key));
  }
}

}  // namespace

scene::Condition condition_of(const py::kwargs& words) {
  scene::Condition condition;
  for (const auto& [key, value] : words) {
    if (!value.is_none()) take(condition, py::str(key), value);
  }
  return condition;
}

}  // namespace headpin::python
