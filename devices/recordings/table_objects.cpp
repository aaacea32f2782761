#include "devices/recordings/table_objects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/table_trigger.h"

namespace headpin::devices {
namespace {

template <std::size_t N>
using Places = std::array<std::optional<std::size_t>, N>;

/// Matrices count from 0 or from 1: "m00" to "m23", or "r11" to "r33".
void take_matrix(PartColumns& part, const std::map<std::size_t, std::size_t>& elements) {
  const auto has = [&](std::size_t digit) {
    return std::ranges::any_of(elements, [&](const auto& element) {
      return element.first / 10 == digit || element.first % 10 == digit;
    });
  };
  const std::size_t from = has(3) && !has(0) ? 1 : 0;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const auto found = elements.find(10 * (row + from) + column + from);
      if (found == elements.end()) continue;
      if (column < 3) {
        part.matrix[3 * row + column] = found->second;
      } else if (!part.position[row]) {
        part.position[row] = found->second;
      }
    }
  }
}

template <std::size_t N>
bool any(const Places<N>& columns) {
  return std::ranges::any_of(columns, [](const auto& c) { return c.has_value(); });
}

template <std::size_t N>
Places<N> over(const Places<N>& told, Places<N> found) {
  for (std::size_t i = 0; i < N; ++i) {
    if (told[i]) found[i] = told[i];
  }
  return found;
}

/// Three numbers that are called a rotation, without a fourth, are angles.
Places<3> angles_in(const Places<4>& quaternion) {
  if (quaternion[0]) return {};
  return {quaternion[1], quaternion[2], quaternion[3]};
}

/// The set of a rotation's columns that is whole; else what all sets have together.
Places<4> quaternion_in(const std::vector<RotationSet>& sets) {
  Places<4> merged{};
  for (const RotationSet& set : sets) {
    if (whole(set.columns)) return set.columns;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!merged[i]) merged[i] = set.columns[i];
    }
  }
  return merged;
}

/// The columns of a set, which is added if it is not there.
Places<4>& columns_of(std::vector<RotationSet>& sets, const std::string& name) {
  const auto found = std::ranges::find(sets, name, &RotationSet::name);
  return (found == sets.end() ? sets.emplace_back(RotationSet{.name = name}) : *found).columns;
}

/// "head rot" of "head_rot_x" and "head q" of "head_qx": the name without its letter.
std::string set_of(const std::string& name) {
  std::vector<std::string> words = words_of(name);
  while (words.size() > 1 && is_one_of(words.back(), {"deg", "rad", "degrees"})) words.pop_back();
  if (!words.empty()) words.back().pop_back();
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace

void put(Object& object, const Component& component, std::size_t column, const std::string& name) {
  PartColumns& part = object.columns;
  const auto set = [&](std::optional<std::size_t>& place) {
    if (!place) place = column;
  };
  switch (component.quantity) {
    case Quantity::position:
      set(part.position[component.index]);
      break;
    case Quantity::quaternion:
      set(columns_of(object.rotations, set_of(name))[component.index]);
      break;
    case Quantity::angle:
      set(part.angles[component.index]);
      break;
    case Quantity::matrix:
      object.elements.emplace(component.index, column);
      break;
    case Quantity::trigger:
      set(part.trigger);
      break;
    case Quantity::none:
      break;
  }
}

void finish(Object& object) {
  PartColumns& part = object.columns;
  part.quaternion = quaternion_in(object.rotations);
  if (!object.elements.empty()) take_matrix(part, object.elements);
  if (!part.quaternion[0] && part.quaternion[1] && !any(part.angles)) {
    part.angles = angles_in(part.quaternion);
    part.quaternion = {};
  }
  part.rotation = whole(part.quaternion) ? RotationKind::quaternion
                  : whole(part.angles)   ? RotationKind::angles
                  : whole(part.matrix)   ? RotationKind::matrix
                                         : RotationKind::none;
}

std::vector<Quantity> rotations_of(const Object& told) {
  std::vector<Quantity> kinds;
  PartColumns its;
  take_matrix(its, told.elements);  // its last column is a place
  if (any(quaternion_in(told.rotations))) kinds.push_back(Quantity::quaternion);
  if (any(told.columns.angles)) kinds.push_back(Quantity::angle);
  if (any(its.matrix)) kinds.push_back(Quantity::matrix);
  return kinds;
}

bool put_over(const Object& told, Object& found) {
  PartColumns& part = found.columns;
  PartColumns its = told.columns;
  take_matrix(its, told.elements);
  its.quaternion = quaternion_in(told.rotations);
  part.position = over(its.position, part.position);
  const bool of_quaternion = any(its.quaternion), of_angles = any(its.angles);
  const Places<4> quaternion = over(its.quaternion, quaternion_in(found.rotations));
  Places<3> angles = over(its.angles, part.angles);
  for (const RotationSet& set : found.rotations) {
    if (!whole(angles)) angles = over(its.angles, angles_in(set.columns));
  }
  const Places<9> matrix = over(its.matrix, part.matrix);
  if (of_quaternion && whole(quaternion)) {
    part.quaternion = quaternion;
    part.rotation = RotationKind::quaternion;
  } else if (of_angles && whole(angles)) {
    part.angles = angles;
    part.rotation = RotationKind::angles;
  } else if (of_quaternion && whole(angles_in(quaternion))) {
    part.angles = angles_in(quaternion);
    part.rotation = RotationKind::angles;
  } else if (any(its.matrix) && whole(matrix)) {
    part.matrix = matrix;
    part.rotation = RotationKind::matrix;
  } else {
    const bool nothing = !of_quaternion && !of_angles && !any(its.matrix);
    return nothing || part.rotation == RotationKind::none;
  }
  return true;
}

std::optional<std::string> starred(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  const std::string_view begin = pattern.substr(0, star), end = pattern.substr(star + 1);
  if (name.size() < begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end))
    return std::nullopt;
  return std::string(name.substr(begin.size(), name.size() - begin.size() - end.size()));
}

Objects objects_of(const AnyTable& table, std::string_view pattern) {
  Objects objects;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::optional<std::string> rest = starred(table.columns[c].name, pattern);
    if (!rest) continue;
    const Component component = component_of(*rest);
    if (component.quantity == Quantity::none) continue;
    auto object =
        std::ranges::find(objects, component.object, &std::pair<std::string, Object>::first);
    if (object == objects.end()) object = objects.insert(objects.end(), {component.object, {}});
    std::optional<std::size_t>& trigger = object->second.columns.trigger;
    if (component.quantity == Quantity::trigger && trigger) {
      trigger = better_trigger(table, *trigger, c);
    }
    put(object->second, component, c, table.columns[c].name);
  }
  for (auto& [name, object] : objects) finish(object);
  return objects;
}

}  // namespace headpin::devices
