#include <algorithm>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/catalogue_csv.h"
#include "devices/log.h"
#include "files/output_file.h"
#include "scene/arm_model.h"
#include "scene/throw.h"

namespace headpin::apps {
namespace {

struct Options {
  std::optional<std::string> output;
  std::string scenario, participant, condition;
  scene::ThrowPlan plan;
  double aim_deg = 0.0;
  std::optional<double> duration_s;
  bool force = false, json = false;
};

/// Time for the ball to come to the skittles and for them to fall [s]: that of a plan for the
/// paper's room, and what a longer lane takes a ball that rolls at two thirds of its first speed.
double long_enough(const scene::ThrowPlan& plan, const scene::Scenario& scenario) {
  const double further = std::max(0.0, scenario.lane.head_pin - scene::Scenario{}.lane.head_pin);
  return plan.duration_s + further / (0.65 * plan.speed);
}

/// As an event log, with what a tracker and a trigger say of the throw.
/// @return  how many samples
std::size_t write_trial(const Options& options, const scene::ThrowMotion& motion,
                        const scene::Scenario& scenario, std::uint64_t seed) {
  devices::TrialHeader header;
  header.participant = options.participant;
  header.condition = options.condition;
  header.seed = seed;
  header.scenario = scene::to_toml(scenario);
  const std::vector<devices::Sample> samples = scene::sense(motion, scenario.rig, seed);
  devices::Recorder recorder(*options.output, header,
                             {.overwrite = options.force, .inputs = {options.scenario}});
  devices::write(recorder, samples, {});
  check_stop();
  recorder.close();
  return samples.size();
}

/// As the motion catalogue has throws: head and both hands, no trigger, in centimetres.
/// @return  how many samples
std::size_t write_csv(const Options& options, const scene::ThrowMotion& motion,
                      std::uint64_t seed) {
  const devices::MotionRecording recording = scene::record(motion, seed);
  const std::string text = devices::to_catalogue_csv(recording, 0.01);
  files::OutputFile file(*options.output,
                         {.overwrite = options.force, .inputs = {options.scenario}});
  file.write(text.data(), text.size());
  check_stop();
  file.commit();
  return recording.times.size();
}

void run(const Options& options) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  scene::ThrowPlan plan = options.plan;
  plan.aim = options.aim_deg * kDegree;
  scene::Scenario scenario =
      options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
  plan.duration_s = options.duration_s.value_or(long_enough(plan, scenario));
  const scene::ThrowMotion motion = [&] {
    try {
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
                {"release_speed_mps", motion.ball_speed()}});
    return;
  }
  std::cout << fmt::format(
      "{}\n"
      "  samples            {} of {}\n"
      "  duration           {:.3f} s\n"
      "  grab               {:.3f} s\n"
      "  release            {:.3f} s\n"
      "  ball at release    {:.2f} m/s\n",
      *options.output, samples, csv ? "head and both hands" : "head, hand and trigger",
      seconds(motion.duration()), seconds(motion.grab()), seconds(motion.release()),
      motion.ball_speed());
}

}  // namespace

void add_synthesize(CLI::App& app) {
  CLI::App* command = app.add_subcommand("synthesize", "Make a trial by a model of the arm");
  const auto options = std::make_shared<Options>();
  add_output(
      *command, "-o,--output", options->output,
      "trial to write (.lcmlog), or a recording as `import` reads it (.csv); - is standard output")
      ->required();
  command->add_option("--seed", options->plan.seed, "of swing, tremor and noise")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--speed", options->plan.speed, "of the ball at its release [m/s]")
      ->check(number_from(4, 9))
      ->capture_default_str();
  command
      ->add_option(
          "--height", options->plan.height,
          "of the ball's centre as it is laid down, level [m]; a stand-up throw from 0.58 m "
          "when not given")
      ->check(number_from(scene::kLowestRelease, scene::kHighestRelease));
  command->add_option("--aim", options->aim_deg, "to the right of the lane [degrees]")
      ->check(number_from(-10, 10))
      ->capture_default_str();
  add_duration(*command, options->duration_s,
               "of the trial [s]; 7 in the paper's room, more when the lane is longer");
  command->add_option("--scenario", options->scenario,
                      "its name, or a TOML file; the paper's room when not given");
  command->add_option("--participant", options->participant, "who is said to have thrown");
  command->add_option("--condition", options->condition, "name of the condition");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "A throw of an arm that moves with the least jerk and trembles, seen by a tracker with two\n"
      "receivers and its noise. The same seed gives the same throw on every machine. How the "
      "tracker\n"
      "is mounted and where the ball stands are the model's own unless the scenario says so.\n\n"
      "Example:\n  headpin synthesize -o trial.lcmlog --seed 7 --speed 6.5 --aim 1");
  command->callback([options] { run(*options); });
}

}  // namespace headpin::apps
