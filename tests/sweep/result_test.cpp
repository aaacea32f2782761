#include "sweep/result.h"

#include <algorithm>
#include <string_view>

#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "engine/world.h"
#include "scene/play/session.h"
#include "scene/watch/recorded.h"
#include "sweep/runner.h"

namespace headpin::sweep {
namespace {

std::size_t column(std::string_view name) {
  const auto& all = result_columns();
  return static_cast<std::size_t>(
      std::ranges::find(all, name,
                        [](const ResultColumn& one) { return std::string_view(one.name); }) -
      all.begin());
}

// What the hand has given is there at the end, or lost. A body that lies awake is as still as one that
// sleeps: its weight gives it energy in each step, and the floor takes it again.
TEST(Result, EnergyIsLostToContactsWhetherBodiesSleepOrLieAwake) {
  const Trial trial = read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  std::vector<double> lost, given_back;
  for (const bool sleep : {true, false}) {
    scene::Scenario scenario = trial.scenario;
    scenario.collision.sleep = sleep;
    scene::Session session = scene::make_session(scenario);
    devices::ReplaySource source(trial.samples);
    Result result(nullptr, scenario.rates);
    const std::int64_t ticks = scene::tick_count(trial.summary, scenario.rates.physics_hz);
    while (session.tick < ticks) {
      scene::advance(session, source);
      result.tick(session);
    }
    lost.push_back(std::stod(result.cells(session).at(column("energy_lost_j"))));
    given_back.push_back(session.world.ledger.gravity.energy);
    const double left = engine::balance(session.world).energy;
    EXPECT_NEAR(lost.back(), session.world.ledger.hand.energy - left, 1e-6 * lost.back());
    EXPECT_GT(lost.back(), 100.0);  // most of the throw
  }
  EXPECT_NEAR(lost[0], lost[1], 1e-6 * lost[0]);
  EXPECT_GT(given_back[1] - given_back[0], 1.0);  // skittles that lie awake
}

// 1.004166, as other tables have it, and not 1.0041659999999999.
TEST(Result, TimesAreDecimalNumbersOfMicroseconds) {
  scene::Session session = scene::make_session(scene::Scenario{});
  devices::ReplaySource source({});
  Result result(nullptr, session.scenario().rates);
  while (session.tick < 480) {
    scene::advance(session, source);
    result.tick(session);
    const double time = std::stod(result.cells(session).at(column("simulated_s")));
    EXPECT_EQ(time, nearest_seconds(session.now()));
  }
}

}  // namespace
}  // namespace headpin::sweep
