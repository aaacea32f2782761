#include "apps/live.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/live_eyes.h"
#include "apps/live_report.h"
#include "apps/options.h"
#include "apps/priority.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/base/mouse3d.h"
#include "devices/lcm/link.h"
#include "devices/live/source.h"
#include "devices/trial/file.h"
#include "devices/trial/log.h"
#include "devices/trial/messages.h"
#include "devices/trial/sources.h"
#include "scene/play/details.h"
#include "scene/play/events.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/drawn_by.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"

namespace headpin::apps {

namespace {

/// The event that says how well the session kept real time.
devices::Event kept_pace(const Live& live) {
  devices::Event event;
  event.time = live.session.now();
  event.kind = scene::kind::kept_pace;
  event.detail = scene::to_detail({.ticks = live.session.tick,
                                   .overruns = live.pace->overruns(),
                                   .frames = live.frames,
                                   .late_frames = live.eyes->late(),
                                   .drawing_failures = live.drawing_failures});
  return event;
}

/// Throws if no sample arrived: such a session has failed.
void require_samples(const Live& live) {
  if (live.samples > 0) return;
  std::string from;
  for (const auto& source : live.sources) from += (from.empty() ? "" : " or ") + source.name;
  throw std::runtime_error(
      fmt::format("no sample arrived in {:.1f} s from {}", seconds(live.session.now()), from));
}

/// A trial that is played in addition to devices or instead of them.
struct Played {
  std::string path;
  devices::TrialHeader header;
};

/// The sources that are logs of trials.
std::vector<Played> played_by(const Live& live) {
  std::vector<Played> all;
  for (const auto& source : live.sources) {
    if (source.recording.empty()) continue;
    const devices::TrialFile file(source.recording);
    if (!file.summary().has_header) continue;
    say_what_is_missing("live", source.recording, file.summary());
    all.push_back({source.recording, file.summary().header});
  }
  return all;
}

scene::Scenario scenario_of(const Played& trial) {
  return scene::scenario_of_trial(trial.header.scenario, trial.path);
}

/// Participant and condition of the session: from the options, otherwise from the played trial.
devices::TrialHeader whose(const LiveOptions& options, std::span<const Played> played) {
  devices::TrialHeader header;
  if (!played.empty()) {
    header.participant = played[0].header.participant;
    header.condition = played[0].header.condition;
    header.seed = played[0].header.seed;
  }
  if (options.participant) header.participant = *options.participant;
  if (options.condition_name) header.condition = *options.condition_name;
  return header;
}

/// Prints a message if the samples of a log are used in another scenario than their own.
void tell_of_another_scenario(const Played& trial, const scene::Scenario& chosen) {
  try {
    scene::Scenario its = scenario_of(trial);
    its.look = chosen.look;  // differences of the rendering quality do not count
    if (scene::to_toml(its) == scene::to_toml(chosen)) return;
  } catch (const std::invalid_argument&) {  // not complete, so it is not that of this session
  }
  say("headpin live: {} was recorded in another scenario than this session's; without --scenario, "
      "the session uses the recorded one\n",
      printable(trial.path));
}

/// The scenario from the options, otherwise that of a played log, otherwise the paper's room.
scene::Scenario choose_scenario(const LiveOptions& options, std::span<const Played> played) {
  if (options.given || !options.scenario.empty()) {
    const scene::Scenario chosen =
        options.given ? *options.given : scene::load_scenario(options.scenario);
    for (const Played& trial : played) tell_of_another_scenario(trial, chosen);
    return chosen;
  }
  return played.empty() ? scene::Scenario{} : scenario_of(played[0]);
}

devices::SourceOptions source_options(const LiveOptions& options,
                                      const std::shared_ptr<scene::RealTime>& pace) {
  devices::SourceOptions how;
  how.clock = [pace] { return pace->now(); };
  how.fastrak.baud = options.baud;
  for (const std::string& hemisphere : options.hemispheres) {
    devices::read_zenith(hemisphere, how.fastrak.zenith);
  }
  return how;
}

Live open_live(const LiveOptions& options) {
  Live live;
  std::optional<devices::LcmUrl> lcm;
  if (options.use_lcm) lcm = lcm_url("--lcm", options.lcm, devices::LcmUse::reading);
  try {
    const devices::SourceOptions how = source_options(options, live.pace);
    for (const std::string& name : options.sources) {
      live.sources.push_back(devices::open_source(name, live.pace->clocks(), how));
    }
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  const std::vector<Played> played = played_by(live);
  live.header = whose(options, played);
  scene::Scenario scenario = choose_scenario(options, played);
  scenario.look.samples = options.samples;
  apply_condition(options.condition, scenario);
  live.session = scene::make_session(scenario);
  if (!lcm || lcm->log()) return live;  // a file has no listeners
  live.link = std::make_unique<devices::LcmLink>(*lcm);
  if (!options.no_trial) {
    live.session_link = std::make_unique<devices::LcmLink>(*lcm, devices::kSessionPrefix);
    live.publisher = std::make_unique<scene::TrialWriter>(std::make_unique<devices::TrialPublisher>(
        *live.session_link, scene::header_of(live.header, live.session)));
  }
  return live;
}

/// Begins the recording. This is the last step: programs that wait for its file may then send.
void open_recording(const LiveOptions& options, Live& live) {
  if (!options.record) return;
  std::vector<std::filesystem::path> inputs = {options.scenario};
  for (const auto& source : live.sources) inputs.push_back(source.recording);
  const Time epoch =
      std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
  live.writer =
      std::make_unique<scene::TrialWriter>(*options.record, live.header, live.session,
                                           devices::Recorder::Options{.overwrite = options.force,
                                                                      .live = true,
                                                                      .inputs = inputs,
                                                                      .states = options.states,
                                                                      .epoch = epoch});
}

/// All sources as one. A stylus switch is the trigger if there is no mouse.
std::unique_ptr<devices::Source> source_of(const Live& live) {
  std::vector<devices::Source*> list;
  bool stylus = false;
  for (const auto& source : live.sources) {
    list.push_back(source.source.get());
    stylus = stylus || source.has_stylus;
  }
  auto merged = std::make_unique<devices::MergedSource>(list);
  if (!stylus) return merged;
  return std::make_unique<devices::StylusMouse>(std::move(merged));
}

/// Runs the session until it is stopped, and ends the recording properly in any case.
void run_recorded(Live& live, devices::Source& source, Reporter& reporter,
                  std::span<scene::Observer* const> observers, Time end) {
  try {
    scene::run(live.session, source, *live.pace, observers, [&](const scene::Session& s) {
      return stop_signal() != 0 || (end != Time{} && s.now() >= end) || source.exhausted();
    });
    live.eyes->finish();
  } catch (...) {
    const devices::Event pace = kept_pace(live);
    for (scene::TrialWriter* writer : {live.writer.get(), live.publisher.get()}) {
      try {
        if (!writer) continue;
        writer->write(pace);
        writer->close(live.session);
      } catch (const std::exception&) {  // this is the failure itself, or less important
      }
    }
    throw;
  }
  heed_stop();
  reporter.finish();
  write(live, kept_pace(live));
  if (live.writer) live.writer->close(live.session);
  if (live.publisher) live.publisher->close(live.session);
}

}  // namespace

void go_live(const LiveOptions& options) {
  if (options.sources.empty()) {
    throw UsageError("no source of samples: expected --lcm URL, --fastrak TTY or a SOURCE");
  }
  watch_stop_signals();
  Live live = open_live(options);
  const std::unique_ptr<devices::Source> merged = source_of(live);
  devices::Source& source = *merged;

  // Without real-time scheduling, ticks have priority only if the drawing process gives way.
  live.eyes = open_eyes(*live.session.stage, live.link ? options.eyes : std::string("none"),
                        options.lcm, options.gl, to_be_had() != Priority::real_time);
  const Time end = microseconds(options.duration_s.value_or(0.0));
  live.eyes->measure_by(*live.pace);
  live.pace->begin(live.session.scenario().rates.physics_hz);
  go_first();  // and the readers
  for (const devices::OpenSource& one : live.sources) one.start();
  open_recording(options, live);
  write(live, scene::drawn_by_event(live.eyes->drawn_by()));

  std::vector<scene::Observer*> observers = {&live.totals};
  if (live.writer) observers.push_back(live.writer.get());
  if (live.publisher) observers.push_back(live.publisher.get());
  observers.push_back(live.eyes.get());
  std::optional<Viewer> viewer;
  if (live.link) observers.push_back(&viewer.emplace(*live.link));
  Reporter reporter(live);
  observers.push_back(&reporter);
  run_recorded(live, source, reporter, observers, end);
  print_line(live);
  if (!live.latency.each_s.empty()) print_stages(live.latency);
  require_samples(live);
  if (const std::string why = live.totals.why_nothing_fell(); !why.empty()) {
    say("{:11}no skittle fell: {}\n", "", printable(why));
  }
  if (options.json) print_json(summary(live, options));
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
                   "trial as look.samples")
      ->check(whole_number_from(1, 4))
      ->capture_default_str();
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
