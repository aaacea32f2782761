#include "scene/scenario/keys.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/scenario/fields.h"
#include "scene/scenario/writer.h"

// Lists the keys of a scenario from the list of its fields.
namespace headpin::scene {
namespace {

/// Lists fields in their order, each with its data for documentation.
class Lister {
 public:
  template <typename T, typename Allowed>
  void field(std::string_view key, T& value, const Allowed& allowed, std::string_view meaning,
             std::string_view source = {}) {
    const std::string path = path_ + std::string(key);
    if (std::ranges::find(keys_, path, &ScenarioKey::key) != keys_.end()) return;
    keys_.push_back({path, kind(value), text(allowed), fallback(value), std::string(meaning),
                     std::string(source)});
    if constexpr (std::is_same_v<T, std::vector<SkittlePart>>) {
      for (const PartShape shape :
           {PartShape::ellipsoid, PartShape::polyhedron}) {  // these shapes have other keys
        SkittlePart part{.shape = shape};
        section(std::string(key) + "[]", "", part);
      }
    }
    if constexpr (std::is_same_v<T, std::vector<OilZone>>) {
      OilZone zone;
      section(std::string(key) + "[]", "", zone);
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
  static std::string kind(const std::vector<Vec3>&) { return "list of [x, y, z]"; }
  static std::string kind(const std::vector<std::vector<std::uint32_t>>&) {
    return "list of lists of whole numbers";
  }
  static std::string kind(const std::vector<SkittlePart>&) { return "list of tables"; }
  static std::string kind(const std::vector<OilZone>&) { return "list of tables"; }
  template <std::integral T>
  static std::string kind(T) {
    return "whole number";
  }
  template <Choice T>
  static std::string kind(T) {
    return "text";
  }

  static std::string text(Range range) {
    if (range.high == kAny.high) return "";
    return fmt::format("{} to {}", range.low, range.high);
  }
  static std::string text(const NameList& names) {
    return fmt::format("{}", fmt::join(names, ", "));
  }
  template <typename T, std::size_t N>
  static std::string text(const std::array<Named<T>, N>&) {
    return text(names_of<T>());
  }

  /// The default as text; empty for a list, which is too long.
  template <typename T>
  static std::string fallback(const T& value) {
    const std::string text = Writer::text(value);
    return text.find('\n') == std::string::npos ? text : "";
  }

  std::vector<ScenarioKey> keys_;
  std::string path_;
};

}  // namespace

std::vector<ScenarioKey> scenario_keys() {
  Lister lister;
  Scenario scenario;
  visit(lister, scenario);
  return std::move(lister).keys();
}

}  // namespace headpin::scene
