#include "scene/scenario.h"

#include <array>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "engine/response.h"
#include "render/hmd.h"
#include "scene/scenario_checks.h"
#include "scene/scenario_files.h"
#include "scene/toml_text.h"

namespace headpin::scene {

namespace {

/// Enough of a text to know it again.
std::string brief(std::string_view text) {
  constexpr std::size_t kMost = 60;
  return text.size() <= kMost ? std::string(text) : std::string(text.substr(0, kMost)) + "...";
}

struct Range {
  double low, high;
};
constexpr Range kAny{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
constexpr Range kUnit{0.0, 1.0};

using Choices = std::vector<std::string_view>;

Choices response_names() {
  Choices names;
  for (const engine::Response& response : engine::responses()) names.push_back(response.name);
  return names;
}

// The fields, listed once: read, written and checked by the same list. A visitor takes
// field(key, value, allowed, meaning, source) and section(key, meaning, part). The meaning is true
// of any value, the source of the default alone.

template <typename V>
void visit(V& v, Rates& r) {
  v.field("physics_hz", r.physics_hz, Range{120, 99'960}, "steps per second, a multiple of 120");
  v.field("frame_hz", r.frame_hz, Range{1, 1000}, "pictures of each eye per second");
}

template <typename V>
void visit(V& v, Room& r) {
  v.field("width", r.width, Range{1, 100}, "wall to wall, the lane in the middle");
  v.field("height", r.height, Range{1, 100}, "floor to ceiling");
  v.field("behind", r.behind, Range{0.5, 100}, "foul line to the wall behind the player");
  v.field("ahead", r.ahead, Range{1, 100}, "foul line to the wall behind the skittles");
}

template <typename V>
void visit(V& v, Lane& l) {
  v.field("width", l.width, Range{0.2, 20}, "", "41.5 in: USBC");
  v.field("head_pin", l.head_pin, Range{0.5, 50},
          "foul line to head pin; 18.288 is regulation (60 ft: USBC)");
}

template <typename V>
void visit(V& v, Rack& r) {
  v.field("spots", r.spots, kAny, "[x right, y away] from the head pin's spot",
          "12 in apart in a triangle: USBC");
}

template <typename V>
void visit(V& v, SkittlePart& p) {
  v.field("shape", p.shape, Choices{"ellipsoid", "cylinder", "cone"}, "");
  v.field("radius", p.radius, Range{1e-3, 1}, "across the axis");
  v.field("low", p.low, Range{0, 2}, "above the base");
  v.field("high", p.high, Range{0, 2}, "above the base");
}

template <typename V>
void visit(V& v, Skittle& s) {
  v.field("height", s.height, Range{0.05, 2}, "", "15.000 in: USBC");
  v.field("mass", s.mass, Range{0.01, 100}, "", "3 lb 8 oz: USBC");
  v.field("rolling_arm", s.rolling_arm, Range{0, 0.1},
          "rolling resistance: its load acts this far ahead; brings a skittle on its side to rest");
  v.field("parts", s.parts, kAny, "its true shape as collisions see it, base upwards");
  v.field("profile", s.profile, kAny, "[height above the base, radius] as eyes see it",
          "USBC, necks from pin drawings");
}

template <typename V>
void visit(V& v, Ball& b) {
  v.field("radius", b.radius, Range{0.01, 1}, "USBC allows 8.500 to 8.595 in across", "8.54 in");
  v.field("mass", b.mass, Range{0.01, 100}, "USBC allows 16 lb", "15 lb");
  v.field("home", b.home, Range{-100, 100}, "its centre on the stand, in the world");
}

template <typename V>
void visit(V& v, Material& m) {
  v.field("elasticity", m.elasticity, kUnit, "a pair takes the product",
          "Uno & Slater 1997, table 1");
  v.field("friction", m.friction, kUnit, "a pair takes the product", "Uno & Slater 1997, table 1");
}

template <typename V>
void visit(V& v, Materials& m) {
  v.section("skittle", "", m.skittle);
  v.section("ball", "", m.ball);
  v.section("lane", "", m.lane);
  v.section("wall", "", m.wall);
}

template <typename V>
void visit(V& v, Collision& c) {
  v.field("shape", c.shape, Choices{"true", "ellipsoid"}, "table 1");
  v.field("detection", c.detection, Choices{"converged", "paper"},
          "paper: the iteration stops at the cap, as in 1997");
  v.field("iterations", c.iterations, Range{5, 20}, "cap of a query; 20 in the paper");
  v.field("warm", c.warm, kAny, "paper detection starts from the last normal; not so in 1997");
  v.field("response", c.response, response_names(), "");
  v.field("gravity", c.gravity, Range{0, 1000}, "");
  v.field("sleep", c.sleep, kAny, "bodies at rest are left alone until touched");
}

template <typename V>
void visit(V& v, Hand& h) {
  v.field("reach", h.reach, Range{0, 10}, "grabs a ball whose surface is this near");
  v.field("grip", h.grip, Range{-1, 1}, "centre of the carried ball in the hand");
  v.field("release_window_s", h.release_window_s, Range{0.01, 1},
          "the release velocity is the slope of a parabola fitted over this");
  v.field("release_window_most_s", h.release_window_most_s, Range{0.01, 1},
          "and over up to this where the tracker is noisy");
  v.field("release_accuracy", h.release_accuracy, Range{0, 1000},
          "that is, while the fit knows it worse than this");
}

template <typename V>
void visit(V& v, Rig& r) {
  v.field("head_station", r.head_station, Range{1, 4}, "of the sensor worn on the head");
  v.field("hand_station", r.hand_station, Range{1, 4}, "of the one on the 3D mouse in the hand");
  v.field("X_WT", r.X_WT, kAny, "transmitter in the world; q is w, x, y, z");
  v.field("X_SD", r.X_SD, kAny, "head's receiver to display");
  v.field("X_SH", r.X_SH, kAny, "hand's receiver to virtual hand");
  v.field("delay_s", r.delay_s, Range{0, 1},
          "poses are read this long before now, between two samples; 0 holds the last");
}

template <typename V>
void visit(V& v, Hmd& h) {
  v.field("profile", h, kAny,
          "one of " + render::hmd_profile_names() + "; values given here override it");
  render::Optics& o = h.optics;
  v.field("width", o.width, Range{1, 16384}, "pixels of an eye", "Uno & Slater 1997, section 3");
  v.field("height", o.height, Range{1, 16384}, "");
  v.field("horizontal_fov_deg", o.horizontal_fov_deg, Range{1, 170}, "of an eye");
  v.field("vertical_fov_deg", o.vertical_fov_deg, Range{1, 170}, "of an eye");
  v.field("eye_distance", o.eye_distance, Range{0, 1}, "between the eyes",
          "64 mm between the LEEP lenses' axes");
  v.field("outward_deg", o.outward_deg, Range{-60, 60}, "each eye's axis turned outward");
}

template <typename V>
void visit(V& v, Scenario& s) {
  v.field("name", s.name, kAny, "");
  v.section("rates", "", s.rates);
  v.section("room", "metre, kilogram, second unless a name says otherwise", s.room);
  v.section("lane", "", s.lane);
  v.section("rack", "", s.rack);
  v.section("skittle", "", s.skittle);
  v.section("ball", "", s.ball);
  v.section("material", "", s.material);
  v.section("collision", "", s.collision);
  v.section("hand", "", s.hand);
  v.section("rig", "", s.rig);
  v.section("hmd", "", s.hmd);
}

/// A text that a scenario is read from.
struct Text {
  std::string where;   ///< its name, for messages
  bool lines = true;   ///< it has more than one
  bool whole = false;  ///< it must have every key

  std::string place(const toml::source_region& at) const {
    return lines ? fmt::format("{}:{}", where, at.begin.line) : where;
  }
};

/// Keys that trials of before these keys were there lack, with what such a trial ran under. What is
/// written here never changes, whatever becomes of the defaults.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kKeysSince{{
    {"hand.release_window_most_s", "0.12"},
    {"hand.release_accuracy", "0.3"},
    {"collision.warm", "true"},
    {"rig.head_station", "1"},
    {"rig.hand_station", "2"},
}};

/// Fills fields from a TOML table; refuses what it does not know.
class Reader {
 public:
  Reader(const toml::table& table, const Text& text, std::string path, Lines& lines)
      : table_(table), text_(text), path_(std::move(path)), lines_(lines) {}

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
    Reader inner(node ? *node->as_table() : none, text_, path_ + std::string(key) + ".", lines_);
    visit(inner, part);
    inner.finish();
  }

  /// To be called last: complains about the first key that no field asked for.
  void finish() const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string names;
      for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
      throw std::invalid_argument(fmt::format("{}: unknown key '{}{}'; known here: {}",
                                              text_.place(key.source()), path_, brief(key.str()),
                                              names));
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
    throw std::invalid_argument(fmt::format("{}: {} must be {}, found {}",
                                            text_.place(node.source()), path, expected,
                                            brief(found.str())));
  }

  void note_line(const toml::node& node, const std::string& path) const {
    if (text_.lines) lines_[path] = static_cast<int>(node.source().begin.line);
  }

  /// {v = VALUE} for a key that came later than the text at hand.
  toml::table value_before(const std::string& path) const {
    for (const auto& [key, value] : kKeysSince) {
      if (key == path) return toml::parse(fmt::format("v = {}", value));
    }
    throw std::invalid_argument(fmt::format(
        "{}: {} is missing; a trial carries all of its scenario, or nobody knows what it ran under",
        text_.where, path));
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

  /// By the name of its profile, which sets all of it.
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

  void read(const toml::node& node, const std::string& path, std::vector<Vec2>& value,
            Range) const {
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
            Range) const {
    const toml::array* array = node.as_array();
    if (!array || array->empty() || array->size() > 16) refuse(node, path, "1 to 16 parts");
    value.clear();
    for (const toml::node& item : *array) {
      if (!item.is_table()) refuse(item, path, "tables {shape, radius, low, high}");
      Reader inner(*item.as_table(), text_, path + ".", lines_);
      visit(inner, value.emplace_back());
      note_line(item, fmt::format("{}[{}]", path, value.size()));
      inner.finish();
      if (!(value.back().low < value.back().high)) refuse(item, path, "low below high");
    }
  }

  const toml::table& table_;
  const Text& text_;
  std::string path_;
  Lines& lines_;
  std::set<std::string> known_;
};

/// A float as TOML wants it: shortest text that reads back to the same bits.
std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// Writes fields in their order, each with its meaning beside it, and where it is from if it is
/// still the value that is from there.
class Writer {
 public:
  /// @param sourced  the values that the sources are of, by key; none for no sources
  explicit Writer(const std::map<std::string, std::string>& sourced) : sourced_(sourced) {}

  template <typename T, typename Allowed>
  void field(std::string_view key, const T& value, const Allowed&, std::string_view meaning,
             std::string_view source = {}) {
    const std::string path = path_ + "." + std::string(key), written = text(value);
    const auto usual = sourced_.find(path);
    if (usual == sourced_.end() || usual->second != written) source = {};
    written_[path] = written;
    out_ += fmt::format("{} = {}", key, written);
    if (!meaning.empty() || !source.empty()) {
      out_ +=
          fmt::format("  # {}{}{}", meaning, meaning.empty() || source.empty() ? "" : "; ", source);
    }
    out_ += "\n";
  }

  template <typename T>
  void section(std::string_view key, std::string_view meaning, T& part) {
    const std::string outer = path_;
    path_ += (path_.empty() ? "" : ".") + std::string(key);
    out_ += fmt::format("\n[{}]{}\n", path_, meaning.empty() ? "" : fmt::format("  # {}", meaning));
    visit(*this, part);
    path_ = outer;
  }

  std::string out() && { return std::move(out_); }
  std::map<std::string, std::string> written() && { return std::move(written_); }

  static std::string text(double value) { return number_text(value); }
  static std::string text(std::int64_t value) { return fmt::format("{}", value); }
  static std::string text(int value) { return fmt::format("{}", value); }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static std::string text(const std::string& value) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    return quoted.str();
  }
  static std::string text(const Hmd& hmd) { return text(hmd.profile); }
  static std::string text(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", text(v.x()), text(v.y()), text(v.z()));
  }
  static std::string text(const Pose& X) {
    return fmt::format("{{p = {}, q = [{}, {}, {}, {}]}}", text(X.p), text(X.q.w()), text(X.q.x()),
                       text(X.q.y()), text(X.q.z()));
  }
  static std::string text(const std::vector<Vec2>& points) {
    std::string all = "[";
    for (const Vec2& p : points) all += fmt::format("\n  [{}, {}],", text(p.x()), text(p.y()));
    return all + "\n]";
  }
  static std::string text(const std::vector<SkittlePart>& parts) {
    std::string all = "[";
    for (const SkittlePart& p : parts) {
      all += fmt::format("\n  {{shape = {}, radius = {}, low = {}, high = {}}},", text(p.shape),
                         text(p.radius), text(p.low), text(p.high));
    }
    return all + "\n]";
  }

 private:
  const std::map<std::string, std::string>& sourced_;
  std::map<std::string, std::string> written_;  // by key
  std::string out_;
  std::string path_;
};

/// Lists fields in their order, each with what a reader wants to know of it.
class Lister {
 public:
  template <typename T, typename Allowed>
  void field(std::string_view key, T& value, const Allowed& allowed, std::string_view meaning,
             std::string_view source = {}) {
    keys_.push_back({path_ + std::string(key), kind(value), text(allowed), fallback(value),
                     std::string(meaning), std::string(source)});
    if constexpr (std::is_same_v<T, std::vector<SkittlePart>>) {
      SkittlePart part;
      section(std::string(key) + "[]", "", part);
    }
  }

  template <typename T>
  void section(std::string_view key, std::string_view meaning, T& part) {
    const std::string outer = path_;
    path_ += std::string(key);
    if (!meaning.empty()) keys_.push_back({path_, "table", "", "", std::string(meaning), ""});
    path_ += ".";
    visit(*this, part);
    path_ = outer;
  }

  std::vector<ScenarioKey> keys() && { return std::move(keys_); }

 private:
  static std::string kind(double) { return "number"; }
  static std::string kind(bool) { return "true or false"; }
  static std::string kind(const std::string&) { return "text"; }
  static std::string kind(const Hmd&) { return "text"; }
  static std::string kind(const Vec3&) { return "[x, y, z]"; }
  static std::string kind(const Pose&) { return "{p = [x, y, z], q = [w, x, y, z]}"; }
  static std::string kind(const std::vector<Vec2>&) { return "list of pairs"; }
  static std::string kind(const std::vector<SkittlePart>&) { return "list of tables"; }
  template <std::integral T>
  static std::string kind(T) {
    return "whole number";
  }

  static std::string text(Range range) {
    if (range.high == kAny.high) return "";
    return fmt::format("{} to {}", range.low, range.high);
  }
  static std::string text(const Choices& choices) {
    return fmt::format("{}", fmt::join(choices, ", "));
  }

  /// Empty where the default is a list, too long to be shown.
  template <typename T>
  static std::string fallback(const T& value) {
    const std::string text = Writer::text(value);
    return text.find('\n') == std::string::npos ? text : "";
  }

  std::vector<ScenarioKey> keys_;
  std::string path_;
};

toml::table parse_table(std::string_view toml, const Text& text) {
  require_shallow(toml, text.where);
  try {
    return toml::parse(toml);
  } catch (const toml::parse_error& error) {
    throw std::invalid_argument(
        fmt::format("{}: not TOML: {}", text.place(error.source()), brief(error.description())));
  }
}

void read_into(Scenario& scenario, const toml::table& table, const Text& text) {
  Lines lines;
  Reader reader(table, text, "", lines);
  visit(reader, scenario);
  reader.finish();
  check(scenario, text.where, lines);
}

/// Rounded, so that the text of a scenario shows measures and not the noise of a product.
double ten_micrometres(double length) {
  return std::round(length * 1e5) / 1e5;
}

}  // namespace

Hmd hmd_of_profile(std::string_view name) {
  const render::HmdProfile& profile = render::hmd_profile(name);
  return {std::string(profile.name), profile.optics};
}

Scenario::Scenario() : hmd(hmd_of_profile(render::hmd_profiles().front().name)) {
  // Ten pins: pins 12 in = 0.3048 m apart, so rows 10.392 in = 0.26396 m apart (USBC).
  for (int r = 0; r < 4; ++r) {
    for (int i = 0; i <= r; ++i) {
      rack.spots.emplace_back(ten_micrometres((i - 0.5 * r) * 0.3048),
                              ten_micrometres(r * 0.26396));
    }
  }
  skittle.parts = {{"cylinder", 0.0258, 0.0, 0.06},
                   {"ellipsoid", 0.0605, 0.006, 0.226},
                   {"cylinder", 0.0235, 0.18, 0.34},
                   {"ellipsoid", 0.0325, 0.316, 0.381}};
  const double inch = 0.0254;
  for (const auto& [h, d] : {std::pair{0.0, 2.031},
                             {0.75, 2.828},
                             {2.25, 3.906},
                             {3.375, 4.510},
                             {4.5, 4.766},
                             {5.875, 4.563},
                             {7.25, 3.703},
                             {8.625, 2.472},
                             {9.375, 1.965},
                             {10.0, 1.797},
                             {10.875, 1.870},
                             {11.75, 2.094},
                             {12.625, 2.406},
                             {13.5, 2.547},
                             {15.0, 0.0}}) {
    skittle.profile.emplace_back(ten_micrometres(h * inch), ten_micrometres(0.5 * d * inch));
  }
}

Scenario parse_scenario(std::string_view toml, std::string_view where) {
  Scenario scenario;
  const Text text{std::string(where)};
  read_into(scenario, parse_table(toml, text), text);
  return scenario;
}

Scenario scenario_of_trial(std::string_view toml, std::string_view trial) {
  Scenario scenario;
  const Text text{.where = fmt::format("{} (scenario)", trial), .whole = true};
  read_into(scenario, parse_table(toml, text), text);
  return scenario;
}

Scenario load_scenario(const std::string& name_or_file) {
  const std::string path = scenario_path(name_or_file);
  return parse_scenario(read_scenario_file(path), path);
}

std::string to_toml(const Scenario& scenario) {
  // The list of fields is one for reading and writing, so it takes what it could change.
  Scenario usual, copy = scenario;
  const std::map<std::string, std::string> none;
  Writer first(none);
  visit(first, usual);
  const std::map<std::string, std::string> sourced = std::move(first).written();
  Writer writer(sourced);
  visit(writer, copy);
  return std::move(writer).out();
}

void check(const Scenario& scenario, std::string_view where) {
  check(scenario, where, {});
}

std::vector<ScenarioKey> scenario_keys() {
  Lister lister;
  Scenario scenario;
  visit(lister, scenario);
  return std::move(lister).keys();
}

void set(Scenario& scenario, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw std::invalid_argument(
        fmt::format("--set {}: expected key=value, such as ball.mass=5", brief(assignment)));
  }
  const Text text{.where = fmt::format("--set {}", brief(assignment)), .lines = false};
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

void set_elasticity(Materials& materials, double elasticity) {
  for (Material* m : {&materials.skittle, &materials.ball, &materials.lane, &materials.wall}) {
    m->elasticity = elasticity;
  }
}

void set_friction(Materials& materials, double friction) {
  for (Material* m : {&materials.skittle, &materials.ball, &materials.lane, &materials.wall}) {
    m->friction = friction;
  }
}

}  // namespace headpin::scene
