#include "scene/play/presence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/non_colliding.h"
#include "scene/play/parabola.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

constexpr double kCrown = 0.12;       ///< above the eyes [m]
constexpr Time kAfterwards{300'000};  ///< moving away this late still counts
constexpr Time kFitted{200'000};      ///< time span of the fit for an acceleration
constexpr double kSlowAgain = 0.5;    ///< a slower body has been stopped [m/s]
constexpr double kAtItsHeight = 0.5;  ///< height within which up and down count as away [m]
constexpr double kOnItsWay = 0.05;    ///< this near to its path, both sides count as away [m]

/// Joint of head and neck, from between the eyes. Turning the head does not move it [m].
const Vec3 kNeckJoint(0.0, -0.08, 0.10);

/// A tick, and where the player is.
struct Sight : Tick {
  const Player& player;
  Time measured{};           ///< time at which the present poses were measured
  Vec3 p_WD;                 ///< head
  std::optional<Vec3> p_WH;  ///< hand
};

Vec3 level(const Vec3& v) {
  return {v.x(), v.y(), 0.0};
}

/// Distance of the surface of a body at `p_WB` from the line from the floor to the crown.
double to_upright(const Vec3& p_WB, double radius, const Vec3& p_WD) {
  const double above = std::max(0.0, p_WB.z() - (p_WD.z() + kCrown));
  const Vec3 aside = level(p_WB - p_WD) + Vec3(0.0, 0.0, above);
  return std::max(0.0, aside.norm() - radius);
}

double to_hand(const Vec3& p_WB, double radius, const Vec3& p_WH) {
  return std::max(0.0, (p_WB - p_WH).norm() - radius);
}

double radius_of(const Sight& sight, engine::BodyId body) {
  return sight.world.bodies[body].shape->bounding_radius;
}

std::optional<Passing> passing_of(const Sight& sight, engine::BodyId body) {
  return passing(sight.world.states[body], radius_of(sight, body), sight.p_WD, sight.p_WH,
                 sight.stage.scenario.collision.gravity);
}

/// Distance of a point from a convex part; 0 inside it.
double gap_to_part(const engine::Part& part, const Pose& X_WB, const Vec3& p_W) {
  constexpr double kDot = 1e-3, kFar = 100.0;  // radius of the sphere used as the point; [m]
  engine::KeptNormal normal;
  const engine::Closest found = engine::closest_points(
      part.shape, engine::Ellipsoid{Vec3::Constant(kDot)},
      (X_WB * part.X_BG).inverse() * Pose{Quat::Identity(), p_W}, normal, {.margin = kFar});
  return std::max(0.0, found.distance + kDot);
}

/// Distance of the line from the floor to `top` from a part. Along a line, the distance from a
/// convex part has one minimum, which a golden-section search finds.
double gap_to_part(const engine::Part& part, const Pose& X_WB, const Vec3& top, double floor) {
  constexpr double kGolden = 0.61803398874989485;
  constexpr int kCuts = 22;  // to 0.1 mm of 2 m
  const auto at = [&](double z) { return gap_to_part(part, X_WB, Vec3(top.x(), top.y(), z)); };
  double low = std::min(floor, top.z()), high = top.z();
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = at(a), at_b = at(b);
  for (int i = 0; i < kCuts; ++i) {
    if (at_a <= at_b) {
      high = b, b = a, at_b = at_a;
      at_a = at(a = high - kGolden * (high - low));
    } else {
      low = a, a = b, at_a = at_b;
      at_b = at(b = low + kGolden * (high - low));
    }
  }
  return std::min({at_a, at_b, at(low), at(high)});
}

/// Distance of a body's collision surface from the player.
double distance_now(const Sight& sight, engine::BodyId body) {
  const Pose& X_WB = sight.world.states[body].X_WB;
  if (sight.stage.roles[body] == Role::ball) {
    const double radius = radius_of(sight, body);
    const double upright = to_upright(X_WB.p, radius, sight.p_WD);
    return sight.p_WH ? std::min(upright, to_hand(X_WB.p, radius, *sight.p_WH)) : upright;
  }
  const Vec3 crown = sight.p_WD + Vec3(0.0, 0.0, kCrown);
  double least = std::numeric_limits<double>::max();
  for (const engine::Part& part : sight.world.bodies[body].shape->parts) {
    least = std::min(least, gap_to_part(part, X_WB, crown, 0.0));
    if (sight.p_WH) least = std::min(least, gap_to_part(part, X_WB, *sight.p_WH));
  }
  return least;
}

/// Acceleration of a tracked point in the tracked space, from the samples before `now`; zero if
/// there are too few [m/s^2].
Vec3 acceleration(std::span<const Stamped<Pose>> track, const Vec3& p_SQ, Time now) {
  constexpr std::size_t kFewest = 6;
  const double unit = seconds(kFitted);
  std::vector<double> t;  // of kFitted, from now
  std::vector<Vec3> p;
  for (const Stamped<Pose>& sample : track) {
    if (sample.time > now || sample.time < now - kFitted) continue;
    t.push_back(seconds(sample.time - now) / unit);
    p.push_back(sample.value * p_SQ);
  }
  if (t.size() < kFewest) return Vec3::Zero();
  return 2.0 / (unit * unit) * fit_parabola(t, p).coefficients.row(2).transpose();
}

/// Whether a hand moves far, as in a throw.
bool is_swinging(const devices::PoseTrack& hand, Time now) {
  constexpr double kSwing = 0.3;  // [m]
  const std::optional<Pose> before = hand.at(now - kFitted), after = hand.at(now);
  return !before || !after || (after->p - before->p).norm() > kSwing;
}

/// The part of an acceleration that leads away from a body that flies at the player.
///
/// @param p_WQ  the point that may be hit
double out_of_its_way(const Vec3& a, const Vec3& along_W, const Vec3& p_WB, const Vec3& p_WQ) {
  const Vec3 to_player = p_WQ - p_WB;
  const Vec3 side_W(along_W.y(), -along_W.x(), 0.0);
  const double offset = side_W.dot(to_player), aside = side_W.dot(a);
  double most = a.dot(along_W);
  most = std::max(most,
                  std::abs(offset) < kOnItsWay ? std::abs(aside) : (offset > 0.0 ? aside : -aside));
  if (std::abs(to_player.z()) < kAtItsHeight) {
    most = std::max(most, to_player.z() > 0.0 ? a.z() : -a.z());
  }
  return most;
}

Event seen_event(const Sight& sight, std::string_view kind, engine::BodyId body) {
  Event e = event(sight, kind, {body});
  e.p_W = sight.world.states[body].X_WB.p;
  return e;
}

/// Updates an approach by one tick.
void follow_approach(Approach& approach, const Sight& sight) {
  const engine::State& state = sight.world.states[approach.body];
  if (sight.world.bodies[approach.body].kind != engine::Kind::free) {
    // It was taken, or is back on its stand: it is not where it flew.
    if (!approach.passed) approach.passed = sight.moment.time;
    return;
  }
  if (!approach.passed) {
    approach.closest = std::min(approach.closest, distance_now(sight, approach.body));
    const bool gone = level(state.v_WB).norm() < kSlowAgain;
    if (gone || !passing_of(sight, approach.body)) approach.passed = sight.moment.time;
  }
  const Vec3 head = acceleration(sight.player.head.samples(), kNeckJoint, sight.measured);
  approach.head_away = std::max(approach.head_away,
                                out_of_its_way(head, approach.along_W, state.X_WB.p, sight.p_WD));
  if (!sight.p_WH || is_swinging(sight.player.hand, sight.measured)) return;
  const Vec3 hand = acceleration(sight.player.hand.samples(), Vec3::Zero(), sight.measured);
  approach.hand_away = std::max(approach.hand_away,
                                out_of_its_way(hand, approach.along_W, state.X_WB.p, *sight.p_WH));
}

Event passed_event(const Sight& sight, const Approach& approach) {
  Event e = seen_event(sight, kind::passed_player, approach.body);
  e.value = approach.closest;
  const double most = std::max(approach.head_away, approach.hand_away);
  e.detail = PassedPlayer{.noticed_s = nearest_seconds(approach.noticed),
                          .time_to_contact_s = approach.foreseen.time_s,
                          .foreseen_m = approach.foreseen.distance,
                          .at_hand = approach.foreseen.at_hand,
                          .head_away_mps2 = approach.head_away,
                          .hand_away_mps2 = approach.hand_away,
                          .moved = most >= kOutOfTheWay};
  return e;
}

/// Whether a body no longer counts as the player's own throw: it flies back, or it flies away and
/// is far enough.
bool is_nobodys(const Own& own, const Sight& sight) {
  const engine::State& state = sight.world.states[own.body];
  if (sight.world.bodies[own.body].kind != engine::Kind::free) return true;
  if (level(state.v_WB).dot(own.along_W) < 0.0) return true;
  return sight.player.leaving != own.body && !passing_of(sight, own.body) &&
         distance_now(sight, own.body) > Alarm{}.near;
}

/// Stores the bodies that the player has released, from the events of this tick so far.
void keep_own(Presence& presence, const Sight& sight) {
  std::erase_if(presence.own, [&](const Own& own) { return is_nobodys(own, sight); });
  for (const Event& e : sight.events) {
    if (e.kind != kind::release || e.tick != sight.moment.tick) continue;
    const auto keep = [&](engine::BodyId body) {
      if (sight.world.bodies[body].name != e.bodies.front()) return;
      presence.own.push_back({body, level(sight.world.states[body].v_WB)});
    };
    for (const engine::BodyId ball : sight.stage.balls) keep(ball);
    for (const engine::BodyId skittle : sight.stage.skittles) keep(skittle);
  }
}

/// Starts an approach if a body begins to fly at the player.
void notice(Presence& presence, const Sight& sight, engine::BodyId body) {
  const engine::State& state = sight.world.states[body];
  if (sight.world.bodies[body].kind != engine::Kind::free || engine::is_asleep(sight.world, body) ||
      is_own(presence, body)) {
    return;
  }
  if (std::ranges::any_of(presence.approaches,
                          [&](const Approach& known) { return known.body == body; })) {
    return;
  }
  const std::optional<Passing> coming = passing_of(sight, body);
  if (!coming || !is_coming(state, *coming)) return;
  presence.approaches.push_back({.body = body,
                                 .noticed = sight.moment.time,
                                 .foreseen = *coming,
                                 .along_W = level(state.v_WB).normalized(),
                                 .closest = distance_now(sight, body)});
  Event e = seen_event(sight, kind::flies_at_player, body);
  e.value = coming->time_s;
  sight.events.push_back(std::move(e));
}

}  // namespace

bool is_own(const Presence& presence, engine::BodyId body) {
  return std::ranges::any_of(presence.own, [&](const Own& own) { return own.body == body; });
}

std::optional<Passing> passing(const engine::State& state, double radius, const Vec3& p_WD,
                               const std::optional<Vec3>& p_WH, double gravity) {
  const Vec3 v = level(state.v_WB);
  const double square = v.squaredNorm();
  if (square == 0.0) return std::nullopt;
  const auto at = [&](const Vec3& p_WQ) { return v.dot(level(p_WQ - state.X_WB.p)) / square; };
  const auto then = [&](double t) {
    const double z = state.X_WB.p.z();
    const double floor = std::min(z, radius);
    return Vec3(state.X_WB.p.x() + t * v.x(), state.X_WB.p.y() + t * v.y(),
                std::max(floor, z + t * (state.v_WB.z() - 0.5 * gravity * t)));
  };
  // A body that was just thrown may come near the hand again while it flies away.
  const double time_s = at(p_WD);
  if (time_s <= 0.0) return std::nullopt;
  const Passing nearest{time_s, to_upright(then(time_s), radius, p_WD)};
  const double hand_s = p_WH ? at(*p_WH) : 0.0;
  if (hand_s <= 0.0) return nearest;
  const Passing of_hand{hand_s, to_hand(then(hand_s), radius, *p_WH), true};
  return of_hand.distance < nearest.distance ? of_hand : nearest;
}

bool is_coming(const engine::State& state, const Passing& passing) {
  const Alarm alarm;
  return passing.distance < alarm.near && passing.time_s < alarm.soon_s &&
         level(state.v_WB).norm() > alarm.fast;
}

void watch(Presence& presence, const Player& player, const Tick& tick) {
  const Time now = tick.moment.time;
  const Time measured = now - microseconds(tick.stage.scenario.rig.delay_s);
  const std::optional<Pose> X_PD = player.head.at(measured);
  if (!X_PD) return;
  Sight sight{tick, player, measured, player.walk.X_WP() * X_PD->p, {}};
  const auto X_PH = present_hand(player, tick.stage.scenario.rig, measured);
  if (X_PH) sight.p_WH = player.walk.X_WP() * X_PH->p;
  for (Approach& approach : presence.approaches) {
    follow_approach(approach, sight);
    if (approach.passed && now >= *approach.passed + kAfterwards) {
      tick.events.push_back(passed_event(sight, approach));
    }
  }
  std::erase_if(presence.approaches, [&](const Approach& approach) {
    return approach.passed && now >= *approach.passed + kAfterwards;
  });
  keep_own(presence, sight);
  for (const engine::BodyId ball : tick.stage.balls) notice(presence, sight, ball);
  for (const engine::BodyId skittle : tick.stage.skittles) notice(presence, sight, skittle);
}

nlohmann::json approaches_of(std::span<const Event> events) {
  nlohmann::json all = nlohmann::json::array();
  for (const Event& event : events) {
    if (!event.detail.get_if<PassedPlayer>()) continue;
    auto one = stored_json<nlohmann::json>(event.detail);
    one["time_s"] = nearest_seconds(event.time);
    one["body"] = event.bodies.empty() ? "" : event.bodies.front();
    one["closest_m"] = event.value;
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<std::string> approaches_in_words(std::span<const Event> events) {
  std::vector<std::string> words;
  for (const Event& event : events) {
    const auto* passed = event.detail.get_if<PassedPlayer>();
    if (!passed) continue;
    words.push_back(
        fmt::format("{} flew at the player: noticed at {:.3f} s, {:.2f} s ahead, {:.2f} m off at "
                    "the closest; {} "
                    "(head {:.1f}, hand {:.1f} m/s2 out of its way)",
                    event.bodies.empty() ? "" : event.bodies.front(), passed->noticed_s,
                    passed->time_to_contact_s, event.value, passed->moved ? "evaded" : "not evaded",
                    passed->head_away_mps2, passed->hand_away_mps2));
  }
  return words;
}

}  // namespace headpin::scene
