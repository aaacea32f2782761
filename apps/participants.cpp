#include "apps/participants.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "scene/people/participant.h"
#include "scene/record/log.h"
#include "scene/scenario/choices.h"
#include "scene/scenario/rules.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/totals.h"

namespace headpin::apps {

namespace {

/// Writes the device samples unchanged.
class SampleWriter : public scene::Observer {
 public:
  explicit SampleWriter(scene::Recorder& recorder) : recorder_(recorder) {}

  void tick(const scene::Session& session) override {
    for (devices::Sample sample : session.samples) {
      std::visit([](auto& one) { one.session_time = {}; }, sample);
      recorder_.write(sample);
      ++written_;
    }
  }
  std::int64_t written() const { return written_; }

 private:
  scene::Recorder& recorder_;
  std::int64_t written_ = 0;
};

void print_person(const scene::Person& person) {
  fmt::print("  who                {}-handed, {:.2f} m tall, skill {:.2f}\n",
             person.left_handed ? "left" : "right", person.height, person.skill);
}

/// Why a participant made fewer throws than it was asked for.
std::string why_fewer(const scene::Participant& participant, scene::GameKind rules) {
  if (participant.gave_up()) return "then gave up";
  if (scene::rules_of(rules).counted) return "then the game was over";
  return fmt::format("as no ball comes back with game.rules \"{}\"", scene::name_of(rules));
}

void print_throws(const scene::Participant& participant, scene::GameKind rules) {
  const int made = participant.throws(), asked = participant.throws_asked();
  fmt::print("  throws             {}", made);
  if (made < asked) fmt::print(" of {}, {}", asked, why_fewer(participant, rules));
  fmt::print("\n");
}

}  // namespace

scene::Scenario scenario_to_play(std::string name) {
  if (name.empty()) name = "paper-experiment";
  scene::Scenario scenario = scene::load_scenario(name);
  scene::set_up_for_participants(scenario);
  scene::check(scenario, name);
  return scenario;
}

void play_session(const ParticipantSession& plan, base::OutputFile output, bool json) {
  const std::string path = output.path();
  const scene::Person person = scene::draw_person(plan.seed);
  scene::Scenario scenario = plan.scenario;
  scene::set_up_hand(scenario, person);
  scene::TrialHeader header;
  header.participant = plan.name.empty() ? fmt::format("virtual {}", plan.seed) : plan.name;
  header.condition = plan.condition;
  header.seed = plan.seed;
  header.scenario = scene::to_toml(scenario);
  scene::Recorder recorder(std::move(output), header);
  scene::Session session = scene::make_session(scenario);
  scene::Participant participant({.person = person, .throws = plan.throws}, scenario);
  SampleWriter writer(recorder);
  scene::Totals totals;
  scene::Stopwatch stopwatch;
  const std::array<scene::Observer*, 4> observers = {&stopwatch, &participant, &writer, &totals};
  scene::run(session, participant, stopwatch, observers, [&](const scene::Session&) {
    check_stop();
    return participant.finished();
  });
  recorder.close();

  nlohmann::ordered_json result = {
      {"output", path},
      {"seed", plan.seed},
      {"samples", writer.written()},
      {"duration_s", seconds(session.now())},
      {"left_handed", person.left_handed},
      {"height_m", person.height},
      {"skill", person.skill},
      {"throw_count", participant.throws()},
      {"throws_asked", participant.throws_asked()},
      {"gave_up", participant.gave_up()},
      {"games", scene::to_json(totals.score().games)},
      {"realtime_factor", seconds(session.now()) / stopwatch.spent_s()}};
  if (json) return print_json(result);
  fmt::print(
      "{}\n  samples            {} of head, hand and buttons\n  duration           {:.3f} s\n",
      path, writer.written(), seconds(session.now()));
  print_person(person);
  print_throws(participant, scenario.game.rules);
  for (const scene::Sheet& game : totals.score().games) {
    fmt::print("  score sheet        {}\n", scene::in_words(game));
  }
}

}  // namespace headpin::apps
