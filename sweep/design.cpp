#include "sweep/design.h"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "scene/scenario/toml_reading.h"
#include "study/csv.h"
#include "study/toml_fields.h"

namespace headpin::sweep {

namespace {

constexpr std::int64_t kMostValues = 100'000;  // of one axis

[[noreturn]] void refuse(const std::string& where, const toml::node& node, const std::string& key,
                         const std::string& expected) {
  throw std::invalid_argument(fmt::format("{}:{}: {} must be {}, found {}", where,
                                          node.source().begin.line, key, expected,
                                          scene::value_in_words(node)));
}

/// A number as text for a scenario, without digits that come from rounding in the steps of a range.
std::string in_words(double value) {
  return fmt::format("{:.12g}", value);
}

/// One value of a scenario's key; nothing for a table or a date.
std::optional<std::string> scalar(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* yes = node.as_boolean()) return yes->get() ? "true" : "false";
  return std::nullopt;
}

/// One of its names is enough: another one may be misspelled.
bool is_range(const toml::table& table) {
  return table.contains("from") || table.contains("to") || table.contains("steps");
}

int line_of(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

double bound(const toml::table& table, const char* name, const std::string& where,
             const std::string& key) {
  const toml::node* node = table.get(name);
  const auto value = node ? node->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) {
    refuse(where, node ? *node : table, fmt::format("{}.{}", key, name), "a finite number");
  }
  return *value;
}

/// The bounds of {from, to} and, where `steps` is not null, their number of steps.
Range read_range(const toml::table& table, const std::string& where, const std::string& key,
                 std::int64_t* steps) {
  for (const auto& [name, node] : table) {
    if (name == "from" || name == "to" || (steps && name == "steps")) continue;
    throw std::invalid_argument(fmt::format("{}:{}: unknown key '{}.{}'; known here: from, to{}",
                                            where, name.source().begin.line, key,
                                            study::shown(name.str()), steps ? ", steps" : ""));
  }
  Range range{key, bound(table, "from", where, key), bound(table, "to", where, key),
              line_of(table)};
  if (!(range.from < range.to)) refuse(where, *table.get("to"), key + ".to", "above from");
  if (!steps) return range;
  const auto count = table["steps"].value<std::int64_t>();
  if (!count || *count < 2 || *count > kMostValues) {
    const toml::node& node = table.contains("steps") ? *table.get("steps") : table;
    refuse(where, node, key + ".steps", fmt::format("a whole number from 2 to {}", kMostValues));
  }
  *steps = *count;
  return range;
}

std::vector<std::string> read_values(const toml::node& node, const std::string& where,
                                     const std::string& key, DesignOf of) {
  constexpr const char* kExpected = "a list of values or {from, to, steps}";
  std::vector<std::string> values;
  if (const auto* table = node.as_table()) {
    std::int64_t steps = 0;
    const Range range = read_range(*table, where, key, &steps);
    for (std::int64_t i = 0; i < steps; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(steps - 1);
      const std::string value = in_words(range.from + part * (range.to - range.from));
      if (of == DesignOf::new_sweep && !values.empty() && values.back() == value) {
        refuse(where, node, key, "a range whose steps differ within 12 digits");
      }
      values.push_back(value);
    }
    return values;
  }
  const auto* array = node.as_array();
  if (!array || array->empty() || std::ssize(*array) > kMostValues) {
    refuse(where, node, key, kExpected);
  }
  for (const toml::node& item : *array) {
    const auto value = scalar(item);
    if (!value) refuse(where, item, key, kExpected);
    if (std::ranges::find(values, *value) != values.end()) {
      refuse(where, item, key, "a list of different values");
    }
    values.push_back(*value);
  }
  return values;
}

/// Reads a table of keys, `ball.mass` as well as [ball] with mass in it.
template <typename See>
void each_key(const toml::table& table, const std::string& before, DesignOf of, const See& see) {
  for (const auto& [name, node] : table) {
    const std::string key = before + std::string(name.str());
    const auto* inner = node.as_table();
    const bool refused = inner && inner->empty() && of == DesignOf::new_sweep;  // for its range
    if (inner && !refused && !is_range(*inner)) {
      each_key(*inner, key + ".", of, see);
    } else {
      see(key, node);
    }
  }
}

const toml::table& table_of(const toml::table& all, const char* key, const std::string& where) {
  static const toml::table kNone;
  const toml::node* node = all.get(key);
  if (!node) return kNone;
  if (!node->is_table()) refuse(where, *node, key, fmt::format("a table, headed by [{}]", key));
  return *node->as_table();
}

void read_grid(const toml::table& grid, const std::string& where, DesignOf of, Design& design) {
  std::vector<std::pair<toml::source_position, Axis>> found;  // a table does not keep its order
  each_key(grid, "", of, [&](const std::string& key, const toml::node& node) {
    found.emplace_back(node.source().begin,
                       Axis{key, read_values(node, where, key, of), line_of(node)});
  });
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [place, axis] : found) design.grid.push_back(std::move(axis));
}

void read_random(const toml::table& random, const std::string& where, DesignOf of, Design& design) {
  std::vector<std::pair<toml::source_position, Range>> found;
  each_key(random, "", of, [&](const std::string& key, const toml::node& node) {
    if (key == "method") {
      const auto name = node.value<std::string>();
      if (name != "latin-hypercube" && name != "uniform") {
        refuse(where, node, key, "'latin-hypercube' or 'uniform'");
      }
      design.latin_hypercube = name == "latin-hypercube";
    } else if (key == "draws") {
      const auto draws = node.value<std::int64_t>();
      if (!node.is_integer() || *draws < 1 || *draws > kMostRows) {
        refuse(where, node, key, fmt::format("a whole number from 1 to {}", kMostRows));
      }
      design.draws = *draws;
    } else if (key == "seed") {
      if (!node.is_integer() || *node.value<std::int64_t>() < 0) {
        refuse(where, node, key, "a whole number from 0 on");
      }
      design.seed = static_cast<std::uint64_t>(*node.value<std::int64_t>());
    } else {
      if (!node.is_table()) refuse(where, node, key, "a range {from, to}");
      found.emplace_back(node.source().begin, read_range(*node.as_table(), where, key, nullptr));
    }
  });
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [place, range] : found) design.drawn.push_back(std::move(range));
}

/// Groups of keys that leave nothing of this one where all of a group stand beside it.
/// @param versions  the two versions have values of their own
std::vector<std::vector<std::string>> groups_set_by(const std::string& key, bool versions) {
  std::vector<std::vector<std::string>> groups;
  const bool of_versions =
      key == "elasticity" || key == "friction" || key == "shape" || key == "collision.shape";
  if (versions && of_versions) {
    const std::string what = key.substr(key.rfind('.') + 1);
    groups.push_back({fmt::format("version.red.{}", what), fmt::format("version.blue.{}", what)});
  }
  if (key == "elasticity" || key == "friction") {
    groups.emplace_back();
    for (const char* object : {"skittle", "ball", "lane", "wall"}) {
      groups.back().push_back(fmt::format("material.{}.{}", object, key));
    }
  }
  for (const char* option : {"shape", "response", "detection", "iterations"}) {
    if (key == option) groups.push_back({fmt::format("collision.{}", option)});
  }
  return groups;
}

void require_different_keys(const Design& design, const std::string& where) {
  std::set<std::string> keys;
  const auto add = [&](const std::string& key, int line) {
    if (!keys.insert(key).second) {
      throw std::invalid_argument(fmt::format("{}:{}: expected each key once, found '{}' twice",
                                              where, line, study::shown(key)));
    }
  };
  for (const Axis& axis : design.grid) add(axis.key, axis.line);
  for (const Range& range : design.drawn) add(range.key, range.line);
}

}  // namespace

Design parse_design(std::string_view text, const std::string& where, DesignOf of) {
  const toml::table all = study::parse_toml(text, where, {"trials", "grid", "random"});
  Design design;
  const toml::node* trials = all.get("trials");
  if (!trials)
    throw std::invalid_argument(where + ": expected trials = ['FILE.lcmlog'], found none");
  if (!trials->is_array() || trials->as_array()->empty()) {
    refuse(where, *trials, "trials", "a list of files");
  }
  for (const toml::node& item : *trials->as_array()) {
    if (!item.is_string()) refuse(where, item, "trials", "a list of files");
    design.trials.push_back(item.as_string()->get());
  }
  read_grid(table_of(all, "grid", where), where, of, design);
  const toml::table& random = table_of(all, "random", where);
  read_random(random, where, of, design);
  if (design.drawn.empty() && !random.empty()) {
    refuse(where, random, "random", "a table with ranges, such as ball.mass = {from = 5, to = 7}");
  }
  require_different_keys(design, where);
  std::int64_t rows = std::ssize(design.trials) * design.draws;
  for (const Axis& axis : design.grid) {
    rows = rows > kMostRows ? rows : rows * std::ssize(axis.values);
  }
  if (rows > kMostRows) {
    throw std::invalid_argument(
        fmt::format("{}: expected at most {} rows, found more", where, kMostRows));
  }
  return design;
}

void require_effects(const Design& design, bool versions, const std::string& where) {
  std::set<std::string> keys;
  for (const Axis& axis : design.grid) keys.insert(axis.key);
  for (const Range& range : design.drawn) keys.insert(range.key);
  for (const std::string& key : keys) {
    for (const std::vector<std::string>& set : groups_set_by(key, versions)) {
      const auto is_given = [&](const std::string& one) { return keys.contains(one); };
      if (!std::ranges::all_of(set, is_given)) continue;
      throw std::invalid_argument(
          fmt::format("{}: '{}' sets {}, which {} a key of this design too; expected one of them",
                      where, key, fmt::join(set, ", "), set.size() == 1 ? "is" : "are each"));
    }
  }
}

std::int64_t row_count(const Design& design) {
  std::int64_t rows = std::ssize(design.trials) * design.draws;
  for (const Axis& axis : design.grid) rows *= std::ssize(axis.values);
  return rows;
}

}  // namespace headpin::sweep
