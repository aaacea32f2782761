#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "apps/wrap.h"
#include "base/output_file.h"
#include "render/image.h"
#include "render/png.h"
#include "scene/looks/scenario_picture.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/seen_mesh.h"
#include "scene/stage/stage.h"
#include "scene/watch/totals.h"

namespace headpin::apps {
namespace {

struct ScenarioOptions {
  std::string action, scenario, other, from, gl;
  std::optional<std::string> output;
  bool gl_given = false, force = false, json = false;
};

/// Measures of a scenario.
struct Measures {
  std::string name;  ///< in the scenario itself
  std::size_t skittles = 0;
  std::size_t primitives = 0;  ///< of a skittle
  double skittle_m = 0.0, skittle_kg = 0.0;
  double centre_m = 0.0;                ///< of a skittle's mass, above its base
  Vec3 inertia = Vec3::Zero();          ///< of a skittle about its centre of mass, z up [kg m^2]
  double ball_m = 0.0, ball_kg = 0.0;   ///< across
  Vec3 ball_inertia = Vec3::Zero();     ///< principal moments [kg m^2]
  double lane_m = 0.0;                  ///< foul line to head pin
  std::vector<std::string> not_drawn;   ///< of its mesh files
  std::vector<std::string> not_convex;  ///< mesh files in whose place convex pieces collide
};

/// @throws std::invalid_argument  if its values are not possible
Measures measure(const std::string& name_or_file) {
  const scene::Scenario s = scene::load_scenario(name_or_file);
  const scene::Stage stage = scene::make_stage(s);
  const scene::SkittleBody skittle = scene::skittle_body(s);
  return {.name = s.name,
          .skittles = stage.skittles.size(),
          .primitives = stage.skittle.shape->parts.size(),
          .skittle_m = s.skittle.height,
          .skittle_kg = s.skittle.mass,
          .centre_m = skittle.centre_height,
          .inertia = skittle.body.inertia.diagonal(),
          .ball_m = 2.0 * s.ball.radius,
          .ball_kg = s.ball.mass,
          .ball_inertia = engine::principal_inertia(scene::ball_body(s).inertia).moments,
          .lane_m = s.lane.head_pin,
          .not_drawn = scene::not_drawn(s),
          .not_convex = scene::not_convex(s)};
}

std::string in_words(const Measures& m) {
  return fmt::format(
      "{} skittles of {} primitive{} ({:.3f} m, {:.3f} kg), ball {:.3f} m across ({:.2f} kg), "
      "{:.2f} m from the foul line",
      m.skittles, m.primitives, m.primitives == 1 ? "" : "s", m.skittle_m, m.skittle_kg, m.ball_m,
      m.ball_kg, m.lane_m);
}

/// How the mass of skittle and ball lies.
std::string masses_in_words(const Measures& m) {
  const Vec3 &i = m.inertia, &b = m.ball_inertia;
  const std::string ball = b.x() == b.y() && b.x() == b.z()
                               ? fmt::format("{:.3g}", b.x())
                               : fmt::format("{:.4g}, {:.4g}, {:.4g}", b.x(), b.y(), b.z());
  return fmt::format(
      "skittle: centre of mass {:.4f} m up, moments of inertia {:.3g}, {:.3g}, {:.3g} kg m2 about x, y, z; "
      "ball: {} kg m2",
      m.centre_m, i.x(), i.y(), i.z(), ball);
}

nlohmann::ordered_json in_json(const std::string& file, const Measures& m) {
  return {{"scenario", m.name},
          {"file", file},
          {"skittles", m.skittles},
          {"primitives", m.primitives},
          {"height_m", m.skittle_m},
          {"mass_kg", m.skittle_kg},
          {"centre_of_mass_m", m.centre_m},
          {"inertia_kgm2", {m.inertia.x(), m.inertia.y(), m.inertia.z()}},
          {"ball_diameter_m", m.ball_m},
          {"ball_mass_kg", m.ball_kg},
          {"ball_inertia_kgm2", {m.ball_inertia.x(), m.ball_inertia.y(), m.ball_inertia.z()}},
          {"lane_m", m.lane_m},
          {"not_drawn", m.not_drawn},
          {"not_convex", m.not_convex}};
}

void list(bool json) {
  const std::vector<std::string> names = scene::scenario_names();
  if (names.empty()) {
    throw std::runtime_error("no scenarios in share/headpin/scenarios beside the program");
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& name : names) {
    const Measures m = measure(name);
    if (json) {
      all.push_back(in_json(scene::scenario_path(name), m));
    } else {
      fmt::print("{:<20}{}\n", name, in_words(m));
    }
  }
  if (json) print_json({{"scenarios", all}});
}

/// A scenario file of one's own: all keys of another scenario, with their meanings.
void make_new(const ScenarioOptions& options) {
  scene::Scenario scenario = scene::load_scenario(options.from);
  scenario.name = std::filesystem::path(*options.output).stem().string();
  const std::string text = scene::to_toml(scenario);
  base::write_text({*options.output,
                    {.overwrite = options.force, .inputs = {scene::scenario_path(options.from)}}},
                   text);
  fmt::print("{}: all keys of {}\n", *options.output, options.from);
}

void tell_differences(const ScenarioOptions& options) {
  const std::vector<scene::KeyDifference> all = scene::differences(
      scene::load_scenario(options.scenario), scene::load_scenario(options.other));
  if (options.json) {
    return print_json({{"a", options.scenario},
                       {"b", options.other},
                       {"scenario_differences", scene::to_json(all)}});
  }
  if (all.empty()) fmt::print("the same values\n");
  for (const scene::KeyDifference& one : all) {
    fmt::print("{:<28}{}  ->  {}\n", one.key, in_a_line(one.a), in_a_line(one.b));
  }
}

void draw(const ScenarioOptions& options) {
  const scene::Scenario scenario = scene::load_scenario(options.scenario);
  const render::Image picture = scene::picture_of(scenario, options.gl);
  const std::vector<std::uint8_t> png = render::encode_png(picture);
  base::OutputFile file(*options.output, {.overwrite = options.force,
                                          .inputs = {scene::scenario_path(options.scenario)}});
  file.write(png.data(), png.size());
  file.commit();
  fmt::print("{}: {} from above and from the side; what the left and the right eye see\n",
             *options.output, printable(scenario.name));
}

void check(const ScenarioOptions& options) {
  const Measures m = measure(options.scenario);
  if (options.json) return print_json(in_json(scene::scenario_path(options.scenario), m));
  fmt::print("{}: {}\n{}\n", printable(m.name), in_words(m), masses_in_words(m));
  for (const std::vector<std::string>* notes : {&m.not_convex, &m.not_drawn}) {
    for (const std::string& one : *notes) fmt::print("{}\n", printable(one));
  }
}

/// The parts of the command line that an action needs; it takes no others.
struct Action {
  const char* name;
  bool scenario, other, from, output, json, gl;
  const char* usage;
};
constexpr std::array<Action, 6> kActions = {{
    {"list", false, false, false, false, true, false, "scenario list [--json]"},
    {"show", true, false, false, false, false, false, "scenario show SCENARIO"},
    {"check", true, false, false, false, true, false, "scenario check SCENARIO [--json]"},
    {"new", false, false, true, true, false, false, "scenario new --from SCENARIO -o FILE.toml"},
    {"diff", true, true, false, false, true, false, "scenario diff SCENARIO OTHER [--json]"},
    {"draw", true, false, false, true, false, true, "scenario draw SCENARIO -o FILE.png"},
}};

void run_action(const ScenarioOptions& options) {
  const Action& action =
      *std::ranges::find_if(kActions, [&](const Action& a) { return options.action == a.name; });
  const bool fits = action.scenario != options.scenario.empty() &&
                    action.other != options.other.empty() && action.from != options.from.empty() &&
                    action.output == options.output.has_value() &&
                    (action.output || !options.force) && (action.json || !options.json) &&
                    (action.gl || !options.gl_given);
  if (options.json && !action.json) {
    throw UsageError(fmt::format("--json: scenario {} takes none; expected headpin {}", action.name,
                                 action.usage));
  }
  if (!fits) {
    throw UsageError(fmt::format("scenario {}: expected headpin {}", action.name, action.usage));
  }
  if (options.action == "list") return list(options.json);
  if (options.action == "show") {
    fmt::print("{}", scene::to_toml(scene::load_scenario(options.scenario)));
    return;
  }
  if (options.action == "check") return check(options);
  if (options.action == "diff") return tell_differences(options);
  const std::string ending = options.action == "new" ? ".toml" : ".png";
  if (std::filesystem::path(*options.output).extension() != ending) {
    throw UsageError(fmt::format("--output: expected a name that ends in {}, found {}", ending,
                                 *options.output));
  }
  return options.action == "new" ? make_new(options) : draw(options);
}

}  // namespace

void add_scenario(CLI::App& app) {
  auto options = std::make_shared<ScenarioOptions>();
  CLI::App* command = app.add_subcommand(
      "scenario", "List, show, check, make, compare and draw scenarios: rooms, skittles, rules");
  command
      ->add_option("ACTION", options->action,
                   "list: list the bundled scenarios; show: print all keys of a scenario with "
                   "their meanings; check: check the values of a scenario; new: write all keys of "
                   "a scenario to a file of your own; diff: list the keys whose values differ; "
                   "draw: draw the room from above, from the side, and as both eyes see it")
      ->required()
      ->check(one_of({"list", "show", "check", "new", "diff", "draw"}));
  command->add_option("SCENARIO", options->scenario, "name of a bundled scenario or a TOML file");
  command->add_option("OTHER", options->other, "with diff: the scenario to compare it with");
  command->add_option("--from", options->from,
                      "with new: name of a bundled scenario or a TOML file to start from");
  add_output(*command, "-o,--output", options->output,
             "file to write: with new, a scenario (.toml); with draw, a picture (.png)",
             {".toml", ".png"});
  add_gl(*command, options->gl)->each([options](const std::string&) { options->gl_given = true; });
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Error messages have the file, the line and the key.\n\n"
      "Examples:\n  headpin scenario list\n  headpin scenario new --from german-ninepins -o "
      "own.toml\n"
      "  headpin scenario check own.toml\n  headpin scenario diff german-ninepins own.toml\n"
      "  headpin scenario draw own.toml -o own.png");
  command->callback([options] { run_action(*options); });
}

}  // namespace headpin::apps
