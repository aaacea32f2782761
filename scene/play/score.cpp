#include "scene/play/score.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/play/game.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/scenario/text.h"
#include "scene/stage/stage.h"

namespace headpin::scene {

namespace {

/// The row of a throw, from the release of its ball.
ThrowRow thrown(const Event& release, const std::string& version) {
  ThrowRow row;
  row.version = version;
  row.body = release.bodies.front();
  row.release = release.time;
  row.speed = release.value;
  const Released told = release.detail.value_or(Released{});
  row.trigger_s = told.trigger_s;
  row.p_WB = told.p_WB;
  row.v_WB = told.v_WB;
  row.w_WB = told.w_WB;
  row.known = known_word(told);
  if (const auto motion = motion_of(release.detail)) {
    row.extrapolated_s = nearest_seconds(motion->extrapolated);
    row.left_out = motion->left_out;
  }
  if (row.p_WB) row.foul = row.p_WB->y() > kOnLine;
  return row;
}

/// The mark for a ball on the sheet: "foul (frame 2 ball 1)".
std::string mark(const Sheet& game, const std::string& what) {
  return fmt::format("{} (frame {} ball {})", what, game.frames.size(),
                     game.frames.back().size() + 1);
}

/// The ball and the number of the skittle that touched; nothing for other bodies.
std::optional<std::pair<std::string, int>> ball_and_skittle(const Event& event) {
  if (event.bodies.size() != 2) return std::nullopt;
  const std::size_t at = role_named(event.bodies[0]) == Role::ball ? 0 : 1;
  const std::optional<int> number = skittle_number(event.bodies[1 - at]);
  if (role_named(event.bodies[at]) != Role::ball || !number) return std::nullopt;
  return std::pair(event.bodies[at], *number);
}

}  // namespace

int skittles_in(const Event& event) {
  const bool possible = event.value >= 0.0 && event.value <= static_cast<double>(kMostSkittles) &&
                        event.value == std::floor(event.value);
  return possible ? static_cast<int>(event.value) : 0;
}

bool is_of_ball(const Event& event) {
  return !event.bodies.empty() && role_named(event.bodies.front()) == Role::ball;
}

double degrees_from_y(const Vec3& v) {
  const double speed = std::sqrt(v.x() * v.x() + v.y() * v.y());
  if (speed <= 0.0) return 0.0;
  // The rotation by half of the angle, from the one of two equal ratios that has no cancellation.
  Quat half = v.y() >= 0.0 ? Quat(speed + v.y(), 0.0, 0.0, v.x())
                           : Quat(std::abs(v.x()), 0.0, 0.0, std::copysign(speed - v.y(), v.x()));
  half.normalize();
  // Straight back, the series ends one bit beyond.
  return std::clamp(rotation_vector(half).z() * 180.0 / std::numbers::pi, -180.0, 180.0);
}

int points(const Sheet& sheet) {
  return points(rules_of(sheet.rules), sheet.frames, sheet.rack);
}

std::string in_words(const Sheet& sheet) {
  const std::string balls = in_words(rules_of(sheet.rules), sheet.frames, sheet.rack);
  return fmt::format("{}{}{}: {} = {}{}{}{}", sheet.version, sheet.version.empty() ? "" : " ",
                     name_of(sheet.rules), balls.empty() ? "no ball" : balls, points(sheet),
                     sheet.over ? "" : " (not over)", sheet.marks.empty() ? "" : "; ",
                     fmt::join(sheet.marks, ", "));
}

void Score::mark_foul(Sheet& game) {
  const std::string foul = mark(game, "foul");
  if (std::ranges::find(game.marks, foul) == game.marks.end()) game.marks.push_back(foul);
  current_.foul = true;
}

void Score::take_back(Sheet& game, Time now) {
  taken_back_ = {.at = now, .thrown = *current_.thrown, .foul = current_.foul};
  std::erase(game.marks, mark(game, "foul"));
  current_.thrown.reset();
  current_.foul = false;
}

/// Marks a foul, unless its ball is in the hand again before it counts as thrown. The events have where a
/// ball is let go, not where it is later: the referee also sees that a ball crosses the foul line.
void Score::follow_ball(const Event& event, const Scenario& scenario, Sheet& game) {
  constexpr std::int64_t kFar = 1'000'000'000'000;  // a damaged log may have any tick
  const bool simulated = event.tick >= 0 && event.tick < kFar;
  const Time now = !simulated ? event.time : tick_time(event.tick, scenario.rates.physics_hz);
  if (event.kind == kind::foul && !game.over) {
    mark_foul(game);
    if (!current_.thrown) current_.thrown = now;
  }
  if (event.kind == kind::first_contact) current_.struck = true;
  if (event.kind == kind::delivery) {
    current_.thrown.reset();
    current_.foul = current_.struck = false;
    taken_back_.reset();
  }
  if (!is_of_ball(event)) return;
  const std::string& ball = event.bodies.front();
  if (event.kind == kind::release) {
    current_.under_way.insert(ball);
    if (taken_back_ && taken_back_->at == now) {  // at the end of the tick no ball is in the hand
      current_.thrown = taken_back_->thrown;
      if (taken_back_->foul && !game.over) mark_foul(game);
    }
    taken_back_.reset();
    if (!current_.thrown) current_.thrown = now;
    if (scenario.game.hand_fells == HandFells::apart) current_.struck = false;
  }
  if (event.kind != kind::grab && event.kind != kind::ball_back) return;
  current_.under_way.erase(ball);
  if (event.kind != kind::grab || !current_.thrown || !current_.under_way.empty()) return;
  const CaughtBall caught{current_.struck, current_.foul, now - *current_.thrown};
  if (is_taken_back(scenario.game, caught)) take_back(game, now);
}

void Score::add_to_game(const Event& event, const Scenario& scenario) {
  if (const auto* rules = event.detail.get_if<GameKind>()) {
    if (games.empty()) skittles_down = felled_by_hand = 0;  // earlier falls are in no sheet
    games.push_back(
        {.version = version_, .rules = *rules, .rack = skittles_in(event), .frames = {{}}});
    current_ = {};
    taken_back_.reset();
  }
  if (games.empty()) return;
  Sheet& game = games.back();
  follow_ball(event, scenario, game);
  if (event.kind == kind::dead_wood) {
    game.marks.push_back(mark(game, fmt::format("{} by hand", skittles_in(event))));
    felled_by_hand += skittles_in(event);
  }
  if (event.kind == kind::set_again) {
    game.marks.push_back(mark(game, fmt::format("{} by a stray ball", skittles_in(event))));
  }
  if (event.kind == kind::delivery) {
    game.frames.back().push_back(skittles_in(event));
    skittles_down += skittles_in(event);
  }
  if (event.kind == kind::game_over) game.over = true;
  if (event.kind == kind::frame) game.frames.emplace_back();
}

/// The first contact of a thrown ball. That of a ball in the hand is none of the throw before.
void Score::add_entry(const Event& event) {
  const auto row = std::find_if(throws.rbegin(), throws.rend(), [&](const ThrowRow& t) {
    return std::ranges::find(event.bodies, t.body) != event.bodies.end();
  });
  if (row == throws.rend() || row->entry || in_hand_.contains(row->body)) return;
  row->entry = event.time;
  row->entry_speed = event.value;
  const auto* contact = event.detail.get_if<FirstContact>();
  if (contact) row->entry_angle_deg = degrees_from_y(contact->v_WB);
}

void Score::add_to_throw(const Event& event) {
  if (event.kind == kind::release && is_of_ball(event)) {
    throws.push_back(thrown(event, version_));
    in_hand_.erase(event.bodies.front());
    if (games.empty()) throws.back().felled_by_ball = throws.back().felled_by_hand = 0;
  }
  if (event.kind == kind::skittle_down && games.empty()) {
    const bool by_hand = event.detail.value_or(By::nobody) == By::hand;
    ++(by_hand ? felled_by_hand : skittles_down);
    if (!throws.empty()) ++*(by_hand ? throws.back().felled_by_hand : throws.back().felled_by_ball);
  }
  if (throws.empty()) {
    if (event.kind == kind::first_contact && !impact_speed) impact_speed = event.value;
    return;
  }
  if (event.kind == kind::first_contact) add_entry(event);
  ThrowRow& row = throws.back();
  if (event.kind == kind::dead_wood) row.felled_by_hand = skittles_in(event);
  if (event.kind == kind::delivery && !games.empty() && row.frame == 0) {
    row.frame = static_cast<int>(games.back().frames.size());
    row.ball = static_cast<int>(games.back().frames.back().size()) + 1;
    row.felled_by_ball = static_cast<int>(event.bodies.size());
    row.felled_by_hand = row.felled_by_hand.value_or(0);
    row.counted = skittles_in(event);
  }
  release_speed = throws.front().speed;
  impact_speed = throws.front().entry_speed;
}

/// What the ball of the last throw did on its way.
void Score::add_to_way(const Event& event) {
  if (throws.empty()) return;
  ThrowRow& row = throws.back();
  if (event.kind == kind::grab && is_of_ball(event) && in_hand_.size() < kMostSkittles) {
    in_hand_.insert(event.bodies.front());
  }
  if (event.kind == kind::ball_path && !event.bodies.empty() && event.bodies.front() == row.body) {
    if (const auto* path = event.detail.get_if<BallPath>()) row.path = *path;
  }
  const bool met = event.kind == kind::touch || event.kind == kind::first_contact;
  if (!met || in_hand_.contains(row.body) || row.frame != 0 || event.bodies.size() != 2) return;
  const bool is_first = event.bodies[0] == row.body;
  if (!is_first && event.bodies[1] != row.body) return;
  const std::optional<int> number = skittle_number(event.bodies[is_first ? 1 : 0]);
  if (number && std::ranges::find(row.touched, *number) == row.touched.end()) {
    row.touched.push_back(*number);
  }
}

/// What stands when a ball is counted. A rack of which all are down is set again; by some rules each is.
void Score::add_to_leave(const Event& event) {
  if (event.kind == kind::game || event.kind == kind::frame) down_.clear();
  const bool removes =
      event.kind == kind::dead_wood || (event.kind == kind::delivery && skittles_in(event) > 0);
  if (removes) down_.insert(event.bodies.begin(), event.bodies.end());
  if (event.kind != kind::delivery || throws.empty() || games.empty()) return;
  std::vector<int> standing;
  for (int number = 1; number <= games.back().rack; ++number) {
    if (!down_.contains(name_of_skittle(number))) standing.push_back(number);
  }
  throws.back().leave = fmt::format("{}", fmt::join(standing, "-"));
  if (standing.empty() || rules_of(games.back().rules).full_rack) down_.clear();
}

/// Counts each pair once. The first contact of a throw may be with a skittle that the ball had touched before, in the
/// hand or in an earlier throw.
void Score::add_to_touches(const Event& event) {
  constexpr std::size_t kMost = kMostSkittles;  // pairs to know; a damaged log may have any number
  if (event.kind == kind::version || event.kind == kind::game || event.kind == kind::delivery) {
    met_.clear();
  }
  if (event.kind == kind::ball_back && !event.bodies.empty()) {
    std::erase_if(met_, [&](const auto& pair) { return pair.first == event.bodies.front(); });
  }
  const bool first = event.kind == kind::first_contact;
  if (!first && event.kind != kind::touch) return;
  const auto pair = ball_and_skittle(event);
  const bool counted = first && pair && met_.contains(*pair);
  touches += counted ? 0 : 1;
  if (pair && met_.size() < kMost) met_.insert(*pair);
}

void Score::add(const Event& event, const Scenario& scenario) {
  if (event.kind == kind::version) version_ = event.detail.text();
  add_to_touches(event);
  add_to_way(event);
  add_to_throw(event);  // it has the number of the next ball
  add_to_leave(event);
  add_to_game(event, scenario);
}

Score score(std::span<const Event> events, const Scenario& scenario) {
  Score score;
  for (const Event& event : events) score.add(event, scenario);
  return score;
}

Score score(const TrialSummary& trial) {
  Scenario scenario;
  ScenarioText text{.where = "scenario", .whole = true};
  try {
    read_text(scenario, trial.header.scenario, text);
  } catch (const std::invalid_argument&) {
    scenario = {};
  }
  return score(trial.events, scenario);
}

}  // namespace headpin::scene
