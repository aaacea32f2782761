// Every value of a session is there after it was saved and restored: each has one of its own here.

#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "scene/play/save.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {
namespace {

/// Numbers that are all different.
struct Different {
  int n = 0;

  double number() { return 0.25 + ++n; }
  Vec3 vector() { return {number(), number(), number()}; }
  Time time() { return Time{1000 * ++n}; }
  engine::State state() { return {{Quat(0.6, 0.0, 0.8, 0.0), vector()}, vector(), vector()}; }
  Delivered delivered() { return {number(), number(), number(), number(), number(), number()}; }
  OilRing ring() { return {vector(), number()}; }
};

void set_player(Player& player, Different& d) {
  player.walk = {d.vector(), d.vector()};
  for (devices::PoseTrack* track : {&player.head, &player.hand}) {
    const Time first = d.time();
    track->push(first, {Quat(0.0, 0.6, 0.8, 0.0), d.vector()});
    track->push(first + Time{5000}, {Quat(0.0, 0.8, 0.6, 0.0), d.vector()});
  }
  player.head_arrival = d.time();
  devices::MouseSample left, right;
  for (devices::MouseSample* sample : {&left, &right}) {
    sample->device_time = d.time();
    sample->host_time = d.time();
    sample->session_time = d.time();
  }
  left.left_thumb = true;
  right.right_thumb = right.trigger = true;
  player.buttons = {left, right};
  player.left_thumb = player.right_thumb = player.trigger = true;
  player.grip_changed = d.time();
}

void set_watched(WatchedBall& watched, Different& d) {
  BallPath& path = watched.watch.path;
  path.release = d.delivered();
  path.loft_end = d.number();
  path.skid_end = d.number();
  path.hook_end = d.number();
  path.breakpoint = LanePlace{d.number(), d.number()};
  path.entry = d.delivered();
  path.exit_board = d.number();
  path.gutter = d.number();
  path.flare_mm = d.number();
  watched.watch.last = d.state();
  watched.watch.landed_deg = d.number();
  watched.watch.over = true;
  watched.touched = {3, 5};
  OilRings& rings = watched.rings;
  rings.begin_B = d.vector();
  rings.last_B = d.vector();
  rings.area_B = d.vector();
  rings.sum_B = d.vector();
  rings.places = 77;
  rings.turned = d.number();
  rings.first = d.ring();
  rings.flare = d.number();
  rings.newest = d.ring();
}

void set_game(Game& game, const Stage& stage, Different& d) {
  const engine::BodyId skittle = stage.skittles[1];
  game.down[skittle] = game.swept[skittle] = game.stray[stage.balls[0]] = 1;
  game.moved_by[skittle] = By::stray_ball;
  game.velocities.clear();
  for (std::size_t i = 0; i < game.down.size(); ++i) game.velocities.push_back(d.vector());
  game.frames = {{3, 4}, {5}};
  game.fouls = {0, 1, 0};
  game.thrown = d.time();
  game.quiet = d.time();
  game.struck = game.foul = game.beyond = game.begun = game.over = true;
  game.watched.emplace().body = stage.balls[0];
  set_watched(*game.watched, d);
  game.ringed.emplace() = {stage.balls[0], {d.ring(), d.ring()}};
}

void set_statistics(engine::Statistics& s) {
  s = {.steps = 1, .pairs = 2, .contacts = 3, .queries = {}, .impacts = 7, .unfinished_impacts = 8};
  s.queries.queries = 4;
  s.queries.iterations = 5;
  s.queries.capped = 6;
  s.pulls = 9;
  s.islands = 10;
  s.solver_iterations = 11;
  s.unsolved = 12;
  s.residual = 13.5;
  s.deepest_overlap = 14.5;
  s.awake = 15;
}

/// A session of no game that anybody plays: every value is another one, and none is what it was at first.
Session with_different_values(const Scenario& scenario) {
  Session session = make_session(scenario);
  const engine::BodyId ball = session.stage->balls[0];
  Different d;
  set_player(session.player, d);
  session.player.held = Held{ball, Quat(0.8, 0.0, 0.0, 0.6)};
  session.player.leaving = ball;
  set_game(session.game, *session.stage, d);
  session.tracking.head = {d.time(), true};
  session.tracking.hand = {d.time(), true};
  Approach approach{.body = ball, .noticed = d.time(), .foreseen = {}};
  approach.foreseen = {d.number(), d.number(), true};
  approach.along_W = d.vector();
  approach.closest = d.number();
  approach.head_away = d.number();
  approach.hand_away = d.number();
  approach.passed = d.time();
  session.presence = {{approach}, {{ball, d.vector()}}};
  set_statistics(session.statistics);
  session.version_begun = true;
  session.touched = 1;
  session.tick = session.world.tick = 12;
  session.game_hash = GameHash(0x1234567890abcdef);
  return session;
}

void expect_same(const engine::State& a, const engine::State& b) {
  EXPECT_EQ(a.X_WB.p, b.X_WB.p);
  EXPECT_EQ(a.X_WB.q.coeffs(), b.X_WB.q.coeffs());
  EXPECT_EQ(a.v_WB, b.v_WB);
  EXPECT_EQ(a.w_WB, b.w_WB);
}

void expect_same(const OilRing& a, const OilRing& b) {
  EXPECT_EQ(a.n_B, b.n_B);
  EXPECT_EQ(a.height, b.height);
}

void expect_same(const devices::PoseTrack& a, const devices::PoseTrack& b) {
  const auto &samples_a = a.samples(), &samples_b = b.samples();
  ASSERT_EQ(samples_a.size(), samples_b.size());
  for (std::size_t i = 0; i < samples_a.size(); ++i) {
    EXPECT_EQ(samples_a[i].time, samples_b[i].time);
    EXPECT_EQ(samples_a[i].value.p, samples_b[i].value.p);
    EXPECT_EQ(samples_a[i].value.q.coeffs(), samples_b[i].value.q.coeffs());
  }
}

void expect_same(const Player& a, const Player& b) {
  EXPECT_EQ(a.walk.p_WP, b.walk.p_WP);
  EXPECT_EQ(a.walk.v_WP, b.walk.v_WP);
  expect_same(a.head, b.head);
  expect_same(a.hand, b.hand);
  EXPECT_EQ(a.head_arrival, b.head_arrival);
  ASSERT_EQ(a.buttons.size(), b.buttons.size());
  for (std::size_t i = 0; i < a.buttons.size(); ++i) {
    EXPECT_EQ(a.buttons[i].device_time, b.buttons[i].device_time);
    EXPECT_EQ(a.buttons[i].host_time, b.buttons[i].host_time);
    EXPECT_EQ(a.buttons[i].left_thumb, b.buttons[i].left_thumb);
    EXPECT_EQ(a.buttons[i].right_thumb, b.buttons[i].right_thumb);
    EXPECT_EQ(a.buttons[i].trigger, b.buttons[i].trigger);
    EXPECT_EQ(a.buttons[i].session_time, b.buttons[i].session_time);
  }
  EXPECT_EQ(a.left_thumb, b.left_thumb);
  EXPECT_EQ(a.right_thumb, b.right_thumb);
  EXPECT_EQ(a.trigger, b.trigger);
  ASSERT_TRUE(b.held);
  EXPECT_EQ(a.held->body, b.held->body);
  EXPECT_EQ(a.held->q_HB.coeffs(), b.held->q_HB.coeffs());
  EXPECT_EQ(a.grip_changed, b.grip_changed);
  EXPECT_EQ(a.leaving, b.leaving);
}

void expect_same(const WatchedBall& a, const WatchedBall& b) {
  EXPECT_EQ(a.body, b.body);
  EXPECT_EQ(a.watch.path, b.watch.path);
  expect_same(a.watch.last, b.watch.last);
  EXPECT_EQ(a.watch.landed_deg, b.watch.landed_deg);
  EXPECT_EQ(a.watch.over, b.watch.over);
  EXPECT_EQ(a.touched, b.touched);
  EXPECT_EQ(a.rings.begin_B, b.rings.begin_B);
  EXPECT_EQ(a.rings.last_B, b.rings.last_B);
  EXPECT_EQ(a.rings.area_B, b.rings.area_B);
  EXPECT_EQ(a.rings.sum_B, b.rings.sum_B);
  EXPECT_EQ(a.rings.places, b.rings.places);
  EXPECT_EQ(a.rings.turned, b.rings.turned);
  EXPECT_EQ(a.rings.flare, b.rings.flare);
  ASSERT_TRUE(b.rings.first && b.rings.newest);
  expect_same(*a.rings.first, *b.rings.first);
  expect_same(*a.rings.newest, *b.rings.newest);
}

void expect_same(const Game& a, const Game& b) {
  EXPECT_EQ(a.down, b.down);
  EXPECT_EQ(a.moved_by, b.moved_by);
  EXPECT_EQ(a.struck, b.struck);
  EXPECT_EQ(a.stray, b.stray);
  EXPECT_EQ(a.velocities, b.velocities);
  EXPECT_EQ(a.swept, b.swept);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.fouls, b.fouls);
  EXPECT_EQ(a.thrown, b.thrown);
  EXPECT_EQ(a.quiet, b.quiet);
  EXPECT_EQ(a.foul, b.foul);
  EXPECT_EQ(a.beyond, b.beyond);
  EXPECT_EQ(a.begun, b.begun);
  EXPECT_EQ(a.over, b.over);
  ASSERT_TRUE(b.watched && b.ringed);
  expect_same(*a.watched, *b.watched);
  EXPECT_EQ(a.ringed->body, b.ringed->body);
  ASSERT_EQ(a.ringed->rings.size(), b.ringed->rings.size());
  for (std::size_t i = 0; i < a.ringed->rings.size(); ++i) {
    expect_same(a.ringed->rings[i], b.ringed->rings[i]);
  }
}

void expect_same(const Presence& a, const Presence& b) {
  ASSERT_EQ(b.approaches.size(), 1u);
  const Approach &of_a = a.approaches[0], &of_b = b.approaches[0];
  EXPECT_EQ(of_a.body, of_b.body);
  EXPECT_EQ(of_a.noticed, of_b.noticed);
  EXPECT_EQ(of_a.foreseen.time_s, of_b.foreseen.time_s);
  EXPECT_EQ(of_a.foreseen.distance, of_b.foreseen.distance);
  EXPECT_EQ(of_a.foreseen.at_hand, of_b.foreseen.at_hand);
  EXPECT_EQ(of_a.along_W, of_b.along_W);
  EXPECT_EQ(of_a.closest, of_b.closest);
  EXPECT_EQ(of_a.head_away, of_b.head_away);
  EXPECT_EQ(of_a.hand_away, of_b.hand_away);
  EXPECT_EQ(of_a.passed, of_b.passed);
  ASSERT_EQ(b.own.size(), 1u);
  EXPECT_EQ(a.own[0].body, b.own[0].body);
  EXPECT_EQ(a.own[0].along_W, b.own[0].along_W);
}

std::vector<double> numbers_of(const engine::Statistics& s) {
  std::vector<double> numbers = {s.residual, s.deepest_overlap};
  for (const std::int64_t count :
       {s.steps, s.pairs, s.contacts, s.queries.queries, s.queries.iterations, s.queries.capped,
        s.impacts, s.unfinished_impacts, s.pulls, s.islands, s.solver_iterations, s.unsolved,
        s.awake}) {
    numbers.push_back(static_cast<double>(count));
  }
  return numbers;
}

/// A scenario whose lane has cells that a ball may have touched.
Scenario worn_lane() {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  scenario.lane.oil.zones = {{1, 39, 0.0, 5.0, 0.04}};
  scenario.lane.oil.wear = 0.5;
  return scenario;
}

TEST(SavedSession, HasEveryValueThatWasSaved) {
  const Scenario worn = worn_lane();
  const Session saved = with_different_values(worn);
  const Session restored = restore(make_session(worn), save(saved));
  expect_same(saved.player, restored.player);
  expect_same(saved.game, restored.game);
  expect_same(saved.presence, restored.presence);
  for (const auto receiver : {&Tracking::head, &Tracking::hand}) {
    EXPECT_EQ((saved.tracking.*receiver).last, (restored.tracking.*receiver).last);
    EXPECT_EQ((saved.tracking.*receiver).lost, (restored.tracking.*receiver).lost);
  }
  EXPECT_EQ(numbers_of(saved.statistics), numbers_of(restored.statistics));
  EXPECT_EQ(saved.version_begun, restored.version_begun);
  EXPECT_EQ(saved.touched, restored.touched);
  EXPECT_EQ(saved.tick, restored.tick);
  EXPECT_EQ(saved.game_hash.value(), restored.game_hash.value());
}

// Each of them would be read or written outside of a list, or is what no session comes to.
TEST(SavedSession, WhosePartsDoNotFitIsRefused) {
  using Damage = std::function<void(Session&)>;
  const Scenario worn = worn_lane();
  const Session whole = with_different_values(worn);
  const auto bodies = static_cast<engine::BodyId>(whole.world.bodies.size());
  const auto cells = static_cast<std::uint32_t>(whole.stage->fresh_lane->friction.size());
  const std::vector<Damage> damages = {
      [](Session& s) { s.game.down.pop_back(); },
      [](Session& s) { s.game.moved_by.pop_back(); },
      [](Session& s) { s.game.swept.pop_back(); },
      [](Session& s) { s.game.stray.pop_back(); },
      [](Session& s) { s.game.velocities.pop_back(); },
      [&](Session& s) { s.game.watched->body = bodies; },
      [&](Session& s) { s.game.watched->touched.back() = cells; },
      [&](Session& s) { s.game.ringed->body = bodies; },
      [](Session& s) { s.game.frames[0][1] = -1; },
      [](Session& s) { s.game.frames[0][1] = 1001; },
      [](Session& s) { s.game.fouls.pop_back(); },
      [&](Session& s) { s.player.held->body = bodies; },
      [](Session& s) { s.player.held->q_HB.coeffs() *= 1.01; },
      [&](Session& s) { s.player.leaving = bodies; },
      [&](Session& s) { s.presence.approaches[0].body = bodies; },
      [&](Session& s) { s.presence.own[0].body = bodies; },
      [](Session& s) { ++s.tick; },
      [](Session& s) { s.tick = s.world.tick = 1'000'000'000'001; },
      [](Session& s) { s.version = s.versions.size() + 1; },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    Session damaged = whole;
    damages[i](damaged);
    EXPECT_THROW(restore(make_session(worn), save(damaged)), std::invalid_argument) << i;
  }
  const std::vector<Damage> changes = {
      [&](Session& s) { s.game.watched->touched.back() = cells - 1; },
      [](Session& s) {
        s.game.frames[0] = {0, 1000};
      },
      [](Session& s) { s.game.velocities.clear(); },
      [](Session& s) { s.game.watched.reset(); },
      [](Session& s) { s.game.ringed.reset(); },
      [](Session& s) { s.player.held.reset(); },
      [](Session& s) { s.player.leaving.reset(); },
      [](Session& s) { s.tick = s.world.tick = 1'000'000'000'000; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Session changed = whole;
    changes[i](changed);
    EXPECT_NO_THROW(restore(make_session(worn), save(changed))) << i;
  }
}

}  // namespace
}  // namespace headpin::scene
