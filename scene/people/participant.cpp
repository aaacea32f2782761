#include "scene/people/participant.h"

#include <algorithm>
#include <cmath>

#include "scene/people/arm_model.h"
#include "scene/people/sights.h"
#include "scene/record/events.h"
#include "scene/scenario/rules.h"

namespace headpin::scene {

namespace {

constexpr std::uint64_t kThrowsDrawn = 4;  ///< purpose of the random numbers
constexpr double kStartAhead = -2.0;       ///< of the foul line [m]
constexpr double kThere = 0.03;            ///< distance at which a walk has arrived [m]
constexpr double kOneStep = 0.35;          ///< longest way on foot [m]
constexpr double kPatience = 15.0;         ///< longest time for a walk [s]
constexpr int kMostTries = 4;
constexpr int kMostAstray = 4;  ///< versions begun by accident while another one was to be played

Vec2 level_of(const Vec3& v) {
  return v.head<2>();
}

bool is_waiting(const Session& s, engine::BodyId ball) {
  const bool held = s.player.held && s.player.held->body == ball;
  return !held && s.world.bodies[ball].kind == engine::Kind::driven;
}

Posture first_posture(const Person& person) {
  Random random(person.seed, kThrowsDrawn, 0);
  const double x = random.uniform(-0.6, 0.3), y = kStartAhead + random.uniform(-0.2, 0.4);
  Posture posture{.x = x, .y = y};
  posture.reach = 0.9 * Build{person.height, person.left_handed}.arm();
  return posture;
}

}  // namespace

void set_up_for_participants(Scenario& scenario) {
  const Rig usual, &rig = scenario.rig;
  const auto equal = [](const Pose& a, const Pose& b) {
    return a.p == b.p && a.q.coeffs() == b.q.coeffs();
  };
  if (!equal(rig.X_WT, usual.X_WT) || !equal(rig.X_SD, usual.X_SD) ||
      !equal(rig.X_SH, usual.X_SH) || rig.delay_s != usual.delay_s) {
    return;
  }
  scenario.rig = synthetic_rig();
  const double h = std::sqrt(0.5);
  scenario.rig.X_WT = {Quat(0.0, h, -h, 0.0), Vec3(-0.15, kStartAhead + 1.5, 1.0)};
}

void set_up_hand(Scenario& scenario, const Person& person) {
  Rig& rig = scenario.rig;
  const bool usual =
      rig.head_station == devices::kHeadStation && rig.hand_station == devices::kHandStation;
  if (person.left_handed && usual) rig.hand_station = devices::kLeftHandStation;
}

Participant::Participant(const ParticipantPlan& plan, const Scenario& scenario)
    : plan_(plan),
      scenario_(scenario),
      body_(plan.person, scenario.rig, first_posture(plan.person)),
      chance_(plan.person.seed, kThrowsDrawn, 1) {
  const Posture stands = body_.figure.goal();
  home_P_ = Vec2(stands.x, stands.y);
  versions_ = scenario.version.buttons ? 2 : 1;
  throw_x_ = 0.06 * chance_.normal();
  throw_y_ = chance_.uniform(-0.35, -0.05);
  gaze_W_ = Vec3(0.0, scenario.lane.head_pin, 0.3);
}

void Participant::begin(Doing next, double now) {
  doing_ = next;
  since_ = now;
  acted_ = 0.0;
  if (next != Doing::takes && next != Doing::touches) tries_ = 0;
}

void Participant::give_up(double now) {
  gave_up_ = true;
  begin(Doing::leaves, now);
}

void Participant::tick(const Session& session) {
  const double now = seconds(session.now());
  notice(session, now);
  act(session, now);
  draw_back(session, now);
  turn_gaze(session, now);
}

void Participant::act(const Session& session, double now) {
  switch (doing_) {
    case Doing::arrives:
      if (now > 1.5 * plan_.person.pace) {
        begin(scenario_.version.buttons ? Doing::walks_to_button : Doing::walks_to_ball, now);
      }
      break;
    case Doing::walks_to_button:
      if (walk_to(session, button_spot(session), now)) begin(Doing::touches, now);
      break;
    case Doing::touches:
      touch(session, now);
      break;
    case Doing::walks_to_ball:
      wait_for_ball(session, now);
      break;
    case Doing::takes:
      take(session, now);
      break;
    case Doing::carries:
      if (walk_to(session, throwing_spot(), now)) begin(Doing::addresses, now);
      break;
    case Doing::addresses:
      address(session, now);
      break;
    case Doing::swings:
      throw_ball(now);
      break;
    case Doing::watches:
      watch(session, now);
      break;
    case Doing::leaves:
      if (now > since_ + 1.0) begin(Doing::nothing, now);
      break;
    case Doing::nothing:
      break;
  }
}

/// Goes to the button of the version that is to be played, as that of another one was touched by
/// accident: by a hand that moves out of the way of a skittle. Where its own was touched, it has
/// begun again, and the participant throws all its balls again. On the way to its first ball it just
/// goes on: its hand still leaves the button.
void Participant::go_back(const Session& session, double now, bool began_again) {
  if (began_again && doing_ == Doing::walks_to_ball && throws_ == 0) return;
  if (began_again) {
    throws_ = 0;
    game_over_ = false;
  }
  if (trigger_) body_.trigger(session.now() + Time{1}, trigger_ = false);
  body_.figure.to(at_rest(now), now, 0.8 * plan_.person.pace);
  thrown_.reset();
  ball_.reset();
  if (game_over_ || throws_ >= plan_.throws) return end_version(now);
  if (++astray_ > kMostAstray) return give_up(now);
  begin(began_again ? Doing::walks_to_ball : Doing::walks_to_button, now);
}

void Participant::end_version(double now) {
  ++version_;
  throws_ = astray_ = 0;
  game_over_ = false;
  begin(version_ < versions_ ? Doing::walks_to_button : Doing::leaves, now);
}

/// Processes the events of the last tick that the participant waits for.
void Participant::notice(const Session& session, double now) {
  const bool awaited =
      doing_ == Doing::touches || doing_ == Doing::takes || doing_ == Doing::watches;
  for (const Event& event : session.events) {
    if (event.kind == kind::release) {
      ++throws_;
      ++all_throws_;
      if (thrown_) thrown_->from_W = event.p_W;
    }
    if (event.kind == kind::skittle_down && thrown_) thrown_->felled = true;
    game_over_ |= event.kind == kind::game_over;
    const bool plays = doing_ != Doing::leaves && doing_ != Doing::nothing;
    const bool own = event.detail == Detail(next_colour());
    const bool meant = doing_ == Doing::touches || doing_ == Doing::walks_to_button;
    if (event.kind == kind::version && plays && !(own && meant)) {
      go_back(session, now, own);
      continue;
    }
    const bool done = (doing_ == Doing::touches && event.kind == kind::version) ||
                      (doing_ == Doing::takes && event.kind == kind::grab) ||
                      (doing_ == Doing::watches && event.kind == kind::ball_back);
    if (awaited && done && acted_ == 0.0) acted_ = now;
  }
  if (!thrown_ || !ball_ || thrown_->miss || session.player.held) return;
  const Vec3& p_WB = session.world.states[*ball_].X_WB.p;
  if (throws_ > 0 && p_WB.y() >= thrown_->target_W.y() - 0.15 && !is_waiting(session, *ball_)) {
    thrown_->miss = p_WB.x() - thrown_->target_W.x();
  }
}

Posture Participant::at_rest(double now) const {
  Posture rest = body_.figure.at(now);
  const Posture usual;
  rest.facing = rest.crouch = 0.0;
  rest.lean = usual.lean;
  rest.raise = usual.raise;
  rest.aside = usual.aside;
  rest.reach = 0.9 * body_.build.arm();
  return rest;
}

Colour Participant::next_colour() const {
  return (version_ == 0) == plan_.blue_first ? Colour::blue : Colour::red;
}

const Vec3& Participant::next_button(const Session& session) const {
  const Versions& versions = session.scenario().version;
  return next_colour() == Colour::blue ? versions.blue.button : versions.red.button;
}

Vec2 Participant::button_spot(const Session& session) const {
  return level_of(next_button(session)) -
         Vec2(body_.build.shoulder_aside(), 0.8 * body_.build.arm());
}

void Participant::touch(const Session& session, double now) {
  const double pace = plan_.person.pace;
  const Vec3& button = next_button(session);
  gaze_W_ = button;
  const double tried = now - since_;
  if (acted_ > 0.0) {  // the version has begun
    if (now < acted_ + plan_.person.reaction_s) return;
    body_.figure.to(at_rest(now), now, 0.8 * pace);
    throws_ = 0;
    game_over_ = false;
    return begin(Doing::walks_to_ball, now);
  }
  constexpr double kLook = 0.5, kLong = 3.0;
  if (tries_ == 0 || tried > kLong) {
    if (tries_ == 0 && tried < kLook) return;
    if (++tries_ > kMostTries) return give_up(now);
    since_ = now;
    Posture posture = at_rest(now);
    posture.lean = 0.1 * tries_;
    constexpr double kFingers = 0.06;
    point_at(body_.build, posture, button - session.player.walk.p_WP, kFingers / tries_);
    body_.figure.to(posture, now, 0.9 * pace);
  }
}

Vec2 Participant::ball_spot(const Session& session) const {
  const Vec3& p_WB = session.world.states[*ball_].X_WB.p;
  return level_of(p_WB) - Vec2(body_.build.shoulder_aside(), 0.26 * body_.build.height);
}

Vec2 Participant::throwing_spot() const {
  Posture posture;
  posture.lean = plan_.person.lean;
  return Vec2(throw_x_, throw_y_) - level_of(shoulder(body_.build, posture));
}

void Participant::wait_for_ball(const Session& session, double now) {
  constexpr double kLonger = 6.0;
  ball_.reset();
  for (const engine::BodyId ball : session.stage->balls) {
    if (!is_waiting(session, ball)) continue;
    ball_ = ball;
    break;
  }
  if (!ball_) {
    if (now > since_ + scenario_.game.ball_back_s + kLonger) give_up(now);
    return;
  }
  // From the place of the throw, if the arm can reach the ball from there.
  gaze_W_ = session.world.states[*ball_].X_WB.p;
  Posture posture;
  const Vec2 there = throwing_spot();
  posture.x = there.x();
  posture.y = there.y();
  posture.lean = 0.3;
  const Vec3 way = gaze_W_ - shoulder(body_.build, posture);
  const bool in_reach = way.y() > 0.0 && way.norm() < body_.build.arm() + 0.12;
  if (walk_to(session, in_reach ? there : ball_spot(session), now)) begin(Doing::takes, now);
}

void Participant::take(const Session& session, double now) {
  const double pace = plan_.person.pace;
  const Vec3& p_WB = session.world.states[*ball_].X_WB.p;
  if (acted_ > 0.0) {
    if (now < acted_ + 0.1) return;
    Posture posture = at_rest(now);
    posture.raise = 1.0;
    posture.reach = 0.7 * body_.build.arm();
    posture.aside = 0.0;
    body_.figure.to(posture, now, 1.1 * pace);
    return begin(Doing::carries, now);
  }
  gaze_W_ = p_WB;
  const double reaching = 0.9 * pace, tried = now - since_;
  if (tries_ == 0 || tried > reaching + 1.0) {
    if (++tries_ > kMostTries) return give_up(now);
    since_ = now;
    if (trigger_) body_.trigger(session.now() + Time{1}, trigger_ = false);
    Posture posture = at_rest(now);
    posture.lean = 0.3 + 0.1 * (tries_ - 1);
    point_at(body_.build, posture, p_WB - session.player.walk.p_WP, -scenario_.hand.grip.z());
    body_.figure.to(posture, now, reaching);
  } else if (!trigger_ && tried > reaching + 0.1) {
    body_.trigger(session.now() + Time{1}, trigger_ = true);
  }
}

void Participant::address(const Session& session, double now) {
  const double pace = plan_.person.pace;
  if (acted_ == 0.0) {
    acted_ = now;
    const Person& person = plan_.person;
    const Vec3 target = worth_aiming_at(session).value_or(rack_middle(session));
    gaze_W_ = target;
    const double speed =
        std::clamp(person.speed * (1.0 + person.speed_spread * chance_.normal()), 3.0, 10.0);
    swing_ =
        plan_swing(body_.build, scenario_.hand, body_.figure.at(now),
                   target - session.player.walk.p_WP, speed, person.release_height, person.lean);
    const double aside = person.aim_bias - mended_ + person.aim_spread * chance_.normal();
    swing_.ready.facing -= aside;
    swing_.back.facing -= aside;
    swing_.release_s += person.timing_spread * chance_.normal();
    swing_.back_s = 1.05 * pace;
    thrown_.emplace().target_W = target;
    body_.figure.to(swing_.ready, now, 0.8 * pace);
  }
  if (now < acted_ + 1.2 * pace) return;
  body_.figure.to(swing_.back, now, swing_.back_s);
  begin(Doing::swings, now);
}

void Participant::throw_ball(double now) {
  const double forward = since_ + swing_.back_s;
  if (acted_ == 0.0 && now >= forward) {
    acted_ = forward;
    body_.figure.to(&Posture::raise, swing_.through, forward, swing_.forward_s);
    body_.trigger(microseconds(forward + swing_.release_s), trigger_ = false);
  }
  if (acted_ == 0.0 || now < forward + swing_.forward_s + 0.2) return;
  body_.figure.to(at_rest(now), now, 1.2 * plan_.person.pace);
  begin(Doing::watches, now);
}

void Participant::watch(const Session& session, double now) {
  constexpr double kLonger = 4.0;
  const bool over = session.game.over || now > since_ + scenario_.game.ball_back_s + kLonger;
  if (acted_ == 0.0 && over) acted_ = now;
  if (acted_ == 0.0 || now < acted_ + 2.0 * plan_.person.reaction_s || now < drawn_until_) return;
  mend();
  const bool no_game = !rules_of(scenario_.game.rules).counted;  // the ball stays where it is
  const bool enough = no_game || throws_ >= plan_.throws || session.game.over;
  if (!enough) return begin(Doing::walks_to_ball, now);
  end_version(now);
}

/// Corrects the aim of the next throw by a part of the miss, if the ball missed its target.
void Participant::mend() {
  if (thrown_ && thrown_->miss) {
    const double way = thrown_->target_W.y() - thrown_->from_W.y();
    const bool missed = std::abs(*thrown_->miss) > scenario_.ball.radius || !thrown_->felled;
    if (missed && way > 1.0) mended_ += plan_.person.mending * *thrown_->miss / way;
  }
  thrown_.reset();
}

bool Participant::walk_to(const Session& session, const Vec2& spot_W, double now) {
  const Walk& walk = session.player.walk;
  const Posture stands = body_.figure.at(now);
  const Vec2 feet_P(stands.x, stands.y);
  const Vec2 way = spot_W - level_of(walk.p_WP) - feet_P;
  if (now < stepping_until_) return false;
  if (now > since_ + kPatience) {
    if (thumbs_ != 0) body_.thumbs(session.now() + Time{1}, thumbs_ = 0);
    return true;
  }
  if (thumbs_ == 0 && walk.v_WP.isZero(0.0)) {
    if (way.norm() < kThere) return true;
    if (way.norm() < kOneStep && (feet_P + way - home_P_).norm() < kStepsAside) {
      const double step_s = 0.45 + 0.8 * way.norm();
      body_.figure.to(&Posture::x, feet_P.x() + way.x(), now, step_s);
      body_.figure.to(&Posture::y, feet_P.y() + way.y(), now, step_s);
      stepping_until_ = now + step_s;
      return false;
    }
  }
  walk_by_thumbs(session, way, now);
  return false;
}

/// Looks in the direction of the walk, and presses a thumb button until the walk will stop at its
/// end.
void Participant::walk_by_thumbs(const Session& session, const Vec2& way, double now) {
  constexpr double kFar = 0.5, kInLine = 0.995;
  const Walk& walk = session.player.walk;
  const Pose X_PD = body_.head(now);
  if (thumbs_ == 0) backward_ = way.y() < 0.0 && -way.y() > std::abs(way.x());
  if (thumbs_ == 0 || way.norm() > kFar) {
    const Vec2 ahead = (backward_ ? -1.0 : 1.0) * way.normalized();
    const Vec3 p_WD = walk.p_WP + X_PD.p;
    gaze_W_ = p_WD + Vec3(3.0 * ahead.x(), 3.0 * ahead.y(), -0.6);
  }
  Vec2 gaze = level_of(X_PD.q * -Vec3::UnitZ());
  gaze.normalize();
  const Vec2 goes = (backward_ ? -1.0 : 1.0) * gaze;
  const double speed = walk.v_WP.norm();
  const double stops =
      speed * speed / (2.0 * scenario_.walk.acceleration) + speed * (scenario_.rig.delay_s + 0.01);
  const bool near = goes.dot(way) <= stops;
  if (thumbs_ == 0 && walk.v_WP.isZero(0.0) && goes.dot(way) > kInLine * way.norm()) {
    body_.thumbs(session.now() + Time{1}, thumbs_ = backward_ ? -1 : 1);
  } else if (thumbs_ != 0 && near) {
    body_.thumbs(session.now() + Time{1}, thumbs_ = 0);
  }
}

/// Moves away from a body that flies at the participant, after the reaction time, and back again
/// when it has passed.
void Participant::draw_back(const Session& session, double now) {
  if (!plan_.person.draws_back) return;
  const bool free_to = doing_ == Doing::watches || doing_ == Doing::arrives ||
                       (doing_ == Doing::walks_to_ball && thumbs_ == 0 && now > stepping_until_);
  std::optional<engine::BodyId> coming;
  const Pose X_PD = body_.head(now), X_PH = body_.hand(now);
  const Vec3& p_WP = session.player.walk.p_WP;
  const auto look_at = [&](engine::BodyId body) {
    const bool flies = session.world.bodies[body].kind == engine::Kind::free;
    if (!flies || is_own(session.presence, body)) return;
    const engine::State& state = session.world.states[body];
    const auto near = passing(state, session.world.bodies[body].shape->bounding_radius,
                              p_WP + X_PD.p, Vec3(p_WP + X_PH.p), scenario_.collision.gravity);
    if (near && is_coming(state, *near)) coming = body;
  };
  for (const engine::BodyId ball : session.stage->balls) look_at(ball);
  for (const engine::BodyId skittle : session.stage->skittles) look_at(skittle);
  if (coming && !threat_) threatened_since_ = now;
  threat_ = coming;
  const bool reacts = threat_ && now >= threatened_since_ + plan_.person.reaction_s;
  if (reacts && free_to && now >= drawn_until_) {
    const engine::State& state = session.world.states[*threat_];
    const Vec2 along = level_of(state.v_WB).normalized();
    const Vec2 side(along.y(), -along.x());
    const Vec2 from = level_of(p_WP + X_PD.p - state.X_WB.p);
    const Vec2 away = (0.5 * along + (side.dot(from) < 0.0 ? -0.8 : 0.8) * side).normalized();
    constexpr double kQuick = 0.42, kAside = 0.28;
    Posture posture = at_rest(now);
    posture.x = home_P_.x() + std::clamp(posture.x + kAside * away.x() - home_P_.x(), -0.5, 0.5);
    posture.y = home_P_.y() + std::clamp(posture.y + kAside * away.y() - home_P_.y(), -0.5, 0.5);
    posture.lean = -0.12;
    posture.raise = 0.7;
    posture.reach = 0.5 * body_.build.arm();
    body_.figure.to(posture, now, kQuick);
    drawn_until_ = now + 1.2;
    stepping_until_ = drawn_until_;
  } else if (drawn_until_ > 0.0 && now >= drawn_until_) {
    drawn_until_ = 0.0;
    if (free_to) body_.figure.to(at_rest(now), now, 0.7);
  }
}

void Participant::turn_gaze(const Session& session, double now) {
  Vec3 at_W = gaze_W_;
  const bool follows =
      doing_ == Doing::watches || (doing_ == Doing::swings && !session.player.held);
  if (follows && ball_) {
    const Vec3& p_WB = session.world.states[*ball_].X_WB.p;
    const std::optional<Vec3> lively = liveliest_skittle(session);
    const bool rolls = !is_waiting(session, *ball_) && !lively;
    at_W = lively ? *lively : rolls ? p_WB : rack_middle(session);
    gaze_W_ = at_W;
  }
  if (threat_) at_W = session.world.states[*threat_].X_WB.p;
  const double dt = 1.0 / static_cast<double>(scenario_.rates.physics_hz);
  body_.look_at(at_W - session.player.walk.p_WP, now, dt);
}

}  // namespace headpin::scene
