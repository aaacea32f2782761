// What holds in every scenario that is bundled: it stands, and a whole game can be played in it.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/people/participant.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

using namespace std::chrono_literals;

class EveryScenario : public testing::TestWithParam<std::string> {};

std::string scenario_folder() {
  return HEADPIN_SOURCE_DIR "/assets/scenarios/";
}

std::vector<std::string> bundled_scenarios() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(scenario_folder())) {
    names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

struct EventsSeen : Observer {
  void tick(const Session& session) override {
    events.insert(events.end(), session.events.begin(), session.events.end());
  }
  std::vector<Event> events;
};

Scenario to_be_played(const std::string& name) {
  Scenario scenario = load_scenario(scenario_folder() + name + ".toml");
  set_up_for_participants(scenario);
  return scenario;
}

TEST_P(EveryScenario, StandsUntouchedForAMinute) {
  Session session = make_session(to_be_played(GetParam()));
  const std::vector<engine::State> before = session.world.states;
  const std::vector<devices::Sample> none;
  devices::ReplaySource nothing(none);
  NoPace pace;
  EventsSeen seen;
  Observer* const observers[] = {&seen};
  run(session, nothing, pace, observers, [](const Session& s) { return s.now() >= 60s; });
  for (const Event& event : seen.events) EXPECT_EQ(event.kind, kind::game);
  ASSERT_EQ(session.stage->skittles.size(), session.scenario().rack.spots.size());
  for (const engine::BodyId skittle : session.stage->skittles) {
    const Vec3 moved = session.world.states[skittle].X_WB.p - before[skittle].X_WB.p;
    EXPECT_LT(moved.norm(), 1e-4);
    EXPECT_FALSE(has_fallen(session.world.states[skittle].X_WB));
  }
}

TEST_P(EveryScenario, AWholeGameIsPlayedInIt) {
  Scenario scenario = to_be_played(GetParam());
  if (!kThorough) scenario.game.frames = 1;
  constexpr int kMoreThanAnyGame = 100;
  Session session = make_session(scenario);
  Participant participant({draw_person(7), kMoreThanAnyGame}, scenario);
  NoPace pace;
  EventsSeen seen;
  Observer* const observers[] = {&participant, &seen};
  run(session, participant, pace, observers,
      [&](const Session& s) { return participant.finished() || s.now() > 3600s; });
  ASSERT_FALSE(participant.gave_up());
  const Score sheets = score(seen.events);
  if (scenario.game.rules == GameKind::one_throw) {
    EXPECT_EQ(participant.throws(), 1);
    EXPECT_GT(sheets.skittles_down, 0);
    return;
  }
  ASSERT_EQ(sheets.games.size(), scenario.version.buttons ? 2u : 1u);
  int balls = 0;
  for (const Sheet& sheet : sheets.games) {
    EXPECT_TRUE(sheet.over);
    const auto played =
        std::ranges::count_if(sheet.frames, [](const Frame& f) { return !f.empty(); });
    EXPECT_EQ(played, scenario.game.frames);
    EXPECT_GT(points(sheet), 0);
    for (const Frame& frame : sheet.frames) balls += static_cast<int>(frame.size());
  }
  EXPECT_EQ(participant.throws(), balls);
}

INSTANTIATE_TEST_SUITE_P(Bundled, EveryScenario, testing::ValuesIn(bundled_scenarios()),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace headpin::scene
