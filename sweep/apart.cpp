#include "sweep/apart.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "scene/record/events.h"
#include "scene/scenario/fields.h"

namespace headpin::sweep {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Time kSpeedOver{100'000};  ///< time span for a speed (Snowden and Braddick 1991)
constexpr double kNoBounce = 0.001;  ///< [m]; a ball that rolls does not bounce

/// Angle between two directions [rad], accurate also for tiny angles.
double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Vec3 middle(const Place& place) {
  return 0.5 * (place[0] + place[1]);
}

/// Stores the largest difference, and the time when one was first above the threshold.
void take(Difference& kept, const Difference& now) {
  const std::optional<Time> first = kept.first        ? kept.first
                                    : now.times > 1.0 ? std::optional(now.at)
                                                      : std::nullopt;
  if (now.size > kept.size) kept = now;
  kept.first = first;
}

/// The numbers of a display, by name.
struct DisplayNumbers {
  std::vector<std::pair<std::string, double>> all = {};

  template <typename T, typename... Rest>
  void field(const char* name, T& value, const Rest&...) {
    if constexpr (std::is_arithmetic_v<T>) all.emplace_back(name, static_cast<double>(value));
  }
};

/// Gives edges by the same values as another display whose edges are equal.
void name_edges_alike(render::Optics& optics, const render::Optics& other) {
  if (optics.edges_deg() != other.edges_deg()) return;
  optics.horizontal_fov_deg = other.horizontal_fov_deg;
  optics.vertical_fov_deg = other.vertical_fov_deg;
  optics.outer_deg = other.outer_deg;
  optics.inner_deg = other.inner_deg;
  optics.up_deg = other.up_deg;
  optics.down_deg = other.down_deg;
}

/// Refuses two displays: what both show is measured in one.
void require_same_display(scene::Hmd a, scene::Hmd b, const Apart::Names& names) {
  name_edges_alike(b.optics, a.optics);
  DisplayNumbers of_a, of_b;
  scene::visit(of_a, a);
  scene::visit(of_b, b);
  for (std::size_t i = 0; i < of_a.all.size(); ++i) {
    const double in_a = of_a.all[i].second, in_b = of_b.all[i].second;
    if (in_a == in_b) continue;
    throw std::invalid_argument(
        fmt::format("{}: has hmd.{} = {}, {} has {}; expected the same display", names[1],
                    of_a.all[i].first, in_b, names[0], in_a));
  }
}

/// Refuses two stages whose balls and skittles are not the same ones.
void require_same_bodies(const scene::Stage& a, const scene::Stage& b, const Apart::Names& names) {
  if (names_of_places(a) == names_of_places(b)) return;
  std::string what = fmt::format("has other balls or skittles than {}", names[0]);
  for (const auto& [kind, of_a, of_b] : {std::tuple{"ball", a.balls.size(), b.balls.size()},
                                         {"skittle", a.skittles.size(), b.skittles.size()}}) {
    if (of_a == of_b) continue;
    what = fmt::format("has {} {}{}, {} has {}", of_b, kind, of_b == 1 ? "" : "s", names[0], of_a);
  }
  throw std::invalid_argument(
      fmt::format("{}: {}; expected the same balls and skittles", names[1], what));
}

/// How skittles are drawn otherwise in B: in another shape, or at another height above the base.
std::string drawn_otherwise(const scene::Stage& a, const scene::Stage& b) {
  const scene::SkittleLook in_a = scene::skittle_look(a, scene::drawn_centres(a)),
                           in_b = scene::skittle_look(b, scene::drawn_centres(b));
  if (in_a.ellipsoid != in_b.ellipsoid)
    return "Skittles are drawn in another shape, which is not compared.";
  if (!in_a.ellipsoid) return "";
  const double higher = in_b.raised + b.skittle_centre - in_a.raised - a.skittle_centre;
  if (std::abs(higher) < 1e-6) return "";
  return fmt::format("Skittles are drawn {:.3g} mm {} in the second, which is not compared.",
                     1e3 * std::abs(higher), higher > 0.0 ? "higher" : "lower");
}

}  // namespace

Places places_of(const scene::Session& session) {
  const scene::Stage& stage = *session.stage;
  Places places{.balls = stage.balls.size(), .of = {}};
  for (const engine::BodyId ball : stage.balls) {
    const Vec3& p_WB = session.world.states[ball].X_WB.p;
    places.of.push_back(Place{p_WB, p_WB});
  }
  for (const engine::BodyId skittle : stage.skittles) {
    if (session.game.swept[skittle]) {
      places.of.emplace_back();
      continue;
    }
    const Pose& X_WB = session.world.states[skittle].X_WB;
    const double foot = -stage.skittle_centre, head = foot + stage.scenario.skittle.height;
    places.of.push_back(Place{X_WB * Vec3(0.0, 0.0, foot), X_WB * Vec3(0.0, 0.0, head)});
  }
  return places;
}

std::vector<std::string> names_of_places(const scene::Stage& stage) {
  const std::vector<std::string> names = scene::body_names(stage);
  std::vector<std::string> found;
  for (const auto* bodies : {&stage.balls, &stage.skittles}) {
    for (const engine::BodyId body : *bodies) found.push_back(names[body]);
  }
  return found;
}

double arcmin_between(const Vec3& p_WE, const Vec3& a_W, const Vec3& b_W) {
  return 60.0 / kDegree * angle_between(a_W - p_WE, b_W - p_WE);
}

double arcmin_between(const Vec3& p_WE, const Place& a, const Place& b) {
  return std::max(arcmin_between(p_WE, a[0], b[0]), arcmin_between(p_WE, a[1], b[1]));
}

/// Height of a body's impact on something at rest within a tick, in which it fell from z0 at v0 < 0 and
/// rose to z1 at v1 > 0: where both straight ways meet.
double height_of_impact(double z0, double v0, double z1, double v1, double dt) {
  const double t = (z0 - z1 + v1 * dt) / (v1 - v0);
  return std::min({z0 + v0 * std::clamp(t, 0.0, dt), z0, z1});
}

std::optional<std::int64_t> frame_of(std::int64_t tick, const scene::Rates& rates) {
  const auto frame_at = [&](std::int64_t t) { return t * rates.frame_hz / rates.physics_hz; };
  if (frame_at(tick) == frame_at(tick - 1)) return std::nullopt;
  return frame_at(tick);
}

std::optional<double> arcmin_in_view(const scene::Session& session, const Places& other) {
  const Places places = places_of(session);
  if (places.balls != other.balls || places.of.size() != other.of.size()) return std::nullopt;
  if (places == other) return 0.0;
  const std::optional<Pose> X_WD = scene::head_pose(session);
  if (!X_WD) return std::nullopt;
  double largest = 0.0;
  for (const render::View& view : render::eyes(*X_WD, session.scenario().hmd.optics)) {
    const Pose X_EW = view.X_WE.inverse();
    const render::Frustum& f = view.frustum;
    const auto is_in_view = [&](const Vec3& p_W) {
      const Vec3 p = X_EW * p_W;
      const double depth = -p.z();
      return depth > f.near && p.x() > f.left * depth && p.x() < f.right * depth &&
             p.y() > f.bottom * depth && p.y() < f.top * depth;
    };
    for (std::size_t i = 0; i < places.of.size(); ++i) {
      const std::optional<Place>&here = places.of[i], &there = other.of[i];
      if (!here || !there || *here == *there) continue;
      if (!is_in_view(middle(*here)) && !is_in_view(middle(*there))) continue;
      largest = std::max(largest, arcmin_between(view.X_WE.p, *here, *there));
    }
  }
  return largest;
}

Apart::Apart(const scene::Session& a, const scene::Session& b, std::string_view gl, Names names)
    : eyes_a_(scene::open_eyes(*a.stage, a.scenario().look, gl)),
      eyes_b_(scene::open_eyes(*b.stage, b.scenario().look, gl)),
      names_(std::move(names)) {
  const std::int64_t rate_a = a.scenario().rates.physics_hz, rate_b = b.scenario().rates.physics_hz;
  if (rate_a != rate_b) {
    throw std::invalid_argument(
        fmt::format("{}: has rates.physics_hz = {}, {} has {}; expected the same tick rate",
                    names_[1], rate_b, names_[0], rate_a));
  }
  require_same_bodies(*a.stage, *b.stage, names_);
  require_same_display(a.scenario().hmd, b.scenario().hmd, names_);
  drawn_ = drawn_otherwise(*a.stage, *b.stage);
  const std::vector<std::string> bodies = names_of_places(*a.stage);
  pixel_ = a.scenario().hmd.optics.pixel_arcmin();
  limit_ = std::max(pixel_, kDetail.value);
  balls_ = a.stage->balls.size();
  for (const std::string& name : bodies) {
    bodies_.emplace_back().body = name;
  }
  for (auto& contacts : contacts_) contacts.resize(bodies.size());
  for (auto& bounces : bounces_) bounces.resize(balls_);
}

/// For each body: whether the display has a pixel of it, in the left and in the right eye.
std::array<std::vector<bool>, 2> Apart::seen(const scene::Session& a, const scene::Session& b,
                                             const Pose& X_WD) {
  std::array<std::vector<bool>, 2> found;
  for (auto& eye : found) eye.resize(bodies_.size());
  for (const auto& [session, eyes] : {std::pair(&a, &eyes_a_), {&b, &eyes_b_}}) {
    const auto labels = scene::see_labels(*eyes, scene::glimpse(*session, X_WD));
    for (std::size_t eye = 0; eye < 2; ++eye) {
      for (const std::uint32_t id : labels[eye].id) {
        const bool is_skittle = id >= scene::kFirstSkittleId;
        if (!is_skittle && id < scene::kFirstBallId) continue;
        const std::size_t body =
            is_skittle ? balls_ + (id - scene::kFirstSkittleId) : id - scene::kFirstBallId;
        if (body < bodies_.size()) found[eye][body] = true;
      }
    }
  }
  return found;
}

/// Sees each moment, with the number of its body.
template <typename See>
void Apart::each_moment(const See& see) {
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (contacts_[s][i]) see(i, *contacts_[s][i]);
      if (i < balls_ && bounces_[s][i].over) see(i, *bounces_[s][i].over);
    }
  }
}

void Apart::measure_frame(const scene::Session& a, const scene::Session& b, const Pose& X_WD) {
  ++frames_;
  const Places in_a = places_of(a), in_b = places_of(b);
  const auto views = render::eyes(X_WD, a.scenario().hmd.optics);
  Directions now{a.now(), {}, {}};
  const auto towards = [&](const std::optional<Place>& place) {
    return place ? std::optional<Vec3>(middle(*place) - X_WD.p) : std::nullopt;
  };
  for (std::size_t i = 0; i < in_a.of.size(); ++i) {
    now.towards_a.push_back(towards(in_a.of[i]));
    now.towards_b.push_back(towards(in_b.of[i]));
  }
  recent_.push_back(now);
  while (recent_.size() > 1 && recent_[1].time <= now.time - kSpeedOver) {
    recent_.erase(recent_.begin());
  }
  bool is_new = false;
  each_moment([&](std::size_t, Moment& moment) { is_new |= !moment.shown; });
  if (in_a == in_b && !is_new) return;
  const auto shown = seen(a, b, X_WD);
  each_moment([&](std::size_t i, Moment& moment) {
    if (!moment.shown) moment.shown = shown[0][i] || shown[1][i];
  });
  compare_moments();
  if (in_a == in_b) return;
  const Directions& then = recent_.front();
  const double since = seconds(now.time - then.time);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!shown[0][i] && !shown[1][i]) continue;
    if (!in_a.of[i] || !in_b.of[i]) continue;
    BodyApart& body = bodies_[i];
    Difference place{.at = now.time};
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!shown[eye][i]) continue;
      const double arcmin = arcmin_between(views[eye].X_WE.p, *in_a.of[i], *in_b.of[i]);
      body.arcmin[eye] = std::max(body.arcmin[eye], arcmin);
      place.size = std::max(place.size, arcmin);
    }
    place.times = place.size / limit_;
    const bool first_above = place.times > 1.0 && !body.place.first;
    const bool largest = place.size > body.place.size;
    if (first_above || (largest && !body.place.first)) {
      body.off_view_deg = angle_between(X_WD.q * Vec3(0.0, 0.0, -1.0), *now.towards_a[i]) / kDegree;
    }
    take(body.place, place);
    if (now.time - then.time < kSpeedOver || !then.towards_a[i] || !then.towards_b[i]) continue;
    Difference speed{.a = angle_between(*then.towards_a[i], *now.towards_a[i]) / kDegree / since,
                     .b = angle_between(*then.towards_b[i], *now.towards_b[i]) / kDegree / since,
                     .at = now.time};
    if (std::min(speed.a, speed.b) < kSlowest || std::max(speed.a, speed.b) > kFastest) continue;
    speed.size = std::abs(speed.b - speed.a) / speed.a;
    speed.times = speed.size / kSpeed.value;
    if (!body.speed) body.speed.emplace();
    take(*body.speed, speed);
  }
}

void Apart::note_events(const scene::Session& session, bool is_b) {
  for (const scene::Event& event : session.events) {
    if (event.kind != scene::kind::touch && event.kind != scene::kind::first_contact) continue;
    const auto is_ball_or_skittle = [&](const std::string& name) {
      return std::ranges::find(bodies_, name, &BodyApart::body) != bodies_.end();
    };
    if (!std::ranges::all_of(event.bodies, is_ball_or_skittle)) continue;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (std::ranges::find(event.bodies, bodies_[i].body) == event.bodies.end()) continue;
      std::optional<Moment>& contact = contacts_[is_b][i];
      if (!contact) contact = Moment{.at = event.time};
    }
  }
}

void Apart::note_bounces(const scene::Session& session, bool is_b) {
  // What falls from the height of no bounce lands so fast; what rolls does not.
  const double gravity = std::max(0.0, -session.world.parameters.gravity_W.z());
  const double landing = -std::sqrt(2.0 * gravity * kNoBounce);
  for (std::size_t i = 0; i < balls_; ++i) {
    const engine::BodyId ball = session.stage->balls[i];
    Bounce& bounce = bounces_[is_b][i];
    if (bounce.height) continue;
    if (session.world.bodies[ball].kind != engine::Kind::free) {
      bounce = {};
      continue;
    }
    const engine::State& state = session.world.states[ball];
    const double z = state.X_WB.p.z(), v = state.v_WB.z();
    const bool lands = !bounce.from && bounce.v < landing && v >= landing;
    if (lands && v > 0.0) {
      bounce.from = height_of_impact(bounce.z, bounce.v, z, v, engine::step_seconds(session.world));
    } else if (lands || (bounce.from && v <= 0.0)) {
      const double height = lands ? 0.0 : std::max(bounce.z, z) - *bounce.from;
      bounce.height = height > kNoBounce ? height : 0.0;
      bounce.over = Moment{.at = session.now()};
    }
    bounce.z = z;
    bounce.v = v;
  }
}

/// Compares contacts and bounces that were shown in both sessions.
void Apart::compare_moments() {
  const auto shown_at = [](const std::optional<Moment>& a, const std::optional<Moment>& b) {
    const bool both = a && b && a->shown.value_or(false) && b->shown.value_or(false);
    return both ? std::optional(std::max(a->at, b->at)) : std::nullopt;
  };
  const auto set = [](std::optional<Difference>& difference, double a, double b, double size,
                      const Threshold& threshold, Time at) {
    const double times = size / threshold.value;
    difference = Difference{a, b, size, times, at, times > 1.0 ? std::optional(at) : std::nullopt};
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const std::optional<Moment>&a = contacts_[0][i], &b = contacts_[1][i];
    const std::optional<Time> contact = bodies_[i].contact ? std::nullopt : shown_at(a, b);
    if (!contact) continue;
    set(bodies_[i].contact, nearest_seconds(a->at), nearest_seconds(b->at),
        1e3 * nearest_seconds(std::chrono::abs(b->at - a->at)), kContact, *contact);
  }
  for (std::size_t i = 0; i < balls_; ++i) {
    const Bounce &a = bounces_[0][i], &b = bounces_[1][i];
    const std::optional<Time> bounce = bodies_[i].bounce ? std::nullopt : shown_at(a.over, b.over);
    if (!bounce || *a.height == 0.0) continue;
    const double share =
        std::abs(std::sqrt(*b.height) - std::sqrt(*a.height)) / std::sqrt(*a.height);
    set(bodies_[i].bounce, *a.height, *b.height, share, kBounce, *bounce);
  }
}

void Apart::tick(const scene::Session& a, const scene::Session& b) {
  note_events(a, false);
  note_events(b, true);
  note_bounces(a, false);
  note_bounces(b, true);
  if (!frame_of(a.tick, a.scenario().rates)) return;
  const std::optional<Pose> head = scene::head_pose(a), other = scene::head_pose(b);
  if (!head && !other) return;
  if (!head || !other || head->p != other->p || !(head->q.coeffs() == other->q.coeffs())) {
    throw std::runtime_error(fmt::format(
        "{} and {}: their heads are at different places at {:.3f} s; expected one recording",
        names_[0], names_[1], seconds(a.now())));
  }
  measure_frame(a, b, *head);
}

std::string in_digits(double value, int digits) {
  if (value > 0.0 && value < 0.001) return "<0.001";
  // As %g, but for its exponents.
  const double rounded = std::stod(fmt::format("{:.{}e}", value, digits - 1));
  return rounded < std::pow(10.0, digits) ? fmt::format("{:.{}g}", value, digits)
                                          : fmt::format("{:.0f}", value);
}

std::string times_in_words(double times) {
  return times > 0.0 && times < 0.01 ? "less than 0.01" : in_digits(times, 2);
}

namespace {

/// One difference of one body, in words.
struct Told {
  std::string body, words;
  Difference difference;
};

std::string angle_in_words(double arcmin) {
  return arcmin < 600.0 ? in_digits(arcmin, 3) + " arcmin"
                        : in_digits(arcmin / 60.0, 3) + " degrees";
}

std::vector<Told> all_told(const Apart& apart) {
  std::vector<Told> all;
  for (const BodyApart& body : apart.bodies()) {
    all.push_back({body.body, "place differs by " + angle_in_words(body.place.size), body.place});
    if (const auto& speed = body.speed) {
      all.push_back({body.body,
                     fmt::format("speed on the retina differs by {:.0f} %", 100.0 * speed->size),
                     *speed});
    }
    if (const auto& contact = body.contact) {
      all.push_back(
          {body.body, fmt::format("first contact differs by {:.0f} ms", contact->size), *contact});
    }
    if (const auto& bounce = body.bounce) {
      all.push_back(
          {body.body,
           fmt::format("first bounce is {:.2g} m high and {:.2g} m high", bounce->a, bounce->b),
           *bounce});
    }
  }
  return all;
}

/// "the ball", "skittle 1".
std::string with_article(const std::string& body) {
  return body.find(' ') == body.npos ? "the " + body : body;
}

std::string times_seen(const Told& told) {
  return fmt::format("{}'s {} at {:.2f} s, {} times what is seen", with_article(told.body),
                     told.words, seconds(told.difference.at),
                     times_in_words(told.difference.times));
}

/// The first difference and the largest one.
std::vector<std::string> of_bodies(const Apart& apart) {
  const std::vector<Told> all = all_told(apart);
  const auto largest =
      std::ranges::max_element(all, {}, [](const Told& told) { return told.difference.times; });
  if (largest == all.end() || largest->difference.times <= 0.0) {
    return {apart.drawn().empty() ? "Nothing differs."
                                  : "No place, speed, contact or bounce differs."};
  }
  if (largest->difference.times <= 1.0) {
    return {"Nothing differs by as much as is seen. The most: " + times_seen(*largest) + "."};
  }
  const auto first = std::ranges::min_element(
      all, {}, [](const Told& told) { return told.difference.first.value_or(Time::max()); });
  return {fmt::format("First, from {:.2f} s on: {}.", seconds(*first->difference.first),
                      times_seen(*first)),
          fmt::format("Most: {}.", times_seen(*largest))};
}

}  // namespace

std::vector<std::string> in_sentences(const Apart& apart) {
  std::vector<std::string> sentences = of_bodies(apart);
  if (!apart.drawn().empty()) sentences.push_back(apart.drawn());
  return sentences;
}

}  // namespace headpin::sweep
