#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/participants.h"
#include "apps/quantity.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/recordings/catalogue_csv.h"
#include "scene/people/arm_model.h"
#include "scene/people/coach.h"
#include "scene/people/throw.h"
#include "scene/play/ball_path.h"
#include "scene/record/log.h"
#include "scene/scenario/rules.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

constexpr auto kSpeeds = std::to_array<Unit>({{"m/s", 1.0}, {"mph", 0.44704}, {"km/h", 1.0 / 3.6}});
constexpr auto kRevs = std::to_array<Unit>({{"rpm", 1.0}});
constexpr auto kDegrees = std::to_array<Unit>({{"deg", 1.0}});
constexpr auto kLengths = std::to_array<Unit>({{"m", 1.0}, {"cm", 0.01}, {"ft", 0.3048}});

/// A throw as it is typed: "17.9mph", "416+-20".
struct TypedThrow {
  std::optional<std::string> speed, revs, rotation, tilt, board, angle, loft;
};

struct SynthesizeOptions {
  std::optional<std::string> output;
  std::string scenario, name, condition;
  std::optional<std::uint64_t> participant;
  int throws = 10;
  scene::ThrowPlan plan;
  TypedThrow typed;
  std::optional<double> duration_s;
  bool force = false, json = false;
};

/// The words of an option; nothing if it was not given.
std::optional<scene::Wanted> wanted_of(const char* option, const std::optional<std::string>& typed,
                                       std::span<const Unit> units, double least, double most) {
  if (!typed) return std::nullopt;
  return wanted(option, *typed, {units, least, most});
}

scene::CoachedThrow coached(const TypedThrow& typed) {
  constexpr double kSide = scene::kWidestAim_deg;
  const auto of = wanted_of;
  const auto or_0 = [](const std::optional<scene::Wanted>& wanted) {
    return wanted.value_or(scene::Wanted{});
  };
  return {.speed = of("--speed", typed.speed, kSpeeds, scene::kSlowestPlan, scene::kFastestPlan),
          .revs_per_min = of("--revs", typed.revs, kRevs, 0.0, scene::kMostRevs),
          .rotation_deg = or_0(of("--rotation", typed.rotation, kDegrees, -180.0, 180.0)),
          .tilt_deg = or_0(of("--tilt", typed.tilt, kDegrees, -90.0, 90.0)),
          .board = of("--board", typed.board, {}, 1.0, scene::kBoards),
          .angle_deg = of("--angle", typed.angle, kDegrees, -kSide, kSide),
          .loft = of("--loft", typed.loft, kLengths, 0.0, scene::kFurthestLoft)};
}

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

/// To show: without -0, and 180 for -180.
double whole_degrees(double degrees) {
  const double whole = std::round(degrees) + 0.0;
  return whole == -180.0 ? 180.0 : whole;
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

/// The motion of the throw; the scenario gets what the throw needs of it.
scene::ThrowMotion motion_of(const SynthesizeOptions& options, scene::Scenario& scenario) {
  try {
    auto [plan, spin] = scene::draw(coached(options.typed), options.plan, scenario);
    plan.duration_s = options.duration_s ? *options.duration_s : long_enough(plan, scenario);
    scene::ThrowMotion motion(plan, scenario.hand);
    scene::set_up(scenario, motion);
    if (spin) scenario.hand.spin = scene::fingers_spin(motion, scenario.hand, *spin);
    return motion;
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// What a recording, which has the motion alone, cannot hold.
void expect_motion_only(const SynthesizeOptions& options) {
  const auto expect_none = [](bool given, const char* what) {
    if (given) throw UsageError(fmt::format("{}; expected .lcmlog", what));
  };
  expect_none(options.typed.revs.has_value(),
              "--revs: a recording (.csv) cannot hold what fingers do");
  expect_none(!options.name.empty(), "--name: a recording (.csv) has no names");
  expect_none(!options.condition.empty(), "--condition: a recording (.csv) has no names");
}

void synthesize(const SynthesizeOptions& options) {
  if (options.participant) return synthesize_session(options);
  const bool csv = options.output->ends_with(".csv");
  if (csv) expect_motion_only(options);
  scene::Scenario scenario =
      options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
  const scene::ThrowMotion motion = motion_of(options, scenario);
  scene::check(scenario, options.scenario.empty() ? "the paper's room" : options.scenario);

  watch_stop_signals();
  const std::uint64_t seed = options.plan.seed;
  const std::size_t samples =
      csv ? write_csv(options, motion, seed) : write_trial(options, motion, scenario, seed);
  const scene::Delivered ball = scene::delivered_by(motion, scenario);
  const double speed = scenario.release.speed * motion.ball_speed();
  if (options.json) {
    print_json({{"output", *options.output},
                {"seed", seed},
                {"samples", samples},
                {"duration_s", seconds(motion.duration())},
                {"grab_s", seconds(motion.grab())},
                {"release_s", seconds(motion.release())},
                {"planned_speed_mps", speed},
                {"level_speed_mps", ball.speed},
                {"board", ball.board},
                {"launch_angle_deg", ball.angle_deg},
                {"revs_per_min", ball.revs_per_min},
                {"axis_rotation_deg", ball.rotation_deg},
                {"axis_tilt_deg", ball.tilt_deg}});
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
      seconds(motion.duration()), seconds(motion.grab()), seconds(motion.release()), speed);
  if (csv) return;
  std::cout << fmt::format(
      "  planned way        board {:.1f}, {:.1f} degrees to the {}\n"
      "  planned spin       {:.0f} rpm, axis rotation {:.0f}, tilt {:.0f} degrees\n",
      ball.board, std::abs(ball.angle_deg), ball.angle_deg < 0.0 ? "left" : "right",
      ball.revs_per_min, whole_degrees(ball.rotation_deg), whole_degrees(ball.tilt_deg));
}

/// The options that say how the ball leaves the hand.
std::vector<CLI::Option*> add_throw(CLI::App& command, SynthesizeOptions& options) {
  TypedThrow& coached = options.typed;
  auto* speed = command.add_option("--speed", coached.speed,
                                   "speed of the ball at its release, 4 to 9 m/s; default: 6.5");
  auto* angle =
      command.add_option("--angle,--aim", coached.angle,
                         "direction of the ball to the right of the lane's axis, up to 10deg");
  auto* board = command.add_option(
      "--board", coached.board,
      "board of the ball at its release: 1 is at the right gutter, 20 in the middle");
  auto* revs = command.add_option(
      "--revs", coached.revs,
      "revolutions per minute of the ball, up to 1000rpm; default: those of the hand");
  auto* rotation = command
                       .add_option("--rotation", coached.rotation,
                                   "axis rotation: 0 rolls ahead, 90deg hooks to the left")
                       ->needs(revs);
  auto* tilt =
      command.add_option("--tilt", coached.tilt, "axis tilt: 90deg spins like a top")->needs(revs);
  auto* loft =
      command.add_option("--loft", coached.loft,
                         "how far beyond the foul line the ball first touches the lane, up "
                         "to 3m; default: an upright throw from 0.58 m");
  // A thrower who misses by a centimetre does not go below this one.
  constexpr double kLowestThrow = 0.12;
  auto* height = command
                     .add_option("--height", options.plan.height,
                                 "height of the ball's centre when it is released with a level "
                                 "velocity [m], in place of the loft")
                     ->check(number_from(kLowestThrow, scene::kHighestRelease))
                     ->excludes(loft);
  return {speed, angle, board, revs, rotation, tilt, loft, height};
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
  const std::vector<CLI::Option*> of_throw = add_throw(*command, *options);
  auto* duration =
      command
          ->add_option("--duration", options->duration_s,
                       "duration of the trial [s], at least that of the throw (about 5); default: "
                       "7 in the paper's room, more if the lane is longer or the game counts balls")
          ->check(number_from(1.0, 600.0));
  command->add_option("--scenario", options->scenario,
                      "name of a bundled scenario or a TOML file; default: the paper's room");
  auto* participant =
      command
          ->add_option("--participant", options->participant,
                       "make a whole session of the virtual participant with this seed instead of "
                       "one throw; default scenario: paper-experiment")
          ->check(seed())
          ->excludes(seeded, duration);
  for (CLI::Option* option : of_throw) participant->excludes(option);
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
      "otherwise.\n\nSpeed, angle, board, revs, rotation, tilt and loft may have a unit and a "
      "standard deviation: 17.9mph,\n416+-20, 0.3m+-5cm. Without one, speed and angle have the "
      "errors of the thrower: 1 % and 0.3 degrees.\n\nA virtual participant walks to the ball, "
      "touches the red button, throws, "
      "touches the blue button, and\nthrows. The trial has head, hand and buttons as a Fastrak and "
      "a 3D mouse would measure them. The\nsimulation runs at the same time, so that the "
      "participant can react to what it sees.\n\nExamples:\n  headpin synthesize -o session.lcmlog "
      "--participant 7\n"
      "  headpin synthesize -o trial.lcmlog --seed 7 --speed 6.5 --angle 1\n"
      "  headpin synthesize -o hook.lcmlog --scenario house-oil --speed 17.9mph --revs 416+-20 "
      "--rotation 45 \\\n    --tilt 10 --board 28 --angle 1.8 --loft 0.3m");
  command->callback([options] { synthesize(*options); });
}

}  // namespace headpin::apps
