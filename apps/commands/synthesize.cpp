#include <algorithm>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/participants.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/recordings/catalogue_csv.h"
#include "scene/people/arm_model.h"
#include "scene/people/throw.h"
#include "scene/record/log.h"
#include "scene/scenario/rules.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

struct SynthesizeOptions {
  std::optional<std::string> output;
  std::string scenario, name, condition;
  std::optional<std::uint64_t> participant;
  int throws = 10;
  scene::ThrowPlan plan;
  double aim_deg = 0.0;
  std::optional<double> duration_s;
  bool force = false, json = false;
};

/// Time for the ball to reach the skittles and for them to fall [s]: that of the plan for the
/// paper's room, plus the time on a longer lane at two thirds of the initial speed. In a game, it
/// lasts until the ball is counted.
double long_enough(const scene::ThrowPlan& plan, const scene::Scenario& scenario) {
  const double further = std::max(0.0, scenario.lane.head_pin - scene::Scenario{}.lane.head_pin);
  const double fallen = plan.duration_s + further / (0.65 * plan.speed);
  if (!scene::rules_of(scenario.game.rules).counted) return fallen;
  constexpr double kAfter = 0.5;
  const double release = seconds(scene::ThrowMotion(plan, scenario.hand).release());
  return std::max(fallen, release + scenario.game.ball_back_s + kAfter);
}

/// Writes the throw as an event log, with the samples of a tracker and a trigger.
/// @return  number of samples
std::size_t write_trial(const SynthesizeOptions& options, const scene::ThrowMotion& motion,
                        const scene::Scenario& scenario, std::uint64_t seed) {
  scene::TrialHeader header;
  header.participant = options.name;
  header.condition = options.condition;
  header.seed = seed;
  header.scenario = scene::to_toml(scenario);
  const std::vector<devices::Sample> samples = scene::sense(motion, scenario.rig, seed);
  scene::Recorder recorder(base::OutputFile(*options.output, {.overwrite = options.force,
                                                              .standard_output = true,
                                                              .inputs = {options.scenario}}),
                           header);
  scene::write(recorder, samples, {});
  check_stop();
  recorder.close();
  return samples.size();
}

/// Writes the throw in the format of the motion catalogue: head and both hands, no trigger, in
/// centimetres.
/// @return  number of samples
std::size_t write_csv(const SynthesizeOptions& options, const scene::ThrowMotion& motion,
                      std::uint64_t seed) {
  const devices::MotionRecording recording = scene::record(motion, seed);
  const std::string text = devices::to_catalogue_csv(recording, 0.01);
  base::OutputFile file(*options.output,
                        {.overwrite = options.force, .inputs = {options.scenario}});
  file.write(text.data(), text.size());
  check_stop();
  file.commit();
  return recording.times.size();
}

void synthesize_session(const SynthesizeOptions& options) {
  if (options.output->ends_with(".csv")) {
    throw UsageError(
        "a session has buttons, which a recording (.csv) cannot hold; expected .lcmlog");
  }
  const ParticipantSession plan{.scenario = scenario_to_play(options.scenario),
                                .name = options.name,
                                .condition = options.condition,
                                .seed = *options.participant,
                                .throws = options.throws};
  watch_stop_signals();
  play_session(
      plan,
      {*options.output,
       {.overwrite = options.force, .standard_output = true, .inputs = {options.scenario}}},
      options.json);
}

void synthesize(const SynthesizeOptions& options) {
  if (options.participant) return synthesize_session(options);
  constexpr double kDegree = std::numbers::pi / 180.0;
  scene::ThrowPlan plan = options.plan;
  plan.aim = options.aim_deg * kDegree;
  scene::Scenario scenario =
      options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
  const scene::ThrowMotion motion = [&] {
    try {
      plan.duration_s = options.duration_s ? *options.duration_s : long_enough(plan, scenario);
      scene::ThrowMotion made(plan, scenario.hand);
      scene::set_up(scenario, made);
      return made;
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }();
  scene::check(scenario, options.scenario.empty() ? "the paper's room" : options.scenario);

  watch_stop_signals();
  const bool csv = options.output->ends_with(".csv");
  const std::size_t samples = csv ? write_csv(options, motion, plan.seed)
                                  : write_trial(options, motion, scenario, plan.seed);
  if (options.json) {
    print_json({{"output", *options.output},
                {"seed", plan.seed},
                {"samples", samples},
                {"duration_s", seconds(motion.duration())},
                {"grab_s", seconds(motion.grab())},
                {"release_s", seconds(motion.release())},
                {"planned_speed_mps", motion.ball_speed()}});
    return;
  }
  std::cout << fmt::format(
      "{}\n"
      "  samples            {} of {}\n"
      "  duration           {:.3f} s\n"
      "  grab               {:.3f} s\n"
      "  release            {:.3f} s\n"
      "  planned speed      {:.2f} m/s\n",
      *options.output, samples, csv ? "head and both hands" : "head, hand and trigger",
      seconds(motion.duration()), seconds(motion.grab()), seconds(motion.release()),
      motion.ball_speed());
}

}  // namespace

void add_synthesize(CLI::App& app) {
  CLI::App* command = app.add_subcommand("synthesize", "Make a trial with a model of the arm");
  const auto options = std::make_shared<SynthesizeOptions>();
  add_output(*command, "-o,--output", options->output,
             "file to write: a trial (.lcmlog), or a recording that `import` reads (.csv); - is "
             "standard output",
             {".lcmlog", ".csv"})
      ->required();
  auto* seeded =
      command->add_option("--seed", options->plan.seed, "seed of swing, tremor and noise")
          ->check(seed())
          ->capture_default_str();
  auto* speed =
      command->add_option("--speed", options->plan.speed, "speed of the ball at its release [m/s]")
          ->check(number_from(4, 9))
          ->capture_default_str();
  auto* height = command
                     ->add_option("--height", options->plan.height,
                                  "height of the ball's centre when it is released with a level "
                                  "velocity [m]; default: an upright throw from 0.58 m")
                     ->check(number_from(scene::kLowestRelease, scene::kHighestRelease));
  auto* aim = command
                  ->add_option("--aim", options->aim_deg,
                               "direction of the throw to the right of the lane's axis [degrees]")
                  ->check(number_from(-10, 10))
                  ->capture_default_str();
  auto* duration =
      add_duration(*command, options->duration_s,
                   "duration of the trial [s]; default: 7 in the paper's room, more if the lane is "
                   "longer or the game counts balls");
  command->add_option("--scenario", options->scenario,
                      "name of a bundled scenario or a TOML file; default: the paper's room");
  auto* participant =
      command
          ->add_option("--participant", options->participant,
                       "make a whole session of the virtual participant with this seed instead of "
                       "one throw; default scenario: paper-experiment")
          ->check(seed())
          ->excludes(seeded, speed, height, aim, duration);
  command->add_option("--throws", options->throws, "throws of the participant with each version")
      ->check(whole_number_from(1, 1000))
      ->needs(participant)
      ->capture_default_str();
  command->add_option("--name", options->name, "name of the participant in the trial");
  command->add_option("--condition", options->condition, "name of the condition");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "The arm follows a minimum-jerk trajectory with tremor; a tracker with two receivers "
      "measures it with\nnoise. The same seed gives the same throw on every computer. The mounting "
      "of the tracker and the\nplace of the ball are the model's own, unless the scenario says "
      "otherwise.\n\nA virtual participant walks to the ball, touches the red button, throws, "
      "touches the blue button, and\nthrows. The trial has head, hand and buttons as a Fastrak and "
      "a 3D mouse would measure them. The\nsimulation runs at the same time, so that the "
      "participant can react to what it sees.\n\nExamples:\n  headpin synthesize -o session.lcmlog "
      "--participant 7\n"
      "  headpin synthesize -o trial.lcmlog --seed 7 --speed 6.5 --aim 1");
  command->callback([options] { synthesize(*options); });
}

}  // namespace headpin::apps
