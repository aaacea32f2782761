#include "apps/study_people.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "apps/answer_file.h"
#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "base/input_file.h"
#include "base/sha256.h"
#include "base/threads.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

/// Frame rate of a live session; nothing for other sessions.
std::optional<double> frame_rate_of(const scene::Recorded& recorded) {
  for (const scene::Event& event : recorded.file.summary().events) {
    if (event.kind != scene::kind::kept_pace) continue;
    const auto pace = event.detail.value_or(scene::KeptPace{});
    const auto hz = static_cast<double>(recorded.scenario.rates.physics_hz);
    const auto frames = static_cast<double>(pace.frames), ticks = static_cast<double>(pace.ticks);
    if (ticks > 0.0) return frames * hz / ticks;
  }
  return std::nullopt;
}

/// Simulates the session again and takes its measures.
study::Played measured(const Run& run) {
  constexpr std::size_t kMost = 4'000'000'000;
  const scene::Recorded recorded = scene::load_trial(run.path.string());
  const scene::TrialSummary& trial = recorded.file.summary();
  study::Played played;
  played.run = run.name;
  played.is_virtual = run.is_virtual;
  played.longest_gap_s = nearest_seconds(trial.longest_gap.length());
  for (const auto& [device, summary] : trial.devices) {
    played.lost += summary.lost;
    played.bad += summary.bad;
  }
  played.frame_rate_hz = frame_rate_of(recorded);
  scene::Session session = scene::make_session(recorded.scenario);
  const auto said = scene::said_game_hash(trial);
  const std::int64_t ticks = said ? said->tick : recorded.ticks();
  study::Measurer measurer;
  scene::Observer* const observer = &measurer;
  scene::TrialPlayer source(recorded.file);
  scene::NoPace pace;
  scene::run(session, source, pace, std::span(&observer, 1), [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  played.measures = measurer.measures(session);
  played.replays = said && said->hash == played.measures.game_hash;
  const std::vector<std::uint8_t> bytes = base::read_bytes(run.path.string(), kMost);
  played.sha256 = base::sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return played;
}

study::Person person_of(const Study& study, const study::PlannedParticipant& planned) {
  study::Person person;
  person.planned = planned;
  person.answers = answers_of(study, planned.id);
  const std::vector<Run> runs = runs_of(study, planned.id);
  if (const Run* run = counting(runs)) {
    try {
      person.played = measured(*run);
    } catch (const std::exception& error) {
      if (stop_signal() != 0) throw;
      throw std::runtime_error(fmt::format("{}: {}", run->path.string(), error.what()));
    }
  }
  person.played.runs = static_cast<int>(runs.size());
  if (person.played.run.empty() && !runs.empty()) {
    person.played.why_not = fmt::format("{} {}", runs.back().name, why_not(runs.back()));
  }
  return person;
}

}  // namespace

std::vector<study::Person> people_of(const Study& study, int jobs) {
  const auto replaced = study::replaced(study.plan);
  std::vector<study::Person> people(study.plan.size());
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  base::in_threads(jobs, [&] {
    for (std::size_t at = next++; at < people.size(); at = next++) {
      try {
        people[at] = person_of(study, study.plan[at]);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = people.size();
      }
    }
  });
  if (failure) std::rethrow_exception(failure);
  for (study::Person& person : people) {
    const auto by = replaced.find(person.planned.id);
    if (by != replaced.end()) person.replaced_by = by->second;
  }
  return people;
}

void add_mixing(CLI::App& command, Mixing& mixing) {
  CLI::Option* mix =
      command.add_flag("--mix", mixing.mix, "count people and virtual participants together");
  command.add_option("--only", mixing.only, "count these alone")
      ->check(one_of({"people", "virtual"}))
      ->excludes(mix);
}

Counted counted_of(const Study& study, const std::vector<study::Person>& all,
                   const Mixing& mixing) {
  Counted counted;
  std::size_t virtuals = 0;
  for (const study::Person& person : all) {
    if (!study::why_not(study.design, study.questions, person).empty()) continue;
    if (!mixing.only.empty() && person.is_virtual() != (mixing.only == "virtual")) continue;
    counted.people.push_back(person);
    virtuals += person.is_virtual() ? 1 : 0;
  }
  if (virtuals > 0 && virtuals < counted.people.size() && !mixing.mix) {
    throw UsageError(
        fmt::format("{} of {} participants who count are virtual; expected --only "
                    "people, --only virtual, or --mix for all of them together",
                    virtuals, counted.people.size()));
  }
  if (counted.people.empty()) {
    counted.of = study::kNoAnswer;
  } else {
    counted.of = virtuals == 0 ? "no" : virtuals == counted.people.size() ? "yes" : "mixed";
  }
  return counted;
}

}  // namespace headpin::apps
