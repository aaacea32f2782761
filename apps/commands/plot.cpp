#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/chart.h"
#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/plot_file.h"
#include "apps/recorded_world.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "scene/record/events.h"
#include "scene/record/file.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {

namespace {

struct PlotOptions {
  std::string trial;
  std::optional<std::string> output;
  bool force = false, json = false;
};

constexpr const char* kBall = "#1f6fb4";
constexpr const char* kSkittle = "#c9a227";
constexpr const char* kAll = "#444444";

/// The values of several curves at ticks, reduced to the number of points that a picture can show.
/// Of each group of ticks, a curve keeps its smallest and its largest value, in their order.
class Thinned {
 public:
  Thinned(std::size_t curves, std::int64_t ticks)
      : values(curves),
        group_(ticks <= kMostPoints ? 1 : (2 * ticks + kMostPoints - 1) / kMostPoints),
        spans_(curves) {}

  /// @param row  one value per curve; NaN if there is none
  void add(double time, const std::vector<double>& row) {
    if (in_group_ == 0) first_ = time;
    for (std::size_t i = 0; i < row.size(); ++i) spans_[i].take(row[i]);
    last_ = time;
    if (++in_group_ == group_) close_group();
  }
  void close() {
    if (in_group_ > 0) close_group();
  }

  std::vector<double> times;
  std::vector<std::vector<double>> values;  ///< by curve

 private:
  static constexpr std::int64_t kMostPoints = 4000;  // of a picture 870 pixels wide
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  /// The values of one curve within a group.
  struct Span {
    double earlier = kNone, later = kNone;  // one is the smallest, the other the largest
    void take(double value) {
      if (std::isnan(value)) return;
      if (std::isnan(earlier)) {
        earlier = later = value;
      } else if (value < std::min(earlier, later) || value > std::max(earlier, later)) {
        const bool low = value < std::min(earlier, later);
        earlier = low ? std::max(earlier, later) : std::min(earlier, later);
        later = value;
      }
    }
  };

  void close_group() {
    times.push_back(first_);
    if (group_ > 1) times.push_back(last_);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i].push_back(spans_[i].earlier);
      if (group_ > 1) values[i].push_back(spans_[i].later);
      spans_[i] = {};
    }
    in_group_ = 0;
  }

  std::int64_t group_, in_group_ = 0;
  std::vector<Span> spans_;
  double first_ = 0.0, last_ = 0.0;
};

/// Skittles, then balls; the first of a role names it in the legend.
struct DrawnBody {
  engine::BodyId id;
  const char *legend, *colour;
};

std::vector<DrawnBody> drawn_bodies(const scene::Stage& stage) {
  std::vector<DrawnBody> all;
  const auto add = [&](const std::vector<engine::BodyId>& bodies, const char* legend,
                       const char* colour) {
    for (const engine::BodyId body : bodies) {
      all.push_back({body, body == bodies.front() ? legend : "", colour});
    }
  };
  add(stage.skittles, "skittles", kSkittle);
  add(stage.balls, "ball", kBall);
  return all;
}

/// One value per curve: speeds, heights, energy (total and kinetic), contact points.
void row_of(const scene::TickState& state, const std::vector<DrawnBody>& bodies,
            RecordedWorld& world, std::vector<double>& row) {
  row.clear();
  const auto each = [&](auto value) {
    for (const DrawnBody& body : bodies) {
      row.push_back(body.id < state.bodies.size() ? value(state.bodies[body.id])
                                                  : std::numeric_limits<double>::quiet_NaN());
    }
  };
  each([](const scene::BodyState& b) { return b.V_WB.v.norm(); });
  each([](const scene::BodyState& b) { return b.X_WB.p.z(); });
  const RecordedWorld::Energy energy = world.energy(state);
  row.insert(row.end(), {energy.all, energy.all - energy.height});
  row.push_back(state.contacts);
}

/// Marks of events. Events of which there are many, such as falls and touches, have no label.
std::vector<Mark> marks(const scene::TrialSummary& trial) {
  std::vector<Mark> all;
  for (const scene::Event& event : trial.events) {
    if (event.tick < 0 || event.kind == scene::kind::touch || event.kind == scene::kind::ledger ||
        event.kind == scene::kind::game_hash)
      continue;
    all.push_back({seconds(event.time), event.kind == scene::kind::skittle_down ? "" : event.kind});
  }
  return all;
}

Chart chart(const std::string& path, const scene::TrialFile& file, RecordedWorld& world) {
  const std::vector<DrawnBody> bodies = drawn_bodies(world.stage());
  Thinned ticks(2 * bodies.size() + 3, file.summary().state_count);
  std::vector<double> row;
  scene::TrialItems items(file);
  while (const std::optional<scene::TickState> state = items.next_state()) {
    row_of(*state, bodies, world, row);
    ticks.add(seconds(state->time), row);
  }
  ticks.close();

  auto values = ticks.values.begin();
  const auto of_bodies = [&] {
    std::vector<Curve> curves;
    curves.reserve(bodies.size());
    for (const DrawnBody& body : bodies) {
      curves.push_back({body.legend, body.colour, std::move(*values++)});
    }
    return curves;
  };
  Chart chart{path, std::move(ticks.times), {}, marks(file.summary())};
  chart.panels.push_back({"speed [m/s]", of_bodies()});
  chart.panels.push_back({"height of the centre of mass [m]", of_bodies()});
  // Energy of balls and skittles, with height from the lane.
  Curve all{"all", kAll, std::move(*values++)}, motion{"of motion", kBall, std::move(*values++)};
  chart.panels.push_back({"energy [J]", {std::move(all), std::move(motion)}});
  chart.panels.push_back({"contact points", {{"", kAll, std::move(*values)}}});
  return chart;
}

void plot_trial(const PlotOptions& options) {
  if (options.json && *options.output == "-") {
    throw UsageError("--json and -o - both write to standard output; expected one of them");
  }
  require_plot_library(*options.output);
  const scene::TrialFile file(options.trial);
  file.require_trial(devices::kLongestGap);
  const scene::TrialSummary& trial = file.summary();
  say_what_is_missing("plot", options.trial, trial);
  if (trial.state_count == 0) {
    throw std::runtime_error(options.trial +
                             ": expected states to plot, found none; `headpin replay " +
                             options.trial + " -o OUT.lcmlog` writes them");
  }
  RecordedWorld world(scene::scenario_of_trial(trial.header.scenario, options.trial));
  const std::string plot = plot_file(to_svg(chart(options.trial, file, world)), *options.output);
  watch_stop_signals();
  base::OutputFile out(
      *options.output,
      {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
  out.write(plot.data(), plot.size());
  check_stop();
  out.commit();
  if (options.json) {
    print_json(
        {{"trial", options.trial}, {"output", *options.output}, {"ticks", trial.state_count}});
  }
}

}  // namespace

void add_plot(CLI::App& app) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command = app.add_subcommand(
      "plot", "Plot a replayed trial over time: speeds, heights, energy, contacts");
  command->add_option("TRIAL", options->trial, "a trial with states (.lcmlog); - is standard input")
      ->required();
  add_output(*command, "-o,--output", options->output,
             "picture to write (.svg, .png or .pdf); - is standard output, as SVG",
             {".svg", ".png", ".pdf"})
      ->required();
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Any browser shows SVG. PNG has twice its width and height in pixels. PDF has one page, for "
      "a "
      "paper.\nPNG and PDF are drawn by librsvg (Debian: librsvg2-2). Equal trials give equal "
      "files.\n\n"
      "Example:\n  headpin plot game.lcmlog -o game.pdf");
  command->callback([options] { plot_trial(*options); });
}

}  // namespace headpin::apps
