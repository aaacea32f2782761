#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/scenario/fields.h"
#include "scene/stage/condition.h"

/// The values of a condition, each with its name, range and meaning.
namespace headpin::scene {

template <Choice T>
NameList names_of_these(std::initializer_list<T> values) {
  NameList names;
  for (const T value : values) names.push_back(name_of(value));
  return names;
}

inline std::string responses_in_words() {
  std::string words = "collision response; what each one conserves:";
  for (const engine::Response& response : engine::responses()) {
    words += fmt::format("\n{}: {}", response.name, response.keeps);
  }
  return words;
}

/// Lists the values once, but for `look` and `set`: options and arguments are made of this list, and
/// apply() checks by it. A visitor takes field(name, value, allowed, meaning); what is allowed is a Range or the
/// names of a NameList.
template <typename V, typename C>
void visit_values(V& v, C& c) {
  v.field("elasticity", c.elasticity, kUnit,
          "coefficient of restitution of every object (the paper: elasticity); two objects "
          "in contact: the product");
  v.field("friction", c.friction, kUnit,
          "friction of every object; two objects in contact: the product");
  v.field("shape", c.shape, names_of_these({SkittleShape::ellipsoid, SkittleShape::parts}),
          "collision shape of the skittles: ellipsoid or true");
  v.field("response", c.response, response_names(), responses_in_words());
  v.field("detection", c.detection, names_of_these({Detection::converged, Detection::paper}),
          "collision detection: converged, or with the paper's cap on iterations");
  v.field("iterations", c.iterations, Range{5, 20},
          "cap on the iterations of a detection query, 5 to 20");
  v.field("warm", c.warm, kAny,
          "warm start: each query of paper detection starts from the last normal (not in the "
          "paper)");
}

/// @throws std::invalid_argument  if the number is not in the range
template <typename T>
void expect_value(std::string_view name, T found, const Range& allowed) {
  const auto number = static_cast<double>(found);
  if (number >= allowed.low && number <= allowed.high) return;
  throw std::invalid_argument(
      fmt::format("{}: expected {} to {}, found {}", name, allowed.low, allowed.high, found));
}

/// @throws std::invalid_argument  if it is none of the names
inline void expect_value(std::string_view name, const std::string& found, const NameList& allowed) {
  for (const std::string_view one : allowed) {
    if (one == found) return;
  }
  throw std::invalid_argument(
      fmt::format("{}: expected one of {}, found {}", name, fmt::join(allowed, ", "), found));
}

}  // namespace headpin::scene
