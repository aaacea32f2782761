#include "apps/study_play.h"

#include <array>
#include <optional>

#include <fmt/format.h>

#include "base/hash.h"
#include "base/random.h"
#include "scene/people/participant.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/notes.h"
#include "scene/watch/recorded.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"

namespace headpin::apps {

namespace {

constexpr std::uint64_t kPeople = 103;  ///< purpose of the seeds of virtual participants

/// A file with all of a trial except its states, which have twenty times the size of the rest and
/// which `replay` computes again.
class WithoutStates : public scene::TrialSink {
 public:
  WithoutStates(const std::string& path, const scene::TrialHeader& header)
      : recorder_(path, header) {}

  void write(const devices::Sample& sample) override { recorder_.write(sample); }
  void write(const scene::Event& event) override { recorder_.write(event); }
  void write(const scene::TickState&) override {}
  void write(const scene::FrameRecord& frame) override { recorder_.write(frame); }
  void close() override { recorder_.close(); }

 private:
  scene::Recorder recorder_;
};

/// The samples of a participant. A session ends in a tick that has one: then a replay of its samples
/// has as many ticks.
class Sensed : public devices::Source {
 public:
  explicit Sensed(scene::Participant& person) : person_(person) {}

  void poll(Time now, std::vector<devices::Sample>& out) override {
    const std::size_t before = out.size();
    person_.poll(now, out);
    any_ = out.size() > before;
  }
  bool exhausted() const override { return any_ && person_.finished(); }

 private:
  scene::Participant& person_;
  bool any_ = false;
};

std::uint64_t person_seed(const Study& study, const std::string& id) {
  Fnv name;
  for (const char c : id) name.add(static_cast<std::uint8_t>(c));
  return Random(study.design.seed.value_or(1), kPeople, name.value()).next();
}

/// Plays the samples of `source` until `until`, and writes a trial to `path`.
///
/// @param trial  the samples are from, or null: what was told of it is kept
PlayedSession play(const scene::Scenario& scenario, const scene::TrialHeader& header,
                   const std::string& path, devices::Source& source, scene::Observer* player,
                   const scene::TrialSummary* trial,
                   const std::function<bool(const scene::Session&)>& until) {
  scene::Session session = scene::make_session(scenario);
  scene::TrialWriter writer(
      std::make_unique<WithoutStates>(path, scene::header_of(header, session)));
  scene::Totals totals;
  std::optional<scene::Notes> notes;
  std::vector<scene::Observer*> observers;
  if (trial) observers.push_back(&notes.emplace(*trial, writer));
  observers.insert(observers.end(), {&writer, &totals});
  if (player) observers.push_back(player);
  scene::NoPace pace;
  scene::run(session, source, pace, observers, until);
  if (notes) notes->finish(session);
  writer.close(session);
  return {path, seconds(session.now()), totals.score_at_end(session)};
}

}  // namespace

scene::Scenario scenario_of(const Study& study, const study::PlannedParticipant& participant,
                            const std::string& rig_of) {
  scene::Scenario scenario = scene::load_scenario(study.at.scenario().string());
  for (const study::PlannedGame& game : study::games_of(study.design, participant.allotted)) {
    for (std::size_t i = 0; i < study.design.factors.size(); ++i) {
      scene::set(scenario, study::assignment(study.design.factors[i], game.red ? "red" : "blue",
                                             game.values[i]));
    }
  }
  if (!rig_of.empty()) {
    const scene::TrialFile file(rig_of);
    const scene::Scenario its = scene::scenario_of_trial(file.summary().header.scenario, rig_of);
    scenario.rig = its.rig;
    scenario.hand.grip = its.hand.grip;  // of a left hand the mirror image
    scenario.hand.spin = its.hand.spin;
  }
  scene::check(scenario, study.at.scenario().string());
  return scenario;
}

std::string condition_of(const Study& study, const study::PlannedParticipant& participant) {
  return fmt::format("cell {} of {}, {} changes", study::cell_of(study.design, participant),
                     study.design.letters(), study::changed_key_of(study.design, participant));
}

PlayedSession play_virtual(const Study& study, const study::PlannedParticipant& participant,
                           const std::string& path, const std::function<void()>& each_tick) {
  scene::Scenario scenario = scenario_of(study, participant);
  scene::TrialHeader header;
  header.participant = virtual_name(participant.id);
  header.condition = condition_of(study, participant);
  header.seed = person_seed(study, participant.id);
  const scene::Person drawn = scene::draw_person(header.seed);
  scene::set_up_for_participants(scenario);
  scene::set_up_hand(scenario, drawn);
  scene::check(scenario, study.at.scenario().string());
  const auto games = study::games_of(study.design, participant.allotted);
  scene::Participant person(
      {.person = drawn, .throws = study.design.throws, .blue_first = !games[0].red}, scenario);
  Sensed source(person);
  return play(scenario, header, path, source, &person, nullptr, [&](const scene::Session&) {
    each_tick();
    return source.exhausted();
  });
}

PlayedSession play_trial(const Study& study, const study::PlannedParticipant& participant,
                         const std::string& trial, const std::string& path,
                         const std::function<void()>& each_tick) {
  const scene::Recorded recorded = scene::load_trial(trial);
  const scene::TrialSummary& summary = recorded.file.summary();
  const scene::TrialHeader& its = summary.header;
  const scene::Scenario scenario = scenario_of(study, participant, trial);
  scene::TrialHeader header;
  header.participant =
      is_virtual_name(its.participant) ? virtual_name(participant.id) : participant.id;
  header.condition = condition_of(study, participant);
  header.seed = its.seed;
  const std::int64_t ticks = recorded.ticks(scenario.rates.physics_hz);
  scene::TrialPlayer source(recorded.file);
  return play(scenario, header, path, source, nullptr, &summary,
              [&](const scene::Session& session) {
                each_tick();
                return session.tick >= ticks;
              });
}

}  // namespace headpin::apps
