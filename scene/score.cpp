#include "scene/score.h"

#include <fmt/format.h>

#include "scene/events.h"

namespace headpin::scene {

int points(const Sheet& sheet) {
  return points(rules_named(sheet.rules), sheet.frames, sheet.rack);
}

std::string in_words(const Sheet& sheet) {
  const std::string balls = in_words(rules_named(sheet.rules), sheet.frames, sheet.rack);
  return fmt::format("{}{}{}: {} = {}{}", sheet.version, sheet.version.empty() ? "" : " ",
                     sheet.rules, balls.empty() ? "no ball" : balls, points(sheet),
                     sheet.over ? "" : " (not over)");
}

void Score::add(const devices::Event& event) {
  if (event.kind == kind::version) version_ = event.detail;
  if (event.kind == kind::game && is_rules(event.detail)) {
    games.push_back({.version = version_,
                     .rules = event.detail,
                     .rack = static_cast<int>(event.value),
                     .frames = {{}}});
  }
  if (!games.empty()) {
    Sheet& game = games.back();
    if (event.kind == kind::delivery) game.frames.back().push_back(static_cast<int>(event.value));
    if (event.kind == kind::game_over) game.over = true;
    if (event.kind == kind::frame) game.frames.emplace_back();
  }
  touches += event.kind == kind::touch || event.kind == kind::first_contact;
  skittles_down += event.kind == kind::skittle_down;
  const bool of_ball = !event.bodies.empty() && event.bodies.front().starts_with("ball");
  if (event.kind == kind::release && of_ball && !release_speed) release_speed = event.value;
  if (event.kind == kind::first_contact && !impact_speed) impact_speed = event.value;
}

Score score(std::span<const devices::Event> events) {
  Score score;
  for (const devices::Event& event : events) score.add(event);
  return score;
}

}  // namespace headpin::scene
