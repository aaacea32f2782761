#include "apps/python/condition.h"

#include <string>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

#include "apps/python/values.h"
#include "scene/stage/condition_fields.h"

namespace headpin::python {

namespace py = pybind11;

namespace {

/// Takes the value of one argument, if it is one of a condition's.
struct ValueTaker {
  std::string_view key;
  const py::handle& value;
  bool taken = false;

  template <typename T>
  void field(std::string_view name, std::optional<T>& into, const scene::Range& allowed,
             const std::string& /*meaning*/) {
    if (name != key) return;
    into = argument<T>(name, value);
    if constexpr (!std::is_same_v<T, bool>) scene::expect_value(name, *into, allowed);
    taken = true;
  }
  template <typename T>
  void field(std::string_view name, std::optional<T>& into, const scene::NameList& allowed,
             const std::string& /*meaning*/) {
    if (name != key) return;
    const std::string found = py::str(value);
    scene::expect_value(name, found, allowed);
    if constexpr (scene::Choice<T>) {
      into = scene::value_named<T>(found);
    } else {
      into = found;
    }
    taken = true;
  }
};

void take(scene::Condition& condition, const std::string& key, const py::handle& value) {
  if (key == "set") {
    for (const auto& [name, one] : argument<py::dict>(key, value)) {
      condition.set.push_back(std::string(py::str(name)) + "=" + to_toml(one));
    }
    return;
  }
  ValueTaker taker{key, value};
  scene::visit_values(taker, condition);
  if (!taker.taken) throw py::type_error(fmt::format("unexpected argument '{}'", key));
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
