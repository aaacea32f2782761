#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/live.h"
#include "apps/next_run.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "apps/study_play.h"
#include "base/lock.h"
#include "base/threads.h"
#include "scene/watch/totals.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr const char* kCommand = "headpin experiment run";

struct RunOptions {
  std::string study, participant, trial;
  bool is_virtual = false, all = false, json = false;
  int jobs = 1;
  std::shared_ptr<LiveOptions> live = std::make_shared<LiveOptions>();
};

nlohmann::ordered_json to_json(const std::string& id, bool is_virtual,
                               const PlayedSession& session) {
  return {{"participant", id},
          {"virtual", is_virtual},
          {"output", session.path},
          {"duration_s", session.duration_s},
          {"games", scene::to_json(session.score.games)}};
}

void print_session(const std::string& id, bool is_virtual, const PlayedSession& session) {
  fmt::print("{}{}  {:.1f} s", id, is_virtual ? ", virtual" : "", session.duration_s);
  for (const scene::Sheet& game : session.score.games) fmt::print("; {}", scene::in_words(game));
  fmt::print("\n");
}

/// Plays the sessions of all participants who have not played, one session per thread. Those of whom a
/// person has begun a session are left to that person.
class VirtualStudy {
 public:
  VirtualStudy(const Study& study, int jobs) : study_(study), jobs_(jobs) {
    const auto replaced = study::replaced(study.plan);
    for (const study::PlannedParticipant& one : study.plan) {
      if (replaced.contains(one.id)) continue;
      if (counting(runs_of(study, one.id))) continue;
      waiting_.push_back(&one);
    }
    played_.resize(waiting_.size());
  }

  /// @throws  the first failure; base::Busy if other processes were playing some of the sessions
  void play() {
    Progress progress("sessions", static_cast<std::int64_t>(waiting_.size()));
    base::in_threads(jobs_, [&] { work(progress); });
    if (failure_) std::rethrow_exception(failure_);
  }

  void tell(bool json) const {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      if (!played_[i]) continue;
      if (json) {
        all.push_back(to_json(waiting_[i]->id, true, *played_[i]));
      } else {
        print_session(waiting_[i]->id, true, *played_[i]);
      }
    }
    if (json) print_json({{"sessions", all}});
    if (!busy_.empty()) throw base::Busy(busy_);
  }

 private:
  void work(Progress& progress) {
    for (std::size_t i = next_++; i < waiting_.size() && !failed_; i = next_++) {
      try {
        const std::string& id = waiting_[i]->id;
        leave_to_person(runs_of(study_, id), id);  // whoever plays now has locked the session
        const NextRun run(study_, id, kCommand, true);
        played_[i] = play_virtual(study_, *waiting_[i], run.path(), [this] {
          check_stop();
          if (failed_) throw std::runtime_error("another session failed");
        });
      } catch (const PlayedAlready&) {  // by another process, since this one began
      } catch (const PersonsSession& error) {
        say("{}: {}\n", kCommand, error.what());
      } catch (const base::Busy& error) {
        const std::lock_guard lock(mutex_);
        busy_ = error.what();
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
        failed_ = true;
      }
      const std::lock_guard lock(mutex_);
      progress.show(++done_);
    }
  }

  const Study& study_;
  int jobs_;
  std::vector<const study::PlannedParticipant*> waiting_;
  std::vector<std::optional<PlayedSession>> played_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;  // for the following members
  std::exception_ptr failure_;
  std::string busy_;
  std::int64_t done_ = 0;
};

/// The trial among the sources, which has the rig of the samples; empty if there is none.
std::string trial_in(const std::vector<std::string>& sources) {
  for (const std::string& source : sources) {
    if (fs::is_regular_file(source)) return source;
  }
  return {};
}

/// The run that was just recorded; nothing where its file is gone.
std::optional<Run> recorded(const Study& study, const std::string& id, const NextRun& run) {
  const std::vector<Run> runs = runs_of(study, id);
  const auto found = std::ranges::find(runs, fs::path(run.path()), &Run::path);
  return found == runs.end() ? std::nullopt : std::optional(*found);
}

/// Says that a session began with the wrong button. It counts all the same.
void say_other_order(const Study& study, const study::PlannedParticipant& who, const Run& run) {
  if (!began_otherwise(study, who, run)) return;
  say("{}: {}: began with the {} version, in another order than planned\n", kCommand,
      printable(run.path.string()), run.first);
}

void run_live(const Study& study, const study::PlannedParticipant& who, const RunOptions& options,
              const NextRun& run) {
  LiveOptions live = *options.live;
  live.given = scenario_of(study, who, trial_in(live.sources));
  live.participant = who.id;
  for (const std::string& source : live.sources) {
    if (fs::is_regular_file(source) &&
        is_virtual_name(scene::TrialFile(source).summary().header.participant)) {
      live.participant = virtual_name(who.id);
    }
  }
  live.condition_name = condition_of(study, who);
  live.record = run.path();
  live.json = options.json;
  const bool red = study::games_of(study.design, who.allotted)[0].red;
  say("headpin experiment run: {} touches the {} button first, then the {} one\n", who.id,
      red ? "red" : "blue", red ? "blue" : "red");
  go_live(live);
  if (const auto played = recorded(study, who.id, run)) say_other_order(study, who, *played);
}

void run_one(const Study& study, const RunOptions& options) {
  const study::PlannedParticipant& who = planned(study, options.participant);
  const auto replaced = study::replaced(study.plan);
  if (replaced.contains(who.id)) {
    const std::string& by = replaced.at(who.id);
    throw UsageError(
        fmt::format("--participant: {} was replaced by {}; expected {} or another name of {}",
                    who.id, by, by, study.at.plan().string()));
  }
  const NextRun run(study, who.id, kCommand, options.is_virtual);
  if (!options.live->sources.empty()) return run_live(study, who, options, run);
  const auto each_tick = [] { check_stop(); };
  const PlayedSession session = options.is_virtual
                                    ? play_virtual(study, who, run.path(), each_tick)
                                    : play_trial(study, who, options.trial, run.path(), each_tick);
  const std::optional<Run> played = recorded(study, who.id, run);
  const bool is_virtual = played && played->is_virtual;
  if (played) say_other_order(study, who, *played);
  if (options.json) return print_json(to_json(who.id, is_virtual, session));
  print_session(who.id, is_virtual, session);
}

/// Refuses none and two of several ways, of which one is needed.
void require_one(const std::vector<std::string>& given, const std::string& expected) {
  if (given.size() == 1) return;
  if (given.empty()) throw UsageError("expected " + expected);
  throw UsageError(fmt::format("{} excludes {}; expected {}, found {}", given[0], given[1],
                               expected, given.size() == 2 ? "two" : "three"));
}

void check_ways(const RunOptions& options) {
  std::vector<std::string> sources, people;
  if (!options.live->sources.empty()) sources.push_back(options.live->sources.front());
  if (!options.trial.empty()) sources.emplace_back("--trial");
  if (options.is_virtual) sources.emplace_back("--virtual");
  require_one(sources, "one of: SOURCE (as in `headpin live`), --trial FILE, --virtual");
  if (!options.participant.empty()) people.emplace_back("--participant");
  if (options.all) people.emplace_back("--all");
  require_one(people, "--participant NAME, or --all with --virtual");
  if (options.all && !options.is_virtual) {
    throw UsageError("--all: only virtual participants play all at once; expected --virtual");
  }
}

void run_study(const RunOptions& options) {
  watch_stop_signals();
  const Study study = open_study(options.study);
  check_ways(options);
  if (!options.all) return run_one(study, options);
  VirtualStudy all(study, options.jobs);
  all.play();
  all.tell(options.json);
}

}  // namespace

void add_experiment_run(CLI::App& group) {
  CLI::App* command = group.add_subcommand("run", "Run a participant's session with both games");
  const auto options = std::make_shared<RunOptions>();
  add_study(*command, options->study);
  command->add_option("--participant", options->participant, "participant whose session it is");
  command->add_flag("--virtual", options->is_virtual,
                    "a virtual participant plays; trial and tables say so");
  command->add_option(
      "--trial", options->trial,
      "play the samples of this trial without waiting, with the trial's own tracker mounting, grip "
      "and spin of the hand");
  command->add_flag("--all", options->all, "with --virtual: everybody who has not played yet");
  command->add_option("--jobs", options->jobs, "with --all: number of sessions to run in parallel")
      ->check(whole_number_from(1, 256))
      ->capture_default_str();
  const auto take_sources = add_source_options(*command, options->live);
  add_json(*command, options->json);
  command->footer(
      "The session is recorded as sessions/NAME/run-01.lcmlog. A complete session is not played "
      "again. If a\nsession was interrupted, its file stays, and the next one is run-02. The "
      "study's scenario.toml says how\nthe tracker is mounted.\n\n"
      "Example:\n  headpin experiment run study --participant p001 fastrak:/dev/ttyUSB0\n"
      "  headpin experiment run study --all --virtual --jobs 2");
  command->callback([options, take_sources] {
    take_sources();
    run_study(*options);
  });
}

}  // namespace headpin::apps
