#include "scene/watch/recorded_display.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/record/events.h"

namespace headpin::scene {

namespace {

using nlohmann::json;

/// What an eye sees: angles from its axis [degrees], its place to the right of the head's middle [m],
/// and its pixels.
struct View {
  double outer, inner, up, down, x;
  int width, height;  ///< 0: not known
};

double number(const json& object, const char* name, double low, double high) {
  const auto found = object.find(name);
  const double value = found != object.end() && found->is_number() ? found->get<double>() : NAN;
  if (value >= low && value <= high) return value;
  throw std::invalid_argument(fmt::format(
      "event played_with: views: {}: expected a number from {} to {}", name, low, high));
}

View view_of(const json& object, bool left) {
  constexpr double kMost = 85.0;
  const double to_left = -number(object, "left", -kMost, 0.0);
  const double to_right = number(object, "right", 0.0, kMost);
  const json offset = object.value("offset", json::array());
  if (offset.size() != 3 || !offset[0].is_number()) {
    throw std::invalid_argument("event played_with: views: offset: expected three numbers");
  }
  const bool pixels = object.contains("width");
  return {.outer = left ? to_left : to_right,
          .inner = left ? to_right : to_left,
          .up = number(object, "up", 0.0, kMost),
          .down = -number(object, "down", -kMost, 0.0),
          .x = offset[0].get<double>(),
          .width = pixels ? static_cast<int>(number(object, "width", 1, 16384)) : 0,
          .height = pixels ? static_cast<int>(number(object, "height", 1, 16384)) : 0};
}

/// Pixels that are square, 1000 along the longer side.
void choose_pixels(View& view) {
  const auto extent = [](double a, double b) {
    constexpr double kRad = std::numbers::pi / 180.0;
    return std::tan(a * kRad) + std::tan(b * kRad);
  };
  const double wide = extent(view.outer, view.inner), high = extent(view.up, view.down);
  const double scale = 1000.0 / std::max(wide, high);
  view.width = std::max(1, static_cast<int>(std::lround(scale * wide)));
  view.height = std::max(1, static_cast<int>(std::lround(scale * high)));
}

/// The views of both eyes in the last event that has them.
json views_in(std::span<const Event> events) {
  json views;
  for (const Event& event : events) {
    if (event.kind != kind::played_with) continue;
    const json told = json::parse(event.detail.text(), nullptr, false);
    if (!told.is_object()) continue;
    const json found = told.value("views", json::array());
    if (found.size() == 2 && found[0].is_object() && found[1].is_object()) views = found;
  }
  if (views.is_null()) {
    throw std::invalid_argument(
        "hmd.profile=recorded: expected a trial that was played with a headset, found no event "
        "played_with with the views of two eyes");
  }
  return views;
}

}  // namespace

std::vector<std::string> recorded_display(std::span<const Event> events) {
  const json views = views_in(events);
  const bool swapped = views[0].value("eye", "left") == "right";
  const View left = view_of(views[swapped ? 1 : 0], true);
  const View right = view_of(views[swapped ? 0 : 1], false);
  View both = {.outer = 0.5 * (left.outer + right.outer),
               .inner = 0.5 * (left.inner + right.inner),
               .up = 0.5 * (left.up + right.up),
               .down = 0.5 * (left.down + right.down),
               .x = 0.5 * (right.x - left.x),
               .width = left.width,
               .height = left.height};
  if (both.width == 0) choose_pixels(both);
  std::vector<std::string> keys;
  const auto set = [&](const char* key, double value) {
    keys.push_back(fmt::format("hmd.{}={}", key, value));
  };
  keys.push_back(fmt::format("hmd.width={}", both.width));
  keys.push_back(fmt::format("hmd.height={}", both.height));
  set("horizontal_fov_deg", both.outer + both.inner);
  set("vertical_fov_deg", both.up + both.down);
  set("outer_deg", both.outer);
  set("inner_deg", both.inner);
  set("up_deg", both.up);
  set("down_deg", both.down);
  set("eye_distance", 2.0 * both.x);
  for (const char* zero : {"outward_deg", "lens_k1", "lens_k2"}) set(zero, 0.0);
  for (const char* zero : {"relay_width", "relay_height"}) {
    keys.push_back(fmt::format("hmd.{}=0", zero));
  }
  return keys;
}

}  // namespace headpin::scene
