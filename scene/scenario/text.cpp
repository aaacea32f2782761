#include "scene/scenario/text.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "scene/scenario/fields.h"
#include "scene/scenario/keys.h"
#include "scene/scenario/keys_since.h"
#include "scene/scenario/nearest.h"
#include "scene/scenario/scenario.h"
#include "scene/scenario/toml_reading.h"
#include "scene/scenario/toml_text.h"
#include "scene/scenario/units.h"
#include "scene/scenario/writer.h"

// Scenarios as TOML: reading, writing and listing use the same list of fields.
namespace headpin::scene {
namespace {

/// The whole names of all keys.
std::vector<std::string> names_of_keys() {
  std::vector<std::string> names;
  for (const ScenarioKey& key : scenario_keys()) names.push_back(key.key);
  return names;
}

/// Fills fields from a TOML table; rejects unknown keys.
class Reader {
 public:
  /// @param entry  where the table is one of a list, "skittle.parts, part 2: "
  Reader(const toml::table& table, ScenarioText& text, std::string path, std::string entry = {})
      : table_(table), text_(text), path_(std::move(path)), entry_(std::move(entry)) {}

  template <typename T, typename Allowed>
  void field(std::string_view key, T& value, const Allowed& allowed, std::string_view meaning,
             std::string_view = {}) {
    known_.insert(std::string(key));
    unit_ = unit_of(key, meaning);
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
      const std::vector<std::string> here(known_.begin(), known_.end());
      throw std::invalid_argument(fmt::format(
          "{}: {}{}", place(key), entry_,
          unknown_key(path_ + std::string(key.str()), entry_.empty() ? names_of_keys() : here)));
    }
  }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& path,
                           const std::string& expected) const {
    throw std::invalid_argument(fmt::format("{}: {}{} must be {}, found {}", place(node), entry_,
                                            path, expected, value_in_words(node)));
  }

  template <typename Node>
  std::string place(const Node& node) const {
    return text_.place(static_cast<int>(node.source().begin.line));
  }

  void note_line(const toml::node& node, const std::string& path) {
    text_.lines[entry_ + path] = static_cast<int>(node.source().begin.line);
  }

  /// {v = VALUE} for a key that is newer than this text.
  toml::table value_before(const std::string& path) const {
    for (const auto& [key, value] : kKeysSince) {
      if (key == path) return toml::parse(fmt::format("v = {}", value));
    }
    throw std::invalid_argument(fmt::format(
        "{}: {}{} is missing; a trial must contain its whole scenario", text_.where, entry_, path));
  }

  [[noreturn]] void refuse_name(const toml::node& node, const std::string& path,
                                const NameList& names) const {
    refuse(node, path, fmt::format("\"{}\"", fmt::join(names, "\" or \"")));
  }

  static bool is_number(const toml::node& node, Range range) {
    const auto value = node.value<double>();
    const bool typed = node.is_integer() || node.is_floating_point();
    return typed && value && *value >= range.low && *value <= range.high;
  }

  /// "a number from 0 to 1"
  /// @param kind  number, whole number
  static std::string number_from_to(const char* kind, Range range) {
    return range.high == kAny.high ? fmt::format("a finite {}", kind)
                                   : fmt::format("a {} from {} to {}", kind, range.low, range.high);
  }

  /// Refuses a number in quotes, most often with a unit beside it, and says what to write.
  void refuse_quoted_number(const toml::node& node, const std::string& path, const char* kind,
                            Range range) const {
    const auto* text = node.as_string();
    const auto quoted = text ? quoted_number(text->get()) : std::nullopt;
    if (!quoted) return;
    const std::string allowed =
        unit_.empty() ? number_from_to(kind, range) : fmt::format("a {} in {}", kind, unit_);
    std::string advice;
    if (is_unit(quoted->unit, unit_)) {
      advice = fmt::format("; write {} = {}", path, quoted->number);
    } else if (unit_.empty()) {
      advice = "; units are metre, kilogram and second";
    }
    throw std::invalid_argument(fmt::format("{}: {}{} must be {}, found the text '{}'{}",
                                            place(node), entry_, path, allowed, brief(text->get()),
                                            advice));
  }

  /// The node as a list of `size` numbers (any number of them for size 0).
  /// @param entry  of a list of such lists, from 1; 0 where it is none
  /// @param whole  whether fractions are refused
  std::vector<double> numbers(const toml::node& node, const std::string& path, std::size_t size,
                              Range range, std::size_t entry = 0, bool whole = false) const {
    const auto named = [&](std::size_t item) {
      return fmt::format("{}{}{}", path, entry == 0 ? "" : fmt::format(", entry {}", entry),
                         item == 0 ? "" : fmt::format(", number {}", item));
    };
    const toml::array* array = node.as_array();
    if (!array || (size != 0 && array->size() != size)) {
      refuse(node, named(0),
             size == 0 ? "a list of numbers" : fmt::format("a list of {} numbers", size));
    }
    std::vector<double> values;
    for (const toml::node& item : *array) {
      if (!is_number(item, range) || (whole && !item.is_integer())) {
        refuse(item, named(values.size() + 1),
               number_from_to(whole ? "whole number" : "number", range));
      }
      values.push_back(*item.value<double>());
    }
    return values;
  }

  void read(const toml::node& node, const std::string& path, double& value, Range range) const {
    refuse_quoted_number(node, path, "number", range);
    if (!is_number(node, range)) refuse(node, path, number_from_to("number", range));
    value = *node.value<double>();
  }

  void read(const toml::node& node, const std::string& path, std::int64_t& value,
            Range range) const {
    refuse_quoted_number(node, path, "whole number", range);
    if (!node.is_integer() || !is_number(node, range)) {
      refuse(node, path, number_from_to("whole number", range));
    }
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
    if (!node.is_string()) refuse(node, path, "text");
    value = *node.value<std::string>();
  }

  void read(const toml::node& node, const std::string& path, std::string& value,
            const NameList& names) const {
    const auto* found = node.as_string();
    if (!found || std::ranges::find(names, found->get()) == names.end()) {
      refuse_name(node, path, names);
    }
    value = found->get();
  }

  template <Choice T, std::size_t N>
  void read(const toml::node& node, const std::string& path, T& value,
            const std::array<Named<T>, N>&) const {
    const auto* found = node.as_string();
    const std::optional<T> known = found ? value_named<T>(found->get()) : std::nullopt;
    if (!known) refuse_name(node, path, names_of<T>());
    value = *known;
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
    if (!array || array->empty() || array->size() > kMostSkittles) {  // nor has a profile more
      refuse(node, path, fmt::format("a list of 1 to {} pairs of numbers", kMostSkittles));
    }
    value.clear();
    for (const toml::node& item : *array) {
      const std::vector<double> v = numbers(item, path, 2, Range{-100, 100}, value.size() + 1);
      value.emplace_back(v[0], v[1]);
      note_line(item, fmt::format("{}[{}]", path, value.size()));
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<SkittlePart>& value,
            Range) {
    const toml::array* array = node.as_array();
    if (!array || array->empty() || array->size() > 16) {
      refuse(node, path, "a list of 1 to 16 parts");
    }
    value.clear();
    for (const toml::node& item : *array) {
      const std::string part = fmt::format("{}, part {}", path, value.size() + 1);
      if (!item.is_table()) refuse(item, part, "a table {shape, radius, low, high}");
      Reader inner(*item.as_table(), text_, "", part + ": ");
      visit(inner, value.emplace_back());
      note_line(item, fmt::format("{}[{}]", path, value.size()));
      inner.finish();
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<OilZone>& value, Range) {
    const toml::array* array = node.as_array();
    if (!array || array->size() > 1000) refuse(node, path, "a list of 1000 zones at most");
    value.clear();
    for (const toml::node& item : *array) {
      const std::string zone = fmt::format("{}, zone {}", path, value.size() + 1);
      if (!item.is_table()) {
        refuse(item, zone, "a table {first_board, last_board, from, to, friction}");
      }
      Reader inner(*item.as_table(), text_, "", zone + ": ");
      visit(inner, value.emplace_back());
      note_line(item, fmt::format("{}[{}]", path, value.size()));
      inner.finish();
    }
  }

  void read(const toml::node& node, const std::string& path, std::vector<Vec3>& value,
            Range range) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() > kMostOfHull) refuse(node, path, "a list of 2000 points at most");
    value.clear();
    for (const toml::node& item : *array) {
      const std::vector<double> v = numbers(item, path, 3, range, value.size() + 1);
      value.emplace_back(v[0], v[1], v[2]);
    }
  }

  void read(const toml::node& node, const std::string& path,
            std::vector<std::vector<std::uint32_t>>& value, Range) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() > kMostOfHull) refuse(node, path, "a list of 2000 faces at most");
    value.clear();
    for (const toml::node& item : *array) {
      std::vector<std::uint32_t>& face = value.emplace_back();
      for (const double corner :
           numbers(item, path, 0, Range{0, kMostOfHull}, value.size(), true)) {
        face.push_back(static_cast<std::uint32_t>(corner));
      }
    }
  }

  static constexpr std::size_t kMostOfHull = 2000;
  const toml::table& table_;
  ScenarioText& text_;
  std::string path_, entry_;
  std::string_view unit_;  ///< of the field that is read
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

void read_into(Scenario& scenario, const toml::table& table, ScenarioText& text) {
  Reader reader(table, text, "");
  visit(reader, scenario);
  reader.finish();
}

/// How a list of that kind is typed.
std::string_view typed_list(std::string_view kind) {
  if (kind == "list of tables") return "[{...}, ...]";
  if (kind == "list of pairs") return "[[x, y], ...]";
  return kind == "list of [x, y, z]" ? "[[x, y, z], ...]" : kind;  // [x, y, z] itself
}

/// Refuses a key that is none of TOML, and says what to type instead.
void require_dotted_names(const std::string& key, const ScenarioText& text) {
  if (const std::size_t bracket = key.find('['); bracket != std::string::npos) {
    const std::vector<ScenarioKey> keys = scenario_keys();
    const std::string name = key.substr(0, bracket);
    const auto list = std::ranges::find(keys, name, &ScenarioKey::key);
    if (list == keys.end()) {
      throw std::invalid_argument(
          fmt::format("{}: {}", text.where, unknown_key(name, names_of_keys())));
    }
    if (list->kind.find('[') == std::string::npos && !list->kind.starts_with("list")) {
      throw std::invalid_argument(
          fmt::format("{}: {} is no list; expected {}=VALUE", text.where, name, name));
    }
    throw std::invalid_argument(
        fmt::format("{}: one entry of a list cannot be set; expected the whole list, {}={}",
                    text.where, name, typed_list(list->kind)));
  }
  if (key.starts_with('.') || key.ends_with('.') || key.find("..") != std::string::npos) {
    throw std::invalid_argument(
        fmt::format("{}: expected a name on both sides of a dot, as in {}, found '{}'", text.where,
                    nearest(key, names_of_keys()).value_or("ball.mass"), brief(key)));
  }
}

/// Without spaces and tabs around it.
std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Whether the key is of text or of a choice, and the table has a number, a truth value or a date for it.
bool is_text_unquoted(const toml::table& table, std::string_view key) {
  static const std::set<std::string, std::less<>> kOfText = [] {
    std::set<std::string, std::less<>> found;
    for (const ScenarioKey& one : scenario_keys()) {
      if (one.kind == "text") found.insert(one.key);
    }
    return found;
  }();
  const auto node = table.at_path(key);
  return node && node.is_value() && !node.is_string() && kOfText.contains(key);
}

/// KEY=VALUE as TOML. A value that TOML does not know is text: `collision.shape=ellipsoid`. So is one
/// that TOML takes for something else, where the key is of text: `collision.shape=true`, `name=5`.
toml::table parse_assignment(std::string_view assignment, std::size_t equals,
                             const ScenarioText& text) {
  const std::string_view value = without_blanks(assignment.substr(equals + 1));
  try {
    toml::table table = parse_toml(assignment, text.where, true);
    if (!is_text_unquoted(table, without_blanks(assignment.substr(0, equals)))) return table;
  } catch (const std::invalid_argument&) {
    const bool meant_as_toml = value.find_first_of("[{'\"") == 0;
    if (meant_as_toml) throw;
  }
  return parse_toml(
      fmt::format("{}={}", assignment.substr(0, equals), Writer::text(std::string(value))),
      text.where, true);
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
  read_into(scenario, parse_toml(toml, text.where, text.one_line), text);
}

void read_assignment(Scenario& scenario, std::string_view assignment, ScenarioText& text) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw std::invalid_argument(
        fmt::format("{}: expected key=value, such as ball.mass=5", text.where));
  }
  require_dotted_names(std::string(without_blanks(assignment.substr(0, equals))), text);
  read_into(scenario, parse_assignment(assignment, equals, text), text);
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
