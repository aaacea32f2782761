#include "scene/scenario/text.h"

#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "scene/scenario/fields.h"
#include "scene/scenario/keys_since.h"
#include "scene/scenario/scenario.h"
#include "scene/scenario/toml_text.h"
#include "scene/scenario/writer.h"

// Scenarios as TOML: reading, writing and listing use the same list of fields.
namespace headpin::scene {
namespace {

/// Fills fields from a TOML table; rejects unknown keys.
class Reader {
 public:
  Reader(const toml::table& table, ScenarioText& text, std::string path)
      : table_(table), text_(text), path_(std::move(path)) {}

  template <typename T, typename Allowed>
  void field(std::string_view key, T& value, const Allowed& allowed, std::string_view,
             std::string_view = {}) {
    known_.insert(std::string(key));
    const std::string path = path_ + std::string(key);
    if (const toml::node* node = table_.get(key)) {
      note_line(*node, path);
      read(*node, path, value, allowed);
    } else if (text_.whole) {
      const toml::table before = value_before(path);
      read(*before.get("v"), path, value, allowed);
    }
  }

  template <typename T>
  void section(std::string_view key, std::string_view, T& part) {
    known_.insert(std::string(key));
    const toml::node* node = table_.get(key);
    if (node && !node->is_table()) refuse(*node, path_ + std::string(key), "a table");
    const toml::table none;
    Reader inner(node ? *node->as_table() : none, text_, path_ + std::string(key) + ".");
    visit(inner, part);
    inner.finish();
  }

  /// To be called last: throws for the first key that no field used.
  void finish() const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string names;
      for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
      throw std::invalid_argument(fmt::format("{}: unknown key '{}{}'; known here: {}", place(key),
                                              path_, brief(key.str()), names));
    }
  }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& path,
                           const std::string& expected) const {
    std::ostringstream found;
    const toml::array* array = node.as_array();
    if (array && array->size() > 4) {
      found << array->size() << " items";
    } else {
      node.visit([&](const auto& n) { found << toml::node_view<const toml::node>(&n); });
    }
    throw std::invalid_argument(fmt::format("{}: {} must be {}, found {}", place(node), path,
                                            expected, brief(found.str())));
  }

  template <typename Node>
  std::string place(const Node& node) const {
    return text_.place(static_cast<int>(node.source().begin.line));
  }

  void note_line(const toml::node& node, const std::string& path) {
    text_.lines[path] = static_cast<int>(node.source().begin.line);
  }

  /// {v = VALUE} for a key that is newer than this text.
  toml::table value_before(const std::string& path) const {
    for (const auto& [key, value] : kKeysSince) {
      if (key == path) return toml::parse(fmt::format("v = {}", value));
    }
    throw std::invalid_argument(fmt::format(
        "{}: {} is missing; a trial must contain its whole scenario", text_.where, path));
  }

  double number(const toml::node& node, const std::string& path, Range range) const {
    const auto value = node.value<double>();
    const bool is_number = node.is_integer() || node.is_floating_point();
    if (!is_number || !value || !(*value >= range.low && *value <= range.high)) {
      refuse(node, path,
             range.high == kAny.high
                 ? std::string("a finite number")
                 : fmt::format("a number from {} to {}", range.low, range.high));
    }
    return *value;
  }

  /// The node as an array of `size` numbers (any number of them for size 0).
  std::vector<double> numbers(const toml::node& node, const std::string& path, std::size_t size,
                              Range range) const {
    const toml::array* array = node.as_array();
    if (!array || (size != 0 && array->size() != size)) {
      refuse(node, path, fmt::format("an array of {} numbers", size));
    }
    std::vector<double> values;
    for (const toml::node& item : *array) values.push_back(number(item, path, range));
    return values;
  }

  void read(const toml::node& node, const std::string& path, double& value, Range range) const {
    value = number(node, path, range);
  }

  void read(const toml::node& node, const std::string& path, std::int64_t& value,
            Range range) const {
    if (!node.is_integer()) refuse(node, path, "a whole number");
    number(node, path, range);
    value = *node.value<std::int64_t>();
  }

  void read(const toml::node& node, const std::string& path, int& value, Range range) const {
    std::int64_t whole = 0;
    read(node, path, whole, range);
    value = static_cast<int>(whole);
  }

  void read(const toml::node& node, const std::string& path, bool& value, Range) const {
    if (!node.is_boolean()) refuse(node, path, "true or false");
    value = *node.value<bool>();
  }

  void read(const toml::node& node, const std::string& path, std::string& value, Range) const {
    if (!node.is_string()) refuse(node, path, "a string");
    value = *node.value<std::string>();
  }

  void read(const toml::node& node, const std::string& path, std::string& value,
            const Choices& choices) const {
    std::string names;
    for (const std::string_view name : choices) {
      if (node.is_string() && *node.value<std::string>() == name) {
        value = name;
        return;
      }
      names += (names.empty() ? "" : " or ") + fmt::format("\"{}\"", name);
    }
    refuse(node, path, names);
  }

  /// Reads the name of a profile, which sets all values of the display.
  void read(const toml::node& node, const std::string& path, Hmd& value, Range range) const {
    std::string name;
    read(node, path, name, range);
    try {
      value = hmd_of_profile(name);
    } catch (const std::invalid_argument&) {
      refuse(node, path, "one of " + render::hmd_profile_names());
    }
  }

  void read(const toml::node& node, const std::string& path, Vec3& value, Range range) const {
    const std::vector<double> v = numbers(node, path, 3, range);
    value = Vec3(v[0], v[1], v[2]);
  }

  void read(const toml::node& node, const std::string& path, Pose& value, Range) const {
    const toml::table* table = node.as_table();
    if (!table) refuse(node, path, "a table {p = [x, y, z], q = [w, x, y, z]}");
    for (const auto& [key, item] : *table) {
      if (key.str() == "p") {
        read(item, path + ".p", value.p, Range{-1e4, 1e4});
      } else if (key.str() == "q") {
        const std::vector<double> q = numbers(item, path + ".q", 4, Range{-1.0, 1.0});
        value.q = Quat(q[0], q[1], q[2], q[3]);
        if (std::abs(value.q.norm() - 1.0) > 1e-9) refuse(item, path + ".q", "a unit quaternion");
      } else {
        refuse(node, path, "a table {p = [x, y, z], q = [w, x, y, z]}");
      }
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<Vec2>& value, Range) {
    const toml::array* array = node.as_array();
    if (!array || array->empty() || array->size() > 10'000) {
      refuse(node, path, "an array of 1 to 10000 pairs of numbers");
    }
    value.clear();
    for (const toml::node& item : *array) {
      const std::vector<double> v = numbers(item, path, 2, Range{-100, 100});
      value.emplace_back(v[0], v[1]);
      note_line(item, fmt::format("{}[{}]", path, value.size()));
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<SkittlePart>& value,
            Range) {
    const toml::array* array = node.as_array();
    if (!array || array->empty() || array->size() > 16) refuse(node, path, "1 to 16 parts");
    value.clear();
    for (const toml::node& item : *array) {
      if (!item.is_table()) refuse(item, path, "tables {shape, radius, low, high}");
      Reader inner(*item.as_table(), text_, path + ".");
      visit(inner, value.emplace_back());
      note_line(item, fmt::format("{}[{}]", path, value.size()));
      inner.finish();
      const SkittlePart& part = value.back();  // measures of a polyhedron follow from its corners
      if (part.shape != "polyhedron" && !(part.low < part.high))
        refuse(item, path, "low below high");
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<Vec3>& value,
            Range range) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() > kMostOfHull) refuse(node, path, "at most 2000 points");
    value.clear();
    for (const toml::node& item : *array) {
      const std::vector<double> v = numbers(item, path, 3, range);
      value.emplace_back(v[0], v[1], v[2]);
    }
  }

  void read(const toml::node& node, const std::string& path,
            std::vector<std::vector<std::uint32_t>>& value, Range) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() > kMostOfHull) refuse(node, path, "at most 2000 faces");
    value.clear();
    for (const toml::node& item : *array) {
      std::vector<std::uint32_t>& face = value.emplace_back();
      for (const double corner : numbers(item, path, 0, Range{0, kMostOfHull})) {
        face.push_back(static_cast<std::uint32_t>(corner));
      }
    }
  }

  static constexpr std::size_t kMostOfHull = 2000;
  const toml::table& table_;
  ScenarioText& text_;
  std::string path_;
  std::set<std::string> known_;
};

/// Every value of a scenario, as it is written, by its key.
class Values {
 public:
  template <typename T, typename Allowed>
  void field(std::string_view key, const T& value, const Allowed&, std::string_view,
             std::string_view = {}) {
    all_.emplace_back(path_ + std::string(key), Writer::text(value));
  }

  template <typename T>
  void section(std::string_view key, std::string_view, T& part) {
    const std::string outer = path_;
    path_ += std::string(key) + ".";
    visit(*this, part);
    path_ = outer;
  }

  std::vector<std::pair<std::string, std::string>> all() && { return std::move(all_); }

 private:
  std::vector<std::pair<std::string, std::string>> all_;
  std::string path_;
};

std::vector<std::pair<std::string, std::string>> values_of(Scenario scenario) {
  Values values;
  visit(values, scenario);
  return std::move(values).all();
}

toml::table parse_table(std::string_view toml, const ScenarioText& text) {
  require_shallow(toml, text.where);
  try {
    return toml::parse(toml);
  } catch (const toml::parse_error& error) {
    throw std::invalid_argument(fmt::format("{}: not TOML: {}",
                                            text.place(static_cast<int>(error.source().begin.line)),
                                            error.description().substr(0, 300)));
  }
}

void read_into(Scenario& scenario, const toml::table& table, ScenarioText& text) {
  Reader reader(table, text, "");
  visit(reader, scenario);
  reader.finish();
}

}  // namespace

std::string ScenarioText::place(int line) const {
  return one_line ? where : fmt::format("{}:{}", where, line);
}

std::string ScenarioText::place(const std::string& key) const {
  const auto found = lines.find(key);
  return found == lines.end() ? where : place(found->second);
}

bool ScenarioText::names(std::string_view section) const {
  const auto found = lines.lower_bound(std::string(section) + ".");
  return found != lines.end() && found->first.starts_with(section) &&
         found->first[section.size()] == '.';
}

void read_text(Scenario& scenario, std::string_view toml, ScenarioText& text) {
  read_into(scenario, parse_table(toml, text), text);
}

void read_assignment(Scenario& scenario, std::string_view assignment, ScenarioText& text) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw std::invalid_argument(
        fmt::format("{}: expected key=value, such as ball.mass=5", text.where));
  }
  const std::string key(assignment.substr(0, equals));
  const std::string value(assignment.substr(equals + 1));
  toml::table table;
  require_shallow(assignment, text.where);
  try {
    table = toml::parse(key + " = " + value);
  } catch (const toml::parse_error&) {  // a bare word is a string
    table = parse_table(fmt::format("{} = '{}'", key, value), text);
  }
  read_into(scenario, table, text);
}

std::string to_toml(const Scenario& scenario) {
  // The list of fields is the same for reading and writing, so it needs non-const objects.
  Scenario usual, copy = scenario;
  const std::map<std::string, std::string> none;
  Writer first(none);
  visit(first, usual);
  const std::map<std::string, std::string> sourced = std::move(first).written();
  Writer writer(sourced);
  visit(writer, copy);
  return std::move(writer).out();
}

std::vector<KeyDifference> differences(const Scenario& a, const Scenario& b) {
  const auto of_a = values_of(a), of_b = values_of(b);
  std::map<std::string, std::string> left(of_b.begin(), of_b.end());
  std::vector<KeyDifference> all;
  for (const auto& [key, value] : of_a) {
    const auto found = left.extract(key);
    const std::string other = found ? found.mapped() : std::string();
    if (other != value) all.push_back({key, value, other});
  }
  for (const auto& [key, value] : of_b) {
    if (left.contains(key)) all.push_back({key, "", value});
  }
  return all;
}

}  // namespace headpin::scene
