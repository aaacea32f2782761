#include "devices/recordings/table_columns.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "devices/recordings/table_objects.h"
#include "devices/recordings/table_time.h"
#include "devices/recordings/table_trigger.h"

namespace headpin::devices {
namespace {

/// The only column with a name of this kind; none if several have it.
std::optional<std::size_t> only_column(const AnyTable& table, std::string_view name,
                                       std::string FoundColumn::*kind) {
  if (std::ranges::count(table.columns, name, kind) != 1) return std::nullopt;
  return static_cast<std::size_t>(std::ranges::find(table.columns, name, kind) -
                                  table.columns.begin());
}

/// The column that a user calls so: by its number, its name, or its lowest cell with or without its unit.
std::optional<std::size_t> column_called(const AnyTable& table, std::string_view name) {
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (name == fmt::format("#{}", c + 1)) return c;
  }
  for (const auto kind : {&FoundColumn::name, &FoundColumn::written, &FoundColumn::last}) {
    if (const auto found = only_column(table, name, kind)) return found;
  }
  return std::nullopt;
}

/// Puts what the user told into the columns.
class Told {
 public:
  Told(const AnyTable& table, std::string_view where, MotionColumns& columns)
      : table_(table), where_(where), columns_(columns) {}

  void take(const ToldColumns& all, bool uses_rotations) {
    for (const ToldColumn& told : all) {
      const std::string& key = told.key;
      if (!is_column_key(key)) {
        throw WrongColumn(told, fmt::format("unknown key '{}'", key),
                          fmt::format("expected {}", kColumnKeys));
      }
      const std::size_t dot = key.find('.');
      const auto part = static_cast<std::size_t>(std::ranges::find(kPartKeys, key.substr(0, dot)) -
                                                 kPartKeys.begin());
      if (key == "time") {
        columns_.time = column(told);
      } else if (key == "object") {
        columns_.object = column(told);
      } else if (key == "trigger") {
        trigger_ = column(told);
      } else if (dot == std::string::npos) {
        whole_part(part, told);
      } else {
        one_component(part, told, all);
      }
    }
    if (!uses_rotations) return;
    for (const auto& [part, object] : objects_) require_one_rotation(part, object);
  }

  /// Which parts were told whole.
  std::array<bool, 3> done() {
    std::array<bool, 3> told{};
    for (const auto& [part, object] : objects_) {
      Object its = object;
      finish(its);
      told[part] = whole(its.columns.position);
      if (told[part]) columns_.parts[part] = its.columns;
    }
    for (const auto& [part, object] : whole_parts_) {
      columns_.parts[part] = with_told(part, object);
      told[part] = true;
    }
    return told;
  }

  /// What was found of a part, with what was told of it.
  PartColumns with_told(std::size_t part, Object found) const {
    const auto told = objects_.find(part);
    if (told == objects_.end() || put_over(told->second, found)) return found.columns;
    const ToldColumn& turn = turns_.at(part).front().told;
    throw WrongColumn(turn, fmt::format("{} = '{}' makes no whole rotation", turn.key, turn.column),
                      fmt::format("expected all of {}", kRotations));
  }

  /// Whether a component of a part's place or rotation was told.
  bool places_or_turns(std::size_t part) const {
    const auto told = objects_.find(part);
    return turns_.contains(part) ||
           (told != objects_.end() &&
            std::ranges::any_of(told->second.columns.position,
                                [](const auto& column) { return column.has_value(); }));
  }

  /// The told trigger of a part: its own, else that of both hands.
  std::optional<std::size_t> trigger(std::size_t part) const {
    const auto told = objects_.find(part);
    const bool own = told != objects_.end() && told->second.columns.trigger;
    return own ? told->second.columns.trigger : trigger_;
  }

 private:
  /// A told component of a rotation.
  struct Turn {
    Quantity quantity;
    ToldColumn told;
  };
  static constexpr std::string_view kRotations = "qw, qx, qy, qz, or of rx, ry, rz, or m00 to m22";

  /// Only one of two rotations could be used.
  void require_one_rotation(std::size_t part, const Object& told) const {
    const std::vector<Quantity> kinds = rotations_of(told);
    if (kinds.size() < 2) return;
    const std::vector<Turn>& turns = turns_.at(part);
    const auto first = [&](Quantity kind) {
      return std::ranges::find(turns, kind, &Turn::quantity);
    };
    const ToldColumn &a = first(kinds[0])->told, &b = first(kinds[1])->told;
    throw WrongColumn(b,
                      fmt::format("{} = '{}' and {} = '{}' are of two rotations", a.key, a.column,
                                  b.key, b.column),
                      fmt::format("expected one rotation: columns of {}", kRotations));
  }

  std::size_t column(const ToldColumn& told) const {
    if (const auto found = column_called(table_, told.column)) return *found;
    std::vector<std::size_t> called;
    std::vector<std::string> names;
    for (const FoundColumn& one : table_.columns) {
      names.push_back(one.name);
      if (one.name == told.column) called.push_back(names.size());
    }
    if (called.size() > 1) {
      throw WrongColumn(
          told, fmt::format("{} columns of {} are called '{}'", called.size(), where_, told.column),
          fmt::format("expected one of them by its number, such as #{} or #{}", called[0],
                      called[1]));
    }
    throw WrongColumn(told, fmt::format("{} has no column '{}'", where_, told.column),
                      names_in(table_), std::move(names));
  }

  void one_component(std::size_t part, const ToldColumn& told, const ToldColumns& all) {
    const std::string word = told.key.substr(told.key.find('.') + 1);
    Component component = component_of(word);
    if (component.quantity == Quantity::none || !component.object.empty()) {
      throw WrongColumn(told, fmt::format("unknown component '{}'", told.key),
                        "expected x, y, z, qw, qx, qy, qz, rx, ry, rz (angles), m00 to m22 or "
                        "trigger");
    }
    if (part == 0 && component.quantity == Quantity::trigger) {
      throw WrongColumn(told, fmt::format("'{}': a head has no trigger", told.key),
                        "expected trigger, left.trigger or right.trigger");
    }
    // "rx" is an angle, unless "rw" is told too.
    const std::string rw = fmt::format("{}.rw", kPartKeys[part]);
    if (is_one_of(word, {"rx", "ry", "rz"}) &&
        std::ranges::find(all, rw, &ToldColumn::key) == all.end()) {
      component = {Quantity::angle, component.index - 1, {}};
    }
    put(objects_[part], component, column(told), "");
    if (is_rotation(component.quantity)) turns_[part].push_back({component.quantity, told});
  }

  static bool is_rotation(Quantity quantity) {
    return quantity == Quantity::quaternion || quantity == Quantity::angle ||
           quantity == Quantity::matrix;
  }

  void whole_part(std::size_t part, const ToldColumn& told) {
    const std::string& pattern = told.column;
    if (std::ranges::count(pattern, '*') != 1) {
      throw WrongColumn(told, fmt::format("{} = '{}'", told.key, pattern),
                        "expected a name with one *, such as HMD_*");
    }
    const auto found = objects_of(table_, pattern);
    const std::string which =
        pattern.ends_with('*')
            ? fmt::format("begin with '{}'", pattern.substr(0, pattern.size() - 1))
            : fmt::format("are called '{}'", pattern);
    const auto fits = [&](const FoundColumn& one) {
      return starred(one.name, pattern).has_value();
    };
    if (std::ranges::none_of(table_.columns, fits)) {
      throw WrongColumn(told, fmt::format("no columns of {} {}", where_, which), names_in(table_));
    }
    if (found.size() != 1 || !whole(found.front().second.columns.position)) {
      throw WrongColumn(
          told,
          fmt::format(
              "the columns of {} that {} {}", where_, which,
              found.size() > 1 ? fmt::format("are of {} objects", found.size()) : "lack x, y or z"),
          "expected x, y and z of one object");
    }
    whole_parts_[part] = found.front().second;
  }

  const AnyTable& table_;
  std::string_view where_;
  MotionColumns& columns_;
  std::map<std::size_t, Object> objects_;  // of components
  std::map<std::size_t, Object> whole_parts_;
  std::map<std::size_t, std::vector<Turn>> turns_;  // of each part, as they were told
  std::optional<std::size_t> trigger_;              // of both hands
};

using Candidates = std::vector<const std::pair<std::string, Object>*>;

/// Of several objects, those with a rotation; of these, those that are called a head or a hand.
void prefer(Candidates& found) {
  const auto keep = [&](const auto& wanted) {
    if (found.size() > 1 && std::ranges::any_of(found, wanted)) {
      std::erase_if(found, [&](const auto* object) { return !wanted(object); });
    }
  };
  keep([](const auto* object) { return object->second.columns.rotation != RotationKind::none; });
  keep([](const auto* object) {
    const std::vector<std::string> words = words_of(object->first);
    return std::ranges::any_of(words, [](const std::string& word) {
      return is_one_of(word,
                       {"hand", "controller", "ctrl", "wrist", "palm", "wand", "head", "hmd"});
    });
  });
  // "head" before "head forward", "right hand" before "right hand index".
  if (found.empty()) return;
  const auto length = [](const auto* object) { return words_of(object->first).size(); };
  const std::size_t least = length(*std::ranges::min_element(found, {}, length));
  keep([&](const auto* object) { return length(object) == least; });
}

/// The object that a part is.
const Object* object_of(const Objects& objects, std::size_t part, std::string_view where) {
  Candidates found;
  for (const auto& object : objects) {
    if (whole(object.second.columns.position) && part_of_name(object.first) == part) {
      found.push_back(&object);
    }
  }
  prefer(found);
  if (found.empty()) return nullptr;
  if (found.size() == 1) return &found.front()->second;
  throw std::invalid_argument(fmt::format(
      "{}: columns: expected one {}, found {} ('{}', '{}'); say which, such as {} = 'NAME*'", where,
      kPartNames[part], found.size(), found[0]->first, found[1]->first, kPartKeys[part]));
}

/// A hand whose name does not say the side: the only object besides the head, or the only one that is
/// called a hand.
const Object* only_hand(const Objects& objects, const Object* head) {
  Candidates found;
  for (const auto& object : objects) {
    const std::vector<std::string> words = words_of(object.first);
    const bool marker = std::ranges::find(words, "marker") != words.end();
    if (whole(object.second.columns.position) && &object.second != head && !marker) {
      found.push_back(&object);
    }
  }
  if (head == nullptr && found.size() > 1) return nullptr;
  prefer(found);
  return found.size() == 1 ? &found.front()->second : nullptr;
}

/// A trigger or button that belongs to no head or hand: one with the name of the part before one without.
std::optional<std::size_t> loose_trigger(const AnyTable& table, const Objects& objects,
                                         std::size_t part) {
  std::array<std::optional<std::size_t>, 2> found;  // without and with the name of the part
  for (const auto& [name, object] : objects) {
    const auto of = part_of_name(name);
    const std::optional<std::size_t>& its = object.columns.trigger;
    if (!its || (of && *of != part)) continue;
    std::optional<std::size_t>& best = found[of ? 1 : 0];
    best = best ? better_trigger(table, *best, *its) : *its;
  }
  return found[1] ? found[1] : found[0];
}

/// The words in a column; none if there are more than twenty, or numbers.
std::vector<std::string> words_in(const AnyTable& table, std::size_t column) {
  std::vector<std::string> words;
  for (const AnyTable::Row& row : table.rows) {
    const std::string_view cell = row.cells[column];
    if (cell.empty() || std::ranges::find(words, cell) != words.end()) continue;
    if (words.size() == 20 || table.number(cell)) return {};
    words.emplace_back(cell);
  }
  return words;
}

/// A table with a row for each object: finds the column of its name, and the names of the parts.
void find_objects(const AnyTable& table, const Objects& objects, bool only_hand_is_left,
                  const Told& said, MotionColumns& columns) {
  const auto placed = [](const auto& object) { return whole(object.second.columns.position); };
  if (table.of_streams) return;
  if (std::ranges::count_if(objects, placed) != 1) return;
  const Object& of_rows = std::ranges::find_if(objects, placed)->second;
  const std::optional<std::size_t> told = columns.object;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (told && *told != c) continue;
    std::array<std::string, 3> names;
    std::string other;
    for (const std::string& word : words_in(table, c)) {
      const auto part = part_of_name(word);
      (part ? names[*part] : other) = word;
    }
    const bool known = std::ranges::any_of(names, [](const auto& name) { return !name.empty(); });
    if (!known && !told) continue;
    if (names[1].empty() && names[2].empty()) names[only_hand_is_left ? 1 : 2] = other;
    columns.object = c;
    columns.objects = names;
    columns.parts = {};
    for (std::size_t part = 0; part < 3; ++part) {
      if (names[part].empty()) continue;
      columns.parts[part] = said.with_told(part, of_rows);
      columns.told_of_rows[part] = said.places_or_turns(part);
    }
    return;
  }
}

/// The rotation that a file of columns has; of one that is not used, the first kind of which there are columns.
RotationKind written_rotation(const PartColumns& part) {
  const auto some = [](const auto& columns) {
    return std::ranges::any_of(columns, [](const auto& column) { return column.has_value(); });
  };
  if (part.rotation != RotationKind::none) return part.rotation;
  if (some(part.quaternion)) return RotationKind::quaternion;
  return some(part.angles) ? RotationKind::angles : RotationKind::matrix;
}

void say_missing(const AnyTable& table, MotionColumns& columns) {
  if (!columns.time) columns.missing.emplace_back("no column of the time was found");
  const auto lacks = [&](const char* what) {
    columns.missing.push_back(fmt::format("no {} was found (x, y and z of one object)", what));
  };
  if (!columns.parts[0].tracked()) lacks("head");
  if (!columns.parts[1].tracked() && !columns.parts[2].tracked()) lacks("hand");
  for (std::size_t part = 0; part < 3; ++part) {
    if (columns.parts[part].tracked() && columns.parts[part].rotation == RotationKind::none) {
      columns.missing.push_back(fmt::format("the {} has no rotation", kPartNames[part]));
    }
  }
  if (columns.missing.empty()) return;
  std::string unused;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (!columns.meanings[c].empty()) continue;
    unused += (unused.empty() ? "" : ", ") + table.columns[c].name;
  }
  if (!unused.empty()) {
    columns.missing.push_back(fmt::format(
        "not understood: {} (say what they are, such as time=t, head=HMD_*, right.qw=q0)",
        unused.substr(0, 400)));
  }
}

}  // namespace

bool is_column_key(std::string_view key) {
  return is_one_of(key, {"time", "trigger", "object"}) ||
         std::ranges::find(kPartKeys, key.substr(0, key.find('.'))) != kPartKeys.end();
}

WrongColumn::WrongColumn(ToldColumn which, std::string what_is_wrong, const std::string& expected,
                         std::vector<std::string> names)
    : std::invalid_argument(fmt::format("{}: {}; {}", which.source, what_is_wrong, expected)),
      told(std::move(which)),
      wrong(std::move(what_is_wrong)),
      known(std::move(names)) {}

ToldColumns mapping_of(const AnyTable& table, const MotionColumns& columns) {
  ToldColumns all;
  const auto tell = [&](const std::string& key, const std::optional<std::size_t>& column) {
    if (!column) return;
    const std::string& name = table.columns[*column].name;
    const bool once = std::ranges::count(table.columns, name, &FoundColumn::name) == 1 &&
                      column_called(table, name) == column;
    all.push_back({key, once ? name : fmt::format("#{}", *column + 1)});
  };
  tell("time", columns.time);
  tell("object", columns.object);
  for (std::size_t part = 0; part < 3; ++part) {
    const PartColumns& its = columns.parts[part];
    if (!its.tracked()) continue;
    const auto each = [&](const auto& places, std::string_view before, std::string_view letters) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        tell(fmt::format("{}.{}{}", kPartKeys[part], before, letters[i]), places[i]);
      }
    };
    const RotationKind rotation = written_rotation(its);
    // Those of a table with a row for each object are found again.
    if (!columns.object || columns.told_of_rows[part]) {
      each(its.position, "", "xyz");
      if (rotation == RotationKind::quaternion) each(its.quaternion, "q", "wxyz");
      if (rotation == RotationKind::angles || rotation == RotationKind::vector)
        each(its.angles, "r", "xyz");
      for (std::size_t i = 0; i < 9 && rotation == RotationKind::matrix; ++i)
        tell(fmt::format("{}.m{}{}", kPartKeys[part], i / 3, i % 3), its.matrix[i]);
    }
    if (part > 0) tell(fmt::format("{}.trigger", kPartKeys[part]), its.trigger);
  }
  return all;
}

void say_meanings(const AnyTable& table, MotionColumns& columns) {
  columns.meanings.assign(table.columns.size(), "");
  const auto say = [&](const std::optional<std::size_t>& column, const std::string& what) {
    if (!column) return;
    std::string& meaning = columns.meanings[*column];
    meaning += (meaning.empty() ? "" : "; ") + what;
  };
  say(columns.time, "time");
  say(columns.object, "the object of the row");
  for (std::size_t part = 0; part < 3; ++part) {
    const PartColumns& its = columns.parts[part];
    if (!its.tracked()) continue;
    const auto each = [&](const auto& places, const char* what, std::string_view letters) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        say(places[i], fmt::format("{}, {} {}", kPartNames[part], what, letters[i]));
      }
    };
    each(its.position, "position", "xyz");
    if (its.rotation == RotationKind::quaternion) each(its.quaternion, "quaternion", "wxyz");
    if (its.rotation == RotationKind::angles) each(its.angles, "angle about", "xyz");
    if (its.rotation == RotationKind::vector) each(its.angles, "rotation vector", "xyz");
    if (its.rotation == RotationKind::matrix) each(its.matrix, "matrix element", "012345678");
    if (part > 0) say(its.trigger, fmt::format("{}, trigger", kPartNames[part]));
  }
}

MotionColumns find_columns(const AnyTable& table, const ToldColumns& told, bool only_hand_is_left,
                           std::string_view where, bool uses_rotations) {
  MotionColumns columns;
  Told said(table, where, columns);
  said.take(told, uses_rotations);
  const std::array<bool, 3> is_told = said.done();
  const bool hand_told = is_told[1] || is_told[2];

  const Objects objects = objects_of(table);
  if (!columns.time) columns.time = find_time(table);
  std::array<const Object*, 3> found{};
  for (std::size_t part = 0; part < 3; ++part) {
    // Of two hands, one that was not told is not wanted.
    if (is_told[part] || (hand_told && part > 0)) continue;
    found[part] = object_of(objects, part, where);
  }
  if (!found[1] && !found[2] && !hand_told)
    found[only_hand_is_left ? 1 : 2] = only_hand(objects, found[0]);
  for (std::size_t part = 0; part < 3; ++part) {
    PartColumns& its = columns.parts[part];
    if (found[part]) its = said.with_told(part, *found[part]);
    if (part > 0 && its.tracked() && !its.trigger)
      its.trigger = loose_trigger(table, objects, part);
  }
  if (!columns.parts[0].tracked() || columns.object) {
    find_objects(table, objects, only_hand_is_left, said, columns);
  }
  for (std::size_t part = 0; part < 3; ++part) {
    if (const auto trigger = said.trigger(part)) columns.parts[part].trigger = trigger;
  }
  say_meanings(table, columns);
  say_missing(table, columns);
  return columns;
}

}  // namespace headpin::devices
