#include "apps/live.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/live_eyes.h"
#include "apps/live_report.h"
#include "apps/options.h"
#include "apps/priority.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/lcm/link.h"
#include "devices/live/source.h"
#include "scene/live/lcm_views.h"
#include "scene/live/monitor.h"
#include "scene/live/played.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "scene/record/publisher.h"
#include "scene/record/source.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/drawn_by.h"
#include "scene/watch/totals.h"

namespace headpin::apps {

namespace {

/// Throws if no sample arrived: such a session has failed.
void require_samples(const scene::LiveState& state) {
  if (state.samples > 0) return;
  std::string from;
  for (const auto& [name, status] : state.sources) from += (from.empty() ? "" : " or ") + name;
  throw std::runtime_error(
      fmt::format("no sample arrived in {:.1f} s from {}", seconds(state.now), from));
}

/// Participant and condition of the session: from the options, otherwise from the played trial.
scene::TrialHeader whose(const LiveOptions& options, std::span<const scene::PlayedTrial> played) {
  scene::TrialHeader header = scene::header_from(played);
  if (options.participant) header.participant = *options.participant;
  if (options.condition_name) header.condition = *options.condition_name;
  return header;
}

/// The scenario from the options, otherwise that of a played log, otherwise the paper's room.
scene::Scenario chosen(const LiveOptions& options, std::span<const scene::PlayedTrial> played) {
  scene::Scenario room;
  room.look.samples = 1;  // so that a slow machine draws in time what does not say it
  if (!options.given && options.scenario.empty()) {
    return played.empty() ? room : scene::scenario_of(played[0]);
  }
  const scene::Scenario scenario =
      options.given ? *options.given : scene::load_scenario(options.scenario, room);
  for (const scene::PlayedTrial& trial : played) {
    if (!scene::is_of_another(trial, scenario)) continue;
    say("headpin live: {} was recorded in another scenario than this session's; without "
        "--scenario, the session uses the recorded one\n",
        printable(trial.path));
  }
  return scenario;
}

/// The same, in the condition of the options.
scene::Scenario scenario_of(const LiveOptions& options,
                            std::span<const scene::PlayedTrial> played) {
  scene::Scenario scenario = chosen(options, played);
  if (options.samples) scenario.look.samples = *options.samples;
  apply_condition(options.condition, scenario);
  return scenario;
}

std::vector<devices::OpenSource> open_sources(const LiveOptions& options,
                                              const std::shared_ptr<scene::RealTime>& pace) {
  try {
    devices::SourceOptions how;
    how.clock = [pace] { return pace->now(); };
    how.fastrak.baud = options.baud;
    for (const std::string& hemisphere : options.hemispheres) {
      devices::read_zenith(hemisphere, how.fastrak.zenith);
    }
    std::vector<devices::OpenSource> sources;
    for (const std::string& name : options.sources) {
      sources.push_back(scene::open_source(name, pace->clocks(), how));
    }
    return sources;
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// What the session publishes over.
struct Links {
  std::unique_ptr<devices::LcmLink> views, trial;
};

Links open_links(const LiveOptions& options, const std::optional<devices::LcmUrl>& lcm) {
  Links links;
  if (!lcm || lcm->log()) return links;  // a file has no listeners
  links.views = std::make_unique<devices::LcmLink>(*lcm);
  if (options.no_trial) return links;
  links.trial = std::make_unique<devices::LcmLink>(*lcm, scene::kSessionPrefix);
  return links;
}

/// Begins the recording. This is the last step: programs that wait for its file may then send.
std::unique_ptr<scene::TrialSink> open_recording(const LiveOptions& options,
                                                 const scene::LiveSources& sources,
                                                 const scene::TrialHeader& header) {
  std::vector<std::filesystem::path> inputs = {options.scenario};
  for (const devices::OpenSource& source : sources.each()) inputs.push_back(source.recording);
  const Time epoch =
      std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
  base::OutputFile file(
      *options.record,
      {.overwrite = options.force, .live = true, .standard_output = true, .inputs = inputs});
  return std::make_unique<scene::Recorder>(
      std::move(file), header, scene::Recorder::Options{.states = options.states, .epoch = epoch});
}

void conclude(const LiveOptions& options, const scene::Session& session,
              const scene::LiveState& state, const scene::Totals& totals) {
  print_line(state, totals);
  print_stages(state);
  require_samples(state);
  if (const std::string why = totals.why_nothing_fell(); !why.empty()) {
    say("{:11}no skittle fell: {}\n", "", printable(why));
  }
  if (options.json) print_json(summary(session, state, totals, options));
}

}  // namespace

void go_live(const LiveOptions& options) {
  if (options.sources.empty()) {
    throw UsageError("no source of samples: expected --lcm URL, --fastrak TTY or a SOURCE");
  }
  watch_stop_signals();
  std::optional<devices::LcmUrl> lcm;
  if (options.use_lcm) lcm = lcm_url("--lcm", options.lcm, devices::LcmUse::reading);
  const auto pace = std::make_shared<scene::RealTime>();
  scene::LiveSources sources(open_sources(options, pace));
  const std::vector<scene::PlayedTrial> played = scene::played_by(sources);
  for (const scene::PlayedTrial& one : played) say_what_is_missing("live", one.path, one.summary);
  scene::Session session = scene::make_session(scenario_of(options, played));
  const scene::TrialHeader header = scene::header_of(whose(options, played), session);
  const Links links = open_links(options, lcm);
  scene::TrialOutputs trial;
  if (links.trial) trial.publish(std::make_unique<scene::TrialPublisher>(*links.trial, header));

  // Without real-time scheduling, ticks have priority only if the drawing process gives way.
  const auto eyes = open_live_eyes(*session.stage, links.views ? options.eyes : std::string("none"),
                                   options.lcm, options.gl, to_be_had() != Priority::real_time);
  eyes->measure_by(*pace);
  pace->begin(session.scenario().rates.physics_hz);
  go_first();  // and the readers
  sources.start();
  if (options.record) trial.record(open_recording(options, sources, header));
  trial.write(scene::drawn_by_event(eyes->drawn_by()));

  scene::Totals totals;
  scene::LiveMonitor monitor(sources, *pace, *eyes, trial);
  Reporter reporter(monitor, totals);
  std::vector<scene::Observer*> observers = {&totals, &trial, eyes.get()};
  std::optional<scene::LcmScene> view;
  if (links.views) observers.push_back(&view.emplace(*links.views));
  observers.insert(observers.end(), {&monitor, &reporter});
  const Time end = microseconds(options.duration_s.value_or(0.0));
  try {
    scene::run(session, sources, *pace, observers, [&](const scene::Session& s) {
      return stop_signal() != 0 || (end != Time{} && s.now() >= end) || sources.exhausted();
    });
    eyes->finish();
  } catch (...) {  // the recording ends properly in any case
    reporter.say_news();
    trial.close_after_failure(session, monitor.kept_pace(session));
    throw;
  }
  heed_stop();
  monitor.finish(session);
  reporter.say_news();
  trial.close(session, monitor.kept_pace(session));
  conclude(options, session, monitor.state(session), totals);
}

std::function<void()> add_source_options(CLI::App& command,
                                         const std::shared_ptr<LiveOptions>& options) {
  command.add_option("SOURCE", options->sources,
                     "source of samples: fastrak:TTY, fastrak:tcp:HOST:PORT, lcm:URL or a trial; "
                     "several sources are merged");
  CLI::Option* lcm =
      command.add_option("--lcm", options->lcm,
                         "use lcm:URL as a source, and publish eyes and bodies there; \"\" is "
                         "LCM's default URL; a file:// URL is only read");
  auto fastrak = std::make_shared<std::string>();
  CLI::Option* line = command.add_option("--fastrak", *fastrak, "use fastrak:TTY as a source")
                          ->type_name("TTY|tcp:HOST:PORT");
  command.add_option("--baud", options->baud, "baud rate of a Fastrak's line")
      ->check(one_of({"2400", "4800", "9600", "19200", "38400", "57600", "115200"}))
      ->capture_default_str();
  command
      .add_option("--hemisphere", options->hemispheres,
                  "hemisphere of the receivers: a direction from the transmitter, in its frame (x "
                  "ahead, y right, z down); 0,0,0: start ahead and follow each receiver; may be "
                  "repeated; default: 1,0,0")
      ->type_name("[STATION:]X,Y,Z")
      ->allow_extra_args(false);
  add_duration(command, options->duration_s, "seconds; default: until interrupted");
  command
      .add_option("--eyes", options->eyes,
                  "format of the pictures on HEADPIN_EYES: raw or png; none: draw them only for "
                  "the recording")
      ->check(one_of({"raw", "png", "none"}))
      ->capture_default_str();
  command
      .add_flag("--no-trial", options->no_trial,
                "do not publish the session's own trial on SESSION_*")
      ->needs(lcm);
  add_gl(command, options->gl);
  return [options, lcm, line, fastrak] {
    options->use_lcm = lcm->count() > 0;
    if (options->use_lcm) options->sources.push_back("lcm:" + options->lcm);
    if (line->count() > 0) options->sources.push_back("fastrak:" + *fastrak);
  };
}

void add_live(CLI::App& app) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App* command = app.add_subcommand("live", "Run and record a session in real time");
  const auto take_sources = add_source_options(*command, options);
  command->add_option("--scenario", options->scenario,
                      "name of a bundled scenario or a TOML file; default: that of the trial that "
                      "is a source, or else the paper's room");
  add_output(*command, "--record", options->record,
             "file to record to (.lcmlog); it is readable at any time, also after a crash",
             {".lcmlog"});
  add_states(*command, options->states);
  command->add_option(
      "--participant", options->participant,
      "name of the participant in the recording; default: that of the trial that is a source");
  command->add_option("--condition", options->condition_name,
                      "name of the condition, with the same default");
  command
      ->add_option("--samples", options->samples,
                   "anti-aliasing: N^2 + 1 samples per pixel, or one with N = 1; stored in the "
                   "trial as look.samples; default: that of the scenario, 1 where its file has "
                   "none")
      ->check(whole_number_from(1, 4));
  add_force(*command, options->force);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  // A look sets the number of samples; --set look.samples=N overrides both.
  command->get_option("--samples")->excludes("--look");
  command->footer(
      "Examples:\n  headpin live fastrak:/dev/ttyUSB0 --record session.lcmlog\n"
      "  headpin live trial.lcmlog --elasticity 0.9\n"
      "  headpin live --lcm 'udpm://239.255.76.67:7667?ttl=0' --record session.lcmlog");
  command->callback([options, take_sources] {
    take_sources();
    go_live(*options);
  });
}

}  // namespace headpin::apps
