#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/chart.h"
#include "apps/command.h"
#include "apps/options.h"
#include "apps/recorded_world.h"
#include "apps/stop.h"
#include "devices/log.h"
#include "files/output_file.h"
#include "scene/events.h"

namespace headpin::apps {

namespace {

struct PlotOptions {
  std::string trial;
  std::optional<std::string> output;
  bool force = false;
};

constexpr const char* kBall = "#1f6fb4";
constexpr const char* kSkittle = "#c9a227";
constexpr const char* kAll = "#444444";

/// One value of one body over all ticks.
template <typename Value>
std::vector<double> over_time(const devices::Trial& trial, std::size_t body, Value value) {
  std::vector<double> values;
  for (const devices::TickState& state : trial.states) {
    values.push_back(body < state.bodies.size() ? value(state.bodies[body])
                                                : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

/// A curve a body; the first of a role names it in the legend.
template <typename Value>
std::vector<Curve> curves(const devices::Trial& trial, const scene::Stage& stage, Value value) {
  std::vector<Curve> all;
  const auto add = [&](const std::vector<engine::BodyId>& bodies, const char* legend,
                       const char* colour) {
    for (const engine::BodyId body : bodies) {
      all.push_back({body == bodies.front() ? legend : "", colour, over_time(trial, body, value)});
    }
  };
  add(stage.skittles, "skittles", kSkittle);
  add(stage.balls, "ball", kBall);
  return all;
}

/// Of balls and skittles, height from the lane: all of it, and what is of motion.
Panel energy(const devices::Trial& trial, RecordedWorld& world) {
  Curve total{"all", kAll, {}}, motion{"of motion", kBall, {}};
  for (const devices::TickState& state : trial.states) {
    const RecordedWorld::Energy energy = world.energy(state);
    total.values.push_back(energy.all);
    motion.values.push_back(energy.all - energy.height);
  }
  return {"energy [J]", {total, motion}};
}

/// Named where there is one of a kind; of falls and touches there are many.
std::vector<Mark> marks(const devices::Trial& trial) {
  std::vector<Mark> all;
  for (const devices::Event& event : trial.events) {
    if (event.tick < 0 || event.kind == scene::kind::touch || event.kind == scene::kind::ledger)
      continue;
    all.push_back({seconds(event.time), event.kind == scene::kind::skittle_down ? "" : event.kind});
  }
  return all;
}

Chart chart(const std::string& path, const devices::Trial& trial, RecordedWorld& world) {
  Chart chart{path, {}, {}, marks(trial)};
  Curve contacts{"", kAll, {}};
  for (const devices::TickState& state : trial.states) {
    chart.times.push_back(seconds(state.time));
    contacts.values.push_back(state.contacts);
  }
  using Body = devices::BodyState;
  chart.panels = {
      {"speed [m/s]", curves(trial, world.stage(), [](const Body& b) { return b.V_WB.v.norm(); })},
      {"height of the centre of mass [m]",
       curves(trial, world.stage(), [](const Body& b) { return b.X_WB.p.z(); })},
      energy(trial, world),
      {"contact points", {contacts}}};
  return chart;
}

void plot_trial(const PlotOptions& options) {
  const devices::Trial trial = devices::read_trial(options.trial);
  if (trial.states.empty()) {
    throw std::runtime_error(options.trial +
                             ": expected states to plot, found none; `headpin replay " +
                             options.trial + " -o OUT.lcmlog` writes them");
  }
  RecordedWorld world(scene::parse_scenario(trial.header.scenario, options.trial + " (scenario)"));
  const std::string svg = to_svg(chart(options.trial, trial, world));
  watch_stop_signals();
  files::OutputFile file(
      *options.output,
      {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
  file.write(svg.data(), svg.size());
  check_stop();
  file.commit();
}

}  // namespace

void add_plot(CLI::App& app) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command = app.add_subcommand(
      "plot", "Draw a replayed trial over time: speeds, heights, energy, contacts");
  command->add_option("TRIAL", options->trial, "a trial with states (.lcmlog)")->required();
  add_output(*command, "-o,--output", options->output,
             "picture to write (.svg); - is standard output")
      ->required();
  add_force(*command, options->force);
  command->footer(
      "Any browser shows SVG; `rsvg-convert game.svg -o game.png` makes a PNG of it.\n\n"
      "Example:\n  headpin plot game.lcmlog -o game.svg");
  command->callback([options] { plot_trial(*options); });
}

}  // namespace headpin::apps
