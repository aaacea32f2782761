#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>

#include "apps/command.h"
#include "apps/emulator_feed.h"
#include "apps/options.h"
#include "apps/priority.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/lock.h"
#include "devices/emulated/lcm_feed.h"
#include "devices/emulated/unit.h"
#include "devices/lines/byte_stream.h"
#include "devices/lines/command_pipe.h"
#include "devices/lines/tcp.h"

namespace headpin::apps {
namespace {

struct EmulateOptions {
  FeedOptions feed;
  std::string lcm, link, tcp, mouse, faults, control, firmware = "103.00";
  int receivers = 2, baud = 115200;
  std::uint64_t seed = 1;
  std::optional<double> duration;
  bool tag_2012 = false, early = false, stylus = false, strict_baud = false;
  bool json = false, use_lcm = false, use_mouse = false;
};

/// @param where  PORT or ADDRESS:PORT
std::unique_ptr<devices::TcpServer> serve_at(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  const std::string digits = colon == std::string::npos ? where : where.substr(colon + 1);
  const std::string option = "--tcp " + where + ": ";
  int port = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size() || port < 0 || port > 65535) {
    throw UsageError(option + "expected [ADDRESS:]PORT, a port from 0 to 65535");
  }
  try {
    if (colon == std::string::npos) return std::make_unique<devices::TcpServer>(port);
    return std::make_unique<devices::TcpServer>(port, where.substr(0, colon));
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(option + wrong.what());
  } catch (const base::Busy& busy) {
    throw base::Busy(option + busy.what());
  } catch (const std::runtime_error& failure) {
    throw std::runtime_error(option + failure.what());
  }
}

/// @param link  to the terminal; empty: none
std::unique_ptr<devices::PseudoTerminal> terminal_at(const std::string& link) {
  auto terminal = std::make_unique<devices::PseudoTerminal>();
  try {
    if (!link.empty()) terminal->link_at(link);
  } catch (const base::Busy& busy) {
    throw base::Busy(std::string("--link ") + busy.what());
  } catch (const std::runtime_error& failure) {
    throw std::runtime_error(std::string("--link ") + failure.what());
  }
  return terminal;
}

/// The line of the unit.
struct Line {
  explicit Line(const EmulateOptions& options) {
    if (!options.tcp.empty()) {
      tcp = serve_at(options.tcp);
    } else {
      pty = terminal_at(options.link);
    }
  }
  devices::ByteStream& stream() const {
    if (tcp) return *tcp;
    return *pty;
  }
  std::string name() const { return tcp ? tcp->name() : pty->name(); }

  std::unique_ptr<devices::PseudoTerminal> pty;
  std::unique_ptr<devices::TcpServer> tcp;
};

/// The station of the stylus: that of the hand if a trial or LCM gives the motion, otherwise 1; 0
/// without a stylus.
int stylus_of(const EmulateOptions& options) {
  if (!options.stylus) return 0;
  const bool somebody = !options.feed.trial.empty() || options.use_lcm;
  return somebody ? std::min(options.receivers, devices::kHandStation) : 1;
}

devices::FastrakEmulatorOptions unit_of(const EmulateOptions& options,
                                        const devices::FastrakPlace& place) {
  devices::FastrakEmulatorOptions unit;
  unit.receivers = options.receivers;
  unit.baud = options.baud;
  unit.early_firmware = options.early;
  unit.tag_2012 = options.tag_2012;
  unit.firmware = options.firmware;
  unit.seed = options.seed;
  unit.envelope = place.envelope;
  unit.stylus = stylus_of(options);
  if (options.stylus) unit.p_SN_stylus = Vec3(2.5 * devices::kMetrePerInch, 0.0, 0.0);
  try {
    unit.faults = devices::parse_faults(options.faults);
    devices::check_stations(unit.faults, options.receivers);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--faults: ") + error.what());
  }
  return unit;
}

/// Prints the name of the line on its own line first, for scripts.
void introduce(const EmulateOptions& options, const Line& line, const std::string& place,
               int stylus) {
  std::string text = fmt::format("{}\n", line.name());
  text += fmt::format("Fastrak{}, receivers {}, {} baud, measures {}; ends at SIGINT or SIGTERM\n",
                      options.link.empty() ? "" : " at " + options.link, options.receivers,
                      options.baud,
                      options.use_lcm              ? "LCM"
                      : options.feed.trial.empty() ? options.feed.motion
                                                   : options.feed.trial);
  if (!place.empty()) text += place + "\n";
  if (stylus > 0) text += fmt::format("receiver {} is a stylus\n", stylus);
  if (options.json) return say(text);
  fmt::print("{}", text);
  std::fflush(stdout);
}

void conclude(const EmulateOptions& options, const Line& line, Time lasted,
              const devices::FastrakEmulatorStatistics& s) {
  if (!options.json) {
    fmt::print("{} records sent, {} dropped whole, {} commands, {} refused\n", s.records, s.dropped,
               s.commands, s.refused);
    return;
  }
  print_json({{"line", line.name()},
              {"duration_s", seconds(lasted)},
              {"records", s.records},
              {"dropped", s.dropped},
              {"lost", s.lost},
              {"damaged", s.damaged},
              {"garbage_bytes", s.garbage_bytes},
              {"commands", s.commands},
              {"refused", s.refused}});
}

void wait_for_bytes(const Line& line, const devices::CommandPipe& control) {
  std::array<pollfd, 2> wait = {
      {{line.stream().descriptor(), POLLIN, 0}, {control.descriptor(), POLLIN, 0}}};
  ::poll(wait.data(), wait.size(), 1);
}

/// Carries out the control lines that have come. @return  false after the one that ends the unit
bool obey(devices::CommandPipe& control, devices::EmulatedUnit& unit, Time now) {
  const bool told = control.ignored() > 0;
  const std::vector<std::string> lines = control.lines();
  if (!told && control.ignored() > 0) {
    say("headpin emulate: control: lines longer than {} bytes are ignored\n",
        devices::CommandPipe::kLongest);
  }
  for (const std::string& line : lines) {
    try {
      if (!unit.obey(line, now)) return false;
    } catch (const devices::NoSuchButton& missing) {
      say("headpin emulate: control line '{}': expected {}\n", line,
          missing.of_thumb ? "the option --mouse" : "--stylus or --mouse");
    } catch (const std::invalid_argument& error) {
      say("headpin emulate: {}\n", error.what());
    }
  }
  return true;
}

void emulate(const EmulateOptions& options) {
  std::optional<devices::LcmUrl> to_mouse;
  if (options.use_mouse) {
    to_mouse = lcm_url("--mouse", options.mouse, devices::LcmUse::publishing);
  }
  Played played = play(options.feed);
  std::unique_ptr<devices::LcmFeed> lcm;
  if (options.use_lcm) {
    lcm_url("--lcm", options.lcm, devices::LcmUse::reading);  // named as it was given
    lcm = std::make_unique<devices::LcmFeed>(options.lcm);
    played.feed.motion = [&lcm](int station, Time) { return lcm->at(station); };
  }
  const devices::FastrakEmulatorOptions how = unit_of(options, played.place);
  watch_stop_signals();
  std::unique_ptr<devices::EmulatedMouse> mouse;
  if (to_mouse) mouse = std::make_unique<devices::EmulatedMouse>(*to_mouse, played.buttons);
  devices::EmulatedUnit unit(how, played.feed, std::move(mouse));
  devices::CommandPipe control(options.control);
  const Line line(options);
  introduce(options, line, played.says, how.stylus);

  go_first();  // if allowed: a real unit has its own processor
  const auto start = std::chrono::steady_clock::now();
  const auto clock = [&] {
    return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start);
  };
  while (stop_signal() == 0 && (!options.duration || clock() < microseconds(*options.duration))) {
    wait_for_bytes(line, control);
    const Time now = clock();
    const bool goes_on = obey(control, unit, now);
    if (lcm) {
      for (const std::string& fault : lcm->poll(now)) say("headpin emulate: {}\n", fault);
    }
    if (line.pty) line.pty->expect_baud(options.strict_baud ? unit.emulator().baud() : 0);
    unit.step(now, line.stream());
    if (!goes_on) break;
  }
  conclude(options, line, clock(), unit.emulator().statistics());
}

/// Adds the options for the motion that the unit measures.
///
/// @return  to be called after parsing
std::function<void()> add_feed_options(CLI::App& command, EmulateOptions& options) {
  FeedOptions& feed = options.feed;
  auto* trial = command.add_option("TRIAL", feed.trial,
                                   "replay the tracker samples of this trial; starts again each "
                                   "time a client switches continuous output on");
  command.add_option("--motion", feed.motion, "without a TRIAL: a test pattern, circle or still")
      ->check(one_of({"still", "circle"}))
      ->excludes(trial);
  auto* lcm = command
                  .add_option("--lcm", options.lcm,
                              "forward the samples that others publish on TRACKER and MOUSE3D at "
                              "this LCM URL; \"\" is LCM's default URL")
                  ->excludes(trial);
  auto* mouse =
      command
          .add_option("--mouse", options.mouse,
                      "publish the buttons of the 3D mouse on MOUSE3D at this LCM URL: those of "
                      "the trial, and those that --control presses; \"\" is LCM's default URL")
          ->excludes(lcm);
  command
      .add_option("--place", feed.place,
                  "place of the transmitter: recorded, or auto: moved where necessary, so that "
                  "clients work that set neither hemisphere nor envelope")
      ->check(one_of({"auto", "recorded"}))
      ->needs(trial)
      ->capture_default_str();
  add_longest_gap(command, feed.longest_gap)->needs(trial);
  command.add_flag("--loop", feed.loop, "repeat the trial; otherwise the unit rests at its end")
      ->needs(trial);
  return [&options, lcm, mouse] {
    options.use_lcm = lcm->count() > 0;
    options.use_mouse = mouse->count() > 0;
  };
}

/// Adds the options for the line to clients.
void add_line_options(CLI::App& command, EmulateOptions& options) {
  auto* tcp = command
                  .add_option("--tcp", options.tcp,
                              "serve TCP on this port (0: any free port), at 127.0.0.1 unless "
                              "another address of this computer is given; clients use headpin "
                              "live --fastrak tcp:HOST:PORT")
                  ->type_name("[ADDRESS:]PORT");
  command.add_option("--link", options.link, "create this symbolic link to the pseudo-terminal")
      ->excludes(tcp);
  command.add_option("--baud", options.baud, "baud rate that is set at the unit's switches")
      ->check(one_of({"2400", "4800", "9600", "19200", "38400", "57600", "115200"}))
      ->capture_default_str();
  command
      .add_flag("--strict-baud", options.strict_baud,
                "a client that sets another baud rate at the terminal receives garbage, and what "
                "it sends arrives as garbage")
      ->excludes(tcp);
}

/// Adds the options for the kind of unit.
void add_unit_options(CLI::App& command, EmulateOptions& options) {
  command.add_option("--receivers", options.receivers, "number of receivers that are plugged in")
      ->check(whole_number_from(1, 4))
      ->capture_default_str();
  command.add_flag("--stylus", options.stylus,
                   "the receiver of the hand (receiver 2; receiver 1 with a test pattern) is a "
                   "stylus: its tip is 2.5 inches ahead, its switch is the trigger; without this "
                   "the unit has no switch");
  command.add_flag("--tag-2012", options.tag_2012,
                   "send the status record in the form of firmware of 2012");
  command.add_flag("--early-firmware", options.early, "support the output items 18 to 20 as well");
  command.add_option("--firmware", options.firmware, "version in the status record, 6 characters")
      ->check([](const std::string& text) {
        const auto shown = [](char c) { return c >= ' ' && c <= '~'; };
        if (!std::ranges::all_of(text, shown)) return std::string("expected ASCII, 6 characters");
        return text.size() == 6 ? ""
                                : "expected 6 characters, found " + std::to_string(text.size());
      })
      ->capture_default_str();
}

/// Adds the options for faults and control while it runs.
void add_control_options(CLI::App& command, EmulateOptions& options) {
  command.add_option("--faults", options.faults, "faults of the unit and its line, see below");
  command.add_option("--seed", options.seed, "seed of noise and faults")
      ->check(seed())
      ->capture_default_str();
  command.add_option("--control", options.control,
                     "read control lines from this named pipe (created if missing), or from "
                     "standard input (-): power-cycle, press, release, left-thumb down, "
                     "left-thumb up, right-thumb down, right-thumb up, rewind, faults SPEC, quit");
  add_duration(command, options.duration, "stop after this many seconds");
}

}  // namespace

void add_emulate(CLI::App& app) {
  auto options = std::make_shared<EmulateOptions>();
  CLI::App* command = app.add_subcommand(
      "emulate", "Emulate a Polhemus Fastrak on a pseudo-terminal or a TCP port");
  const auto take_feed = add_feed_options(*command, *options);
  add_line_options(*command, *options);
  add_unit_options(*command, *options);
  add_control_options(*command, *options);
  command->add_flag("--json", options->json,
                    "print one JSON object at the end, and the terminal's name on standard error");
  command->footer("Faults, separated by commas (times in seconds from the start):\n" +
                  devices::faults_help() +
                  "\nExample:\n  headpin emulate --link /tmp/fastrak --motion circle --faults "
                  "garbage=0.01,silence=4@20\n");
  command->callback([options, take_feed] {
    take_feed();
    emulate(*options);
  });
}

}  // namespace headpin::apps
