// Other releases of a recorded throw: held against whole sessions of samples that were changed by hand, and against laws.

#include "sweep/whatif.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/play/ball_path.h"
#include "scene/play/score.h"
#include "sweep/runner.h"
#include "sweep/whatif_report.h"
#include "sweep/whatif_tables.h"
#include "tests/support/folder.h"
#include "tests/support/hand_script.h"

namespace headpin::sweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Trial& demo() {
  static const Trial trial = read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  return trial;
}

/// The whole session of these samples.
scene::Score played(const scene::Scenario& scenario, const std::vector<devices::Sample>& samples,
                    double seconds_long, Situations* situations = nullptr) {
  scene::Session session = scene::make_session(scenario);
  devices::ReplaySource source(samples);
  scene::Score score;
  while (seconds(session.now()) < seconds_long) {
    scene::advance(session, source);
    for (const scene::Event& event : session.events) score.add(event, session.scenario());
    if (situations) situations->tick(session);
  }
  return score;
}

const Situation& demo_throw() {
  static const std::vector<Situation> all = [] {
    Situations situations(kMostShift);
    played(demo().scenario, demo().samples, 7.0, &situations);
    return situations.all();
  }();
  EXPECT_EQ(all.size(), 1u);
  return all.front();
}

void expect_same_throw(const Outcome& again, const scene::ThrowRow& whole) {
  EXPECT_TRUE(again.released);
  EXPECT_EQ(again.thrown.release, whole.release);
  EXPECT_EQ(again.thrown.speed, whole.speed);
  EXPECT_EQ(again.thrown.v_WB, whole.v_WB);
  EXPECT_EQ(again.thrown.w_WB, whole.w_WB);
  EXPECT_EQ(again.thrown.known, whole.known);
  EXPECT_EQ(again.thrown.entry, whole.entry);
  EXPECT_EQ(again.thrown.entry_speed, whole.entry_speed);
  EXPECT_EQ(again.thrown.entry_angle_deg, whole.entry_angle_deg);
  EXPECT_EQ(again.down, whole.felled_by_ball);
}

TEST(ThrowAgain, AsItWasHasTheBitsOfTheSession) {
  const scene::Score whole = played(demo().scenario, demo().samples, 7.0);
  ASSERT_EQ(whole.throws.size(), 1u);
  expect_same_throw(throw_again(demo_throw(), {}), whole.throws.front());
}

// A switch that bounces: the ball is taken and let go within a tick, and taken again.
TEST(ThrowAgain, OfATickIsAThrowOfItsOwn) {
  std::vector<devices::Sample> samples = demo().samples;
  const auto press = std::ranges::find_if(samples, [](const devices::Sample& sample) {
    const auto* button = std::get_if<devices::MouseSample>(&sample);
    return button && button->trigger;
  });
  ASSERT_NE(press, samples.end());
  const auto first = std::get<devices::MouseSample>(*press);
  const Time delay = microseconds(demo().scenario.rig.delay_s);
  const std::int64_t rate = demo().scenario.rates.physics_hz;
  const Time tick = tick_time(static_cast<std::int64_t>(seconds(first.device_time + delay) *
                                                        static_cast<double>(rate)) +
                                  1,
                              rate) -
                    delay;
  std::vector<devices::Sample> bounces;
  for (const auto& [after_us, trigger] : {std::pair{500, true}, {2'000, false}, {20'000, true}}) {
    devices::MouseSample button = first;
    button.device_time = tick + Time{after_us};
    button.trigger = trigger;
    bounces.emplace_back(button);
  }
  const auto at = samples.erase(press);
  samples.insert(at, bounces.begin(), bounces.end());
  Situations situations(kMostShift);
  const scene::Score whole = played(demo().scenario, samples, 7.0, &situations);
  ASSERT_EQ(whole.throws.size(), 2u);
  ASSERT_EQ(situations.all().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Outcome again = throw_again(situations.all()[i], {});
    EXPECT_EQ(again.thrown.release, whole.throws[i].release);
    EXPECT_EQ(again.thrown.v_WB, whole.throws[i].v_WB);
  }
  expect_same_throw(throw_again(situations.all()[1], {}), whole.throws[1]);
}

// The same session with the trigger's sample at another time, simulated from its start.
TEST(ThrowAgain, AtAnotherMomentIsTheSessionWhoseTriggerOpensThen) {
  for (const int later_ms : {-350, -150, -33, -1, 1, 8, 90, 150}) {
    std::vector<devices::Sample> samples = demo().samples;
    for (devices::Sample& sample : samples) {
      auto* button = std::get_if<devices::MouseSample>(&sample);
      if (button && !button->trigger) button->device_time += Time{1000 * later_ms};
    }
    std::ranges::stable_sort(samples, {}, devices::device_time);
    const scene::Score whole = played(demo().scenario, samples, 8.0);
    ASSERT_EQ(whole.throws.size(), 1u) << later_ms;
    const Outcome again = throw_again(demo_throw(), {.shift = Time{1000 * later_ms}});
    EXPECT_NO_FATAL_FAILURE(expect_same_throw(again, whole.throws.front())) << later_ms;
  }
}

// A sample is used `rig.delay_s` after it came, so of a short window it came before its session.
TEST(ThrowAgain, IsTheSameWhateverTheLongestShiftThatIsAskedFor) {
  ASSERT_GT(demo().scenario.rig.delay_s, 0.02);
  Situations few(Time{5'000});
  played(demo().scenario, demo().samples, 7.0, &few);
  ASSERT_EQ(few.all().size(), 1u);
  std::set<double> speeds;
  for (const int later_ms : {-5, -1, 0, 1, 3, 5}) {
    const Release release{.shift = Time{1000 * later_ms}};
    const Outcome of_few = throw_again(few.all().front(), release);
    const Outcome of_many = throw_again(demo_throw(), release);
    EXPECT_NO_FATAL_FAILURE(expect_same_throw(of_few, of_many.thrown)) << later_ms;
    EXPECT_EQ(of_few.down, of_many.down) << later_ms;
    speeds.insert(of_few.thrown.speed);
  }
  EXPECT_EQ(speeds.size(), 6u);
}

TEST(ThrowAgain, BeforeTheHandHadTheBallNothingIsReleased) {
  const scene::Scenario scenario;
  scene::HandScript hand(scenario);
  hand.throw_from(0.05);
  Situations situations(kMostShift);
  played(scenario, hand.samples, 4.0, &situations);
  ASSERT_EQ(situations.all().size(), 1u);
  const Situation& one = situations.all().front();
  EXPECT_TRUE(throw_again(one, {}).released);
  EXPECT_FALSE(throw_again(one, {.shift = Time{-2'000'000}}).released);
}

TEST(ThrowAgain, SecondThrowsHaveTheRackThatTheFirstLeft) {
  scene::Scenario scenario;
  scenario.game.rules = scene::GameKind::ten_pin;
  scene::HandScript hand(scenario);
  hand.throw_from(0.25);
  hand.throw_from(-0.1);
  Situations situations(Time{100'000});
  const scene::Score whole = played(scenario, hand.samples, 22.0, &situations);
  ASSERT_EQ(whole.throws.size(), 2u);
  ASSERT_EQ(situations.all().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Outcome again = throw_again(situations.all()[i], {});
    EXPECT_EQ(again.thrown.entry_speed, whole.throws[i].entry_speed) << i;
    EXPECT_EQ(again.down, whole.throws[i].counted) << i;
    EXPECT_EQ(situations.all()[i].thrown.counted, whole.throws[i].counted) << i;
  }
  EXPECT_LE(*whole.throws[0].counted + *whole.throws[1].counted, 10);
}

TEST(ThrowAgain, SecondThrowsHaveTheLaneThatTheFirstWore) {
  std::vector<double> entry_speeds;
  for (const double wear : {0.5, 0.0}) {
    scene::Scenario scenario;
    scenario.game.rules = scene::GameKind::ten_pin;
    scenario.game.balls = 1;  // each at a full rack
    scenario.collision.response = "coulomb";
    scenario.lane.oil.zones = {{1, 39, 0.0, 4.0, 0.04}};
    scenario.lane.oil.wear = wear;
    scene::HandScript hand(scenario);
    hand.throw_from(0.25);
    hand.throw_from(0.25);
    Situations situations(Time{100'000});
    const scene::Score whole = played(scenario, hand.samples, 30.0, &situations);
    ASSERT_EQ(whole.throws.size(), 2u);
    ASSERT_EQ(situations.all().size(), 2u);
    expect_same_throw(throw_again(situations.all()[1], {}), whole.throws[1]);
    for (const scene::ThrowRow& row : whole.throws) {
      entry_speeds.push_back(row.entry_speed.value_or(0.0));
    }
  }
  EXPECT_EQ(entry_speeds[0], entry_speeds[2]) << "the first throw feels no wear";
  EXPECT_LT(entry_speeds[1], entry_speeds[3] - 0.01);
}

TEST(ThrowAgain, AChangeIsTheChangeThatWasAskedFor) {
  const Outcome real = throw_again(demo_throw(), {});
  const double direction = scene::degrees_from_y(*real.thrown.v_WB);
  const Outcome faster = throw_again(demo_throw(), {.change = {.speed = 1.25}});
  EXPECT_NEAR(faster.thrown.speed, 1.25 * real.thrown.speed, 1e-12);
  EXPECT_LT(*faster.thrown.entry, *real.thrown.entry);
  const Outcome turned = throw_again(demo_throw(), {.change = {.direction_deg = 2.0}});
  EXPECT_NEAR(scene::degrees_from_y(*turned.thrown.v_WB), direction + 2.0, 1e-9);
  EXPECT_NEAR(turned.thrown.speed, real.thrown.speed, 1e-12);
  EXPECT_EQ(turned.thrown.v_WB->z(), real.thrown.v_WB->z());
  const Outcome higher = throw_again(demo_throw(), {.change = {.height = 0.2}});
  EXPECT_NEAR(higher.thrown.p_WB->z(), real.thrown.p_WB->z() + 0.2, 1e-12);
  EXPECT_EQ(higher.thrown.v_WB, real.thrown.v_WB);
  const Outcome spun = throw_again(demo_throw(), {.change = {.spin = 30.0}});
  const Vec3 added = *spun.thrown.w_WB - *real.thrown.w_WB;
  EXPECT_NEAR(added.norm(), 30.0, 1e-9);
  EXPECT_GT(added.y(), 29.0);
  // A ball that spins about its way rubs the lane to the left and is pushed to the right.
  EXPECT_GT(*spun.thrown.entry_angle_deg, *real.thrown.entry_angle_deg + 1.0);
}

TEST(ThrowAgain, ManyThreadsGiveTheOutcomesOfOne) {
  const std::vector<Release> releases = moments(Time{60'000}, Time{15'000});
  std::int64_t seen = 0;
  const auto check = [&](std::int64_t done) { seen = std::max(seen, done); };
  const std::vector<Outcome> one = throw_again(demo_throw(), releases, 1, check);
  const std::vector<Outcome> three = throw_again(demo_throw(), releases, 3, check);
  ASSERT_EQ(one.size(), 9u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].down, three[i].down);
    EXPECT_EQ(one[i].thrown.entry_speed, three[i].thrown.entry_speed);
    EXPECT_EQ(one[i].thrown.speed, throw_again(demo_throw(), releases[i]).thrown.speed);
  }
  EXPECT_EQ(seen, 9);
  EXPECT_EQ(complaint([&] {
              throw_again(demo_throw(), releases, 2,
                          [](std::int64_t) { throw std::runtime_error("stop here"); });
            }),
            "stop here");
}

TEST(WhatIf, MomentsAreEvenAroundTheRealOne) {
  std::vector<std::int64_t> shifts;
  for (const Release& release : moments(Time{5000}, Time{2000})) {
    shifts.push_back(release.shift.count());
  }
  EXPECT_THAT(shifts, ElementsAre(-4000, -2000, 0, 2000, 4000));
}

TEST(WhatIf, AxesHaveTheirEndsAndTheirMiddle) {
  const std::vector<double> axis = evenly(-4.0, 4.0, 17);
  EXPECT_EQ(axis.front(), -4.0);
  EXPECT_EQ(axis[8], 0.0);
  EXPECT_EQ(axis.back(), 4.0);
  EXPECT_EQ(evenly(0.8, 1.2, 9)[4], 1.0);
  EXPECT_EQ(evenly(-1.0, 2.0, 4)[1], 0.0);
  EXPECT_EQ(evenly(-0.3, 0.1, 5)[3], 0.0);
  EXPECT_EQ(evenly(0.7, 1.1, 5)[3], 1.0);
  EXPECT_THAT(evenly(0.3, 7.0, 1), ElementsAre(0.3));
  const ReleaseGrid grid{{0.9, 1.0, 1.1}, {-1, 1}, {0.0}, {-5, 0, 5, 10}};
  const std::vector<Release> releases = releases_of(grid);
  ASSERT_EQ(releases.size(), grid.size());
  const scene::ReleaseChange& change = releases[grid.number({2, 0, 0, 3})].change;
  EXPECT_EQ(change.speed, 1.1);
  EXPECT_EQ(change.direction_deg, -1.0);
  EXPECT_EQ(change.spin, 10.0);
}

std::vector<Outcome> outcomes_of(const std::vector<std::int64_t>& down) {
  std::vector<Outcome> outcomes(down.size());
  for (std::size_t i = 0; i < down.size(); ++i) {
    outcomes[i].released = down[i] >= 0;
    outcomes[i].down = down[i];
  }
  return outcomes;
}

TEST(WhatIf, TheWindowIsTheRunAroundTheRealMoment) {
  const std::vector<Release> five = moments(Time{2000}, Time{1000});
  const auto window = [&](const std::vector<std::int64_t>& down) {
    return window_of_success(five, outcomes_of(down), 7);
  };
  const std::optional<Window> found = window({9, 3, 7, 8, 6});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->from, Time{0});
  EXPECT_EQ(found->to, Time{1000});
  EXPECT_FALSE(found->cut);
  EXPECT_TRUE(window({9, 8, 7, 8, 6})->cut);
  EXPECT_TRUE(window({0, 0, 7, 8, 7})->cut);
  EXPECT_EQ(window({0, 0, 7, 8, 7})->to, Time{2000});
  EXPECT_FALSE(window({9, 9, 6, 9, 9}));
  const std::optional<Window> after_grab = window({-1, 9, 7, 0, 0});
  ASSERT_TRUE(after_grab);
  EXPECT_EQ(after_grab->from, Time{-1000});
  EXPECT_FALSE(after_grab->cut);
}

TEST(WhatIf, TheMissRoomIsTheRunOfBoardsAroundTheThrow) {
  ReleaseGrid grid{{0.9, 1.0}, {-1, 0, 1}, {0.0}, {0.0}};
  grid.boards = {-2, -1, 0, 1, 2};
  /// Skittles down over board and direction, at the unchanged speed; at the other none fall.
  const auto rooms = [&](const std::array<std::array<std::int64_t, 5>, 3>& down) {
    std::vector<Outcome> outcomes(grid.size());
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t b = 0; b < 5; ++b) {
        Outcome& outcome = outcomes[grid.number({1, d, 0, 0, b})];
        outcome.released = true;
        outcome.down = down[d][b];
      }
    }
    return miss_rooms(grid, outcomes, 10);
  };
  const MissRooms found = rooms({{{10, 10, 10, 10, 9}, {3, 10, 10, 9, 10}, {10, 9, 10, 9, 9}}});
  ASSERT_TRUE(found.own && found.widest);
  EXPECT_EQ(found.own->from, -1.0);
  EXPECT_EQ(found.own->to, 0.0);
  EXPECT_FALSE(found.own->cut);
  EXPECT_EQ(found.widest->direction_deg, -1.0);
  EXPECT_EQ(found.widest->boards(), 3.0);
  EXPECT_TRUE(found.widest->cut);
  // The throw itself fails; of two rooms of one width, the nearer direction counts.
  const MissRooms failed = rooms({{{9, 10, 10, 9, 9}, {10, 10, 9, 9, 9}, {9, 9, 9, 9, 9}}});
  EXPECT_FALSE(failed.own);
  EXPECT_EQ(failed.widest->direction_deg, 0.0);
  EXPECT_EQ(failed.widest->to, -1.0);
  EXPECT_FALSE(rooms({}).widest);
  EXPECT_TRUE(failed.in_grid);
  // The throw's own board is none of these, so they do not say that the throw fails.
  grid.boards = {1, 2, 3, 4, 5};
  EXPECT_FALSE(rooms({{{9, 9, 9, 9, 9}, {10, 10, 10, 9, 9}, {9, 9, 9, 9, 9}}}).in_grid);
  grid.boards = {-2, -1, 0, 1, 2};
  grid.direction_deg = {1, 2, 3};
  EXPECT_FALSE(rooms({}).in_grid);
}

TEST(WhatIf, BoardRevsAndRotationChangeTheReleaseByWhatTheySay) {
  const Outcome real = throw_again(demo_throw(), {});
  const Outcome moved = throw_again(demo_throw(), {.change = {.boards = 2.0}});
  const double board = 1.0541 / 39.0;
  EXPECT_NEAR((*moved.thrown.p_WB - *real.thrown.p_WB - Vec3(-2.0 * board, 0.0, 0.0)).norm(), 0.0,
              1e-12);
  EXPECT_EQ(*moved.thrown.v_WB, *real.thrown.v_WB);
  const Outcome faster = throw_again(demo_throw(), {.change = {.revs = 3.0}});
  EXPECT_NEAR((*faster.thrown.w_WB - 3.0 * *real.thrown.w_WB).norm(), 0.0, 1e-12);
  const Outcome turned = throw_again(demo_throw(), {.change = {.rotation_deg = 90.0}});
  const Vec3 &w = *real.thrown.w_WB, &w90 = *turned.thrown.w_WB;
  EXPECT_NEAR(w90.x(), -w.y(), 1e-12);
  EXPECT_NEAR(w90.y(), w.x(), 1e-12);
  EXPECT_NEAR(w90.z(), w.z(), 1e-12);
  const auto axis_rotation = [](const Outcome& outcome) {
    engine::State let_go;
    let_go.v_WB = *outcome.thrown.v_WB;
    let_go.w_WB = *outcome.thrown.w_WB;
    return scene::delivered({}, let_go).rotation_deg;
  };
  EXPECT_NEAR(std::remainder(axis_rotation(turned) - axis_rotation(real) - 90.0, 360.0), 0.0, 1e-9);
}

TEST(WhatIf, TheBestAssignmentIsTheBestOfAllPermutations) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const std::size_t n = 1 + random() % 6;
    std::vector<std::vector<double>> gain(n, std::vector<double>(n));
    for (auto& row : gain) {
      for (double& value : row) value = static_cast<double>(random() % 11);
    }
    const auto sum = [&](const std::vector<std::size_t>& column_of) {
      double all = 0.0;
      for (std::size_t row = 0; row < n; ++row) all += gain[row][column_of[row]];
      return all;
    };
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    double best = 0.0;
    do {
      best = std::max(best, sum(order));
    } while (std::next_permutation(order.begin(), order.end()));
    std::vector<std::size_t> found = best_assignment(gain);
    EXPECT_EQ(sum(found), best);
    std::ranges::sort(found);
    for (std::size_t k = 0; k < n; ++k) EXPECT_EQ(found[k], k);
  }
}

/// Costs where the result is a known function of speed [m/s] and direction [degrees].
Costs costs_under(const std::function<double(double, double)>& law,
                  const std::vector<Execution>& throws) {
  const Execution recorded{6.0, 1.0};
  const ReleaseGrid grid{evenly(0.8, 1.2, 25), evenly(-4, 4, 17), {0.0}, {0.0}};
  return costs_of(throws, recorded, grid, [&](std::span<const Release> releases) {
    std::vector<Outcome> outcomes(releases.size());
    for (std::size_t i = 0; i < releases.size(); ++i) {
      const scene::ReleaseChange& change = releases[i].change;
      outcomes[i].released = true;
      outcomes[i].down = std::lround(
          law(recorded.speed * change.speed, recorded.direction_deg + change.direction_deg));
    }
    return outcomes;
  });
}

// Cohen and Sternad 2009: each cost alone, where a law makes it the only one.
TEST(WhatIf, CostsAreThoseOfKnownLaws) {
  // Thousandths of a skittle, so that whole numbers are fine enough.
  const auto near_seven = [](double speed, double) {
    return 10'000.0 - 1000.0 * std::abs(speed - 7.0);
  };
  const Costs off = costs_under(near_seven, {{6.0, 1.0}, {6.2, 1.0}, {5.8, 1.0}});
  EXPECT_NEAR(off.mean, 9000.0, 1.0);
  EXPECT_NEAR(off.tolerance, 1000.0 - 400.0 / 3.0, 1.0);  // what is left is their spread
  EXPECT_NEAR(off.best_shift.speed, 1.0, 1e-9);
  EXPECT_NEAR(off.noise, 0.0, 1.0);
  EXPECT_EQ(off.covariation, 0.0);
  EXPECT_EQ(off.down.size(), 3u);

  const Costs spread = costs_under(near_seven, {{6.5, 1.0}, {7.5, 1.0}});
  EXPECT_NEAR(spread.noise, 500.0, 1.0);
  EXPECT_EQ(spread.best_size, 0.0);
  EXPECT_NEAR(spread.tolerance, 0.0, 1.0);

  // Fast and left, slow and right are good together.
  const auto together = [](double speed, double direction) {
    return 10'000.0 - 1000.0 * std::abs((speed - 6.0) + (direction - 1.0));
  };
  const Costs paired = costs_under(together, {{6.5, 1.5}, {5.5, 0.5}, {6.0, 1.0}});
  EXPECT_NEAR(paired.mean, 10'000.0 - 2000.0 / 3.0, 1.0);
  EXPECT_NEAR(paired.covariation, 2000.0 / 3.0, 1.0);
  EXPECT_NEAR(costs_under(together, {{6.5, 0.5}, {5.5, 1.5}}).covariation, 0.0, 1.0);
  EXPECT_THAT(complaint([&] { costs_under(together, {{6.5, 0.5}}); }), HasSubstr("two throws"));
}

TEST(WhatIf, CostsOfARealThrowAreNeverNegativeAndItsOwnCountIsThere) {
  const Outcome real = throw_again(demo_throw(), {});
  const Execution own = *execution_of(real.thrown);
  const ReleaseGrid grid{{0.9, 1.0}, {0.0, 1.0}, {0.0}, {0.0}};
  const std::vector<Execution> throws = {own, {own.speed, own.direction_deg + 3.0}};
  const Costs costs = costs_of(throws, own, grid, [&](std::span<const Release> releases) {
    return throw_again(demo_throw(), releases, 2, [](std::int64_t) {});
  });
  EXPECT_EQ(costs.down.front(), real.down);
  EXPECT_NEAR(costs.mean, static_cast<double>(costs.down[0] + costs.down[1]) / 2.0, 1e-12);
  EXPECT_GE(costs.tolerance, 0.0);
  EXPECT_GE(costs.noise, 0.0);
  EXPECT_GE(costs.covariation, 0.0);
}

// docs/guides/whatif.md tells what each column is.
TEST(WhatIf, ColumnsAreTheOnesOfTheGuide) {
  const std::string page = slurp(HEADPIN_SOURCE_DIR "/docs/guides/whatif.md");
  for (const WhatIfColumn& column : release_columns()) {
    const std::string unit = *column.unit ? fmt::format("{} ", column.unit) : "";
    EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` | {}| {}", column.name, unit, column.meaning)));
  }
}

}  // namespace
}  // namespace headpin::sweep
