#include "sweep/runner.h"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "base/input_file.h"
#include "base/sha256.h"
#include "devices/base/sources.h"
#include "scene/play/run.h"
#include "scene/play/session.h"
#include "scene/record/file.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "sweep/result.h"
#include "sweep/rows.h"

namespace headpin::sweep {

namespace {

/// An exception of `check`, which is not an error of the row.
struct Interrupted {
  std::exception_ptr why;
};

/// Simulates a trial as it was recorded.
Frames frames_of(const Trial& trial) {
  scene::Session session = scene::make_session(trial.scenario);
  session.hashes = false;
  session.world.parameters.keep_ledger = false;
  devices::ReplaySource source(trial.samples);
  const std::int64_t ticks = scene::tick_count(trial.summary, session.scenario().rates.physics_hz);
  Frames frames(1, places_of(session));
  while (session.tick < ticks) {
    scene::advance(session, source);
    const std::optional<std::int64_t> frame = frame_of(session.tick, trial.scenario.rates);
    if (frame) frames.resize(static_cast<std::size_t>(*frame) + 1, places_of(session));
  }
  return frames;
}

const Frames& own_condition(const Trial& trial) {
  std::call_once(trial.own->once, [&] {
    try {
      trial.own->frames = frames_of(trial);
    } catch (const std::bad_alloc&) {
      throw;  // the next row tries again
    } catch (const std::exception&) {
      trial.own->frames.clear();
    }
  });
  return trial.own->frames;
}

}  // namespace

Trial read_trial(const std::string& path) {
  constexpr std::size_t kMost = 4'000'000'000;
  const std::vector<std::uint8_t> bytes = base::read_bytes(path, kMost);
  const scene::Recorded recorded = scene::load_trial(bytes, path);
  Trial trial;
  trial.sha256 = base::sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  trial.scenario = recorded.scenario;
  trial.scenario_text = scene::to_toml(recorded.scenario);
  recorded.file.walk([&](scene::TrialFile::Item& item) {
    if (auto* sample = std::get_if<devices::Sample>(&item)) {
      trial.samples.push_back(std::move(*sample));
    }
    return true;
  });
  trial.summary = recorded.file.summary();
  return trial;
}

std::shared_ptr<const scene::Stage> Replayer::stage_of(std::size_t number,
                                                       const std::vector<std::string>& values) {
  const Trial& trial = trials_[number];
  std::string text = trial.scenario_text;
  for (const std::string& value : values) text += "\n" + value;
  if (!stage_ || text != stage_text_) {
    stage_.reset();
    scene::Scenario scenario = trial.scenario;
    scene::apply(condition_of(keys_, values), scenario);
    stage_ = std::make_shared<const scene::Stage>(scene::make_stage(scenario));
    stage_text_ = std::move(text);
  }
  return stage_;
}

std::vector<std::string> Replayer::run(std::size_t number, const std::vector<std::string>& values,
                                       const std::function<void()>& check) {
  const Trial& trial = trials_[number];
  try {
    const auto check_this = [&] {
      try {
        check();
      } catch (...) {
        throw Interrupted{std::current_exception()};
      }
    };
    const auto begin = [&] {
      Run run{scene::make_session(stage_of(number, values)), devices::ReplaySource(trial.samples),
              Result(&own_condition(trial), trial.scenario.rates)};
      run.session.hashes = false;
      return run;
    };
    Run run = start_.run_of(text_of_others(number, keys_, values), begin, check_this);
    scene::NoPace pace;
    scene::Observer* const observer = &run.sum;
    const std::int64_t ticks = scene::tick_count(
        trial.summary, run.session.scenario().rates.physics_hz, trial.scenario.rates.physics_hz);
    std::optional<std::int64_t> first_touch;
    scene::run(run.session, run.source, pace, std::span(&observer, 1),
               [&](const scene::Session& s) {
                 check_this();
                 if (!first_touch && is_touched(s)) first_touch = s.tick;
                 return s.tick >= ticks;
               });
    start_.learn(first_touch);
    return run.sum.cells(run.session);
  } catch (const Interrupted& interrupted) {
    std::rethrow_exception(interrupted.why);
  } catch (const std::bad_alloc&) {
    throw;  // the machine's, not the row's: a later run has the row
  } catch (const std::exception& error) {
    return failed_cells(error.what());
  }
}

std::vector<std::string> Runner::run(const Row& row, const std::function<void()>& check) {
  std::vector<std::string> line = cells_of(rows_, row);
  const std::vector<std::string> result = replayer_.run(row.trial, row.values, check);
  line.insert(line.end(), result.begin(), result.end());
  return line;
}

}  // namespace headpin::sweep
