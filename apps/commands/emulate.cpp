#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/priority.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/fastrak/emulator.h"
#include "devices/lcm/link.h"
#include "devices/live/source.h"
#include "devices/recordings/recorded_motion.h"
#include "devices/trial/file.h"
#include "devices/trial/log.h"
#include "files/names.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

struct EmulateOptions {
  std::string trial, motion = "circle", lcm, link, faults, control, firmware = "103.00";
  std::string place = "auto";
  std::string tcp, mouse;
  double longest_gap = seconds(devices::kLongestGap);
  int receivers = 2, baud = 115200;
  std::uint64_t seed = 1;
  std::optional<double> duration;
  bool tag_2012 = false, early = false, stylus = false, strict_baud = false, loop = false;
  bool json = false, use_lcm = false, use_mouse = false;
};

/// Lines typed at a running emulator, from a named pipe or standard input.
class Control {
 public:
  explicit Control(const std::string& path) {
    if (path.empty()) return;
    if (path == "-") {
      fd_ = STDIN_FILENO;
      fcntl(fd_, F_SETFL, fcntl(fd_, F_GETFL) | O_NONBLOCK);
      return;
    }
    if (mkfifo(path.c_str(), 0600) == 0) {
      made_ = path;
    } else if (errno != EEXIST) {
      throw std::runtime_error(path + ": " + std::strerror(errno));
    }
    struct stat file {};
    // Open for writing too, so that it does not end with the first writer.
    fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0 || fstat(fd_, &file) != 0 || !S_ISFIFO(file.st_mode)) {
      if (fd_ >= 0) ::close(fd_);
      throw std::runtime_error(path + ": exists and is not a named pipe");
    }
  }
  ~Control() {
    if (!made_.empty()) files::remove_pipe(made_, fd_);
    if (fd_ > STDIN_FILENO) ::close(fd_);
  }
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  int descriptor() const { return fd_; }

  /// Whole lines that came since the last call; the rest of a flood is there at the next.
  std::vector<std::string> lines() {
    constexpr std::size_t kLongest = 4096;  // of a line; the longest that means something has 300
    std::array<char, 65536> bytes{};
    if (fd_ < 0) return {};
    const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
    if (n > 0) text_.append(bytes.data(), static_cast<std::size_t>(n));
    if (n == 0) fd_ = -1;  // the end of standard input
    if (text_.size() > kLongest && text_.find('\n') > kLongest) {
      text_.erase(0, std::min(text_.find('\n'), text_.size()));
      if (!told_)
        say("headpin emulate: control: lines longer than {} bytes are left out\n", kLongest);
      told_ = true;
    }
    std::vector<std::string> whole;
    for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
      whole.push_back(text_.substr(0, end));
      text_.erase(0, end + 1);
    }
    return whole;
  }

 private:
  int fd_ = -1;
  std::string made_, text_;
  bool told_ = false;
};

/// @param where  PORT or ADDRESS:PORT
std::unique_ptr<devices::TcpServer> serve_at(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  const std::string digits = colon == std::string::npos ? where : where.substr(colon + 1);
  int port = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size() || port < 0 || port > 65535) {
    throw UsageError("--tcp " + where + ": expected [ADDRESS:]PORT, a port from 0 to 65535");
  }
  if (colon == std::string::npos) return std::make_unique<devices::TcpServer>(port);
  return std::make_unique<devices::TcpServer>(port, where.substr(0, colon));
}

/// The line the unit hangs on.
struct Line {
  explicit Line(const EmulateOptions& options) {
    if (!options.tcp.empty()) {
      tcp = serve_at(options.tcp);
    } else {
      pty = std::make_unique<devices::PseudoTerminal>(options.link);
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

/// What the unit measures: a test pattern, or a recording that starts when records are asked for.
struct Feed {
  devices::FastrakMotion motion;
  devices::FastrakPlace place;        ///< of the transmitter, in a recording's frame
  std::string says;                   ///< what was chosen so that clients can use a recording
  Time begin{}, length{};             ///< of a recording
  devices::TrackerSample first = {};  ///< of a recording
  bool loop = false, pressed = false;
  std::vector<devices::MouseSample> buttons = {};  ///< of a recording's mouse, where they change

  /// Where in a recording it is.
  Time within(Time time) const {
    if (length == Time{}) return time;
    const Time t = time > begin ? time - begin : Time{};
    return loop ? t % length : t;
  }
  devices::FastrakTruth at(int station, Time time) const {
    devices::FastrakTruth truth = motion(station, within(time));
    truth.pressed = truth.pressed || pressed;
    return truth;
  }
};

/// The buttons of the 3D mouse, which a Fastrak's line has no room for: on MOUSE3D, at each change;
/// those of a trial ten times a second too, by which listeners learn how late messages are.
class Mouse {
 public:
  /// @param recorded  of a trial, in the order of time; its buttons are pressed as they were
  Mouse(const std::string& url, std::vector<devices::MouseSample> recorded)
      : link_(url), recorded_(std::move(recorded)) {}

  devices::MouseSample typed;  ///< what --control holds down beside the trial

  /// @param now  on the clock that messages are stamped by; a trial's changes are as exact as it is
  /// @param at   in the trial
  void publish(Time now, Time at) {
    const auto later =
        std::ranges::upper_bound(recorded_, at, {}, &devices::MouseSample::device_time);
    const auto until = static_cast<std::size_t>(later - recorded_.begin());
    if (until < told_) told_ = 0;  // it has begun again
    for (; told_ < until; ++told_) {
      then_ = recorded_[told_];
      tell(now - at + then_.device_time);
    }
    tell(now);
  }

 private:
  void tell(Time time) {
    devices::MouseSample mouse;
    mouse.device_time = time;
    mouse.left_thumb = typed.left_thumb || then_.left_thumb;
    mouse.right_thumb = typed.right_thumb || then_.right_thumb;
    mouse.trigger = typed.trigger || then_.trigger;
    const std::array state = {mouse.left_thumb, mouse.right_thumb, mouse.trigger};
    const bool again = !recorded_.empty() && std::chrono::abs(time - told_at_) >= kAgain;
    if (state == told_last_ && !again) return;
    told_last_ = state;
    told_at_ = time;
    link_.publish(devices::Sample(mouse));
  }

  static constexpr Time kAgain{100'000};

  devices::LcmLink link_;
  std::vector<devices::MouseSample> recorded_;
  std::size_t told_ = 0;       ///< of these
  devices::MouseSample then_;  ///< the last of them
  std::optional<std::array<bool, 3>> told_last_;
  Time told_at_{};
};

/// What others publish on TRACKER and MOUSE3D: the newest sample of each.
class LcmFeed {
 public:
  explicit LcmFeed(const std::string& url) : source_(devices::open_source("lcm:" + url, {})) {
    for (int s = 0; s < devices::kFastrakStations; ++s) {
      newest_[static_cast<std::size_t>(s)] = devices::still_motion(s + 1, Time{});
    }
    source_->start();
  }

  void poll(Time now) {
    samples_.clear();
    source_->poll(now, samples_);
    for (const std::string& what : amiss_.take(*source_, now)) say("headpin emulate: {}\n", what);
    for (const devices::Sample& sample : samples_) {
      if (const auto* mouse = std::get_if<devices::MouseSample>(&sample)) {
        trigger_ = mouse->trigger;
        continue;
      }
      const auto& tracker = std::get<devices::TrackerSample>(sample);
      if (tracker.station < 1 || tracker.station > devices::kFastrakStations) continue;
      newest_[static_cast<std::size_t>(tracker.station - 1)] = {
          tracker.X_TS, (tracker.buttons & 1) != 0, tracker.status};
    }
  }

  devices::FastrakTruth at(int station) const {
    devices::FastrakTruth truth = newest_[static_cast<std::size_t>(station - 1)];
    truth.pressed = truth.pressed || trigger_;
    return truth;
  }

 private:
  std::unique_ptr<devices::LiveSource> source_;
  devices::AmissNews amiss_;
  std::array<devices::FastrakTruth, devices::kFastrakStations> newest_;
  bool trigger_ = false;
  std::vector<devices::Sample> samples_;
};

/// What a client gets that sets nothing itself.
std::string place_report(const devices::FastrakPlace& place, const devices::TrialHeader& header,
                         const EmulateOptions& options) {
  std::string text = fmt::format(
      "{}: in inches until a client says otherwise; positions up to {:.2f} m along an axis are not "
      "flagged{}",
      options.trial, place.envelope,
      place.envelope > devices::FastrakPlace().envelope ? " (factory: 2.00)" : "");
  if (place.p_TP.isZero()) return text + "; transmitter where it was recorded";
  const Vec3& p = place.p_TP;
  text += fmt::format(
      "; transmitter moved by {:.3f}, {:.3f}, {:.3f} m (ahead, right, down), so that all receivers "
      "are ahead of it, {:.2f} m at most",
      p.x(), p.y(), p.z(), place.farthest);
  const scene::Rig rig = scene::scenario_of_trial(header.scenario, options.trial).rig;
  const Vec3 p_W = rig.X_WT * p;
  return text + fmt::format(
                    "; in the trial's room that is rig.X_WT p = [{:.4f}, {:.4f}, {:.4f}] "
                    "(--place recorded leaves it there)",
                    p_W.x(), p_W.y(), p_W.z());
}

Feed feed_of(const EmulateOptions& options) {
  Feed feed;
  feed.loop = options.loop;
  if (options.trial.empty()) {
    feed.motion = options.motion == "still" ? devices::still_motion : devices::circling_motion;
    return feed;
  }
  const auto file = std::make_shared<const devices::TrialFile>(options.trial);
  file->require_trial(microseconds(options.longest_gap));
  const devices::TrialSummary& trial = file->summary();
  if (trial.sample_count == 0)
    throw std::runtime_error(options.trial + ": no device samples in it");
  say_what_is_missing("emulate", options.trial, trial);
  devices::RecordedUnit recorded = devices::recorded_unit(file);
  if (options.place == "auto") feed.place = recorded.place;
  feed.motion = devices::seen_from(feed.place, std::move(recorded.motion));
  feed.length = recorded.length;
  feed.first = recorded.first;
  feed.says = place_report(feed.place, trial.header, options);
  if (options.use_mouse) feed.buttons = std::move(recorded.buttons);
  return feed;
}

/// @return  false for the line that ends the emulator
bool obey(const std::string& line, devices::FastrakEmulator& emulator, Feed& feed, bool stylus,
          Mouse* mouse, Time now) {
  const auto word = [&](std::string_view begin) { return line.starts_with(begin); };
  if (line == "power-cycle") {
    emulator.power_cycle(now);
  } else if (line == "press" || line == "release") {
    if (!stylus && !mouse) {
      throw std::invalid_argument("control line '" + line +
                                  "': no stylus is plugged in (--stylus), nor a mouse (--mouse)");
    }
    feed.pressed = line == "press";
    if (mouse) mouse->typed.trigger = feed.pressed;
  } else if (word("left-thumb ") || word("right-thumb ")) {
    const bool down = line.ends_with(" down");
    if (!mouse || (!down && !line.ends_with(" up"))) {
      throw std::invalid_argument(
          "control line '" + line + "': expected " +
          (mouse ? "up or down behind it" : "a mouse to press it (--mouse)"));
    }
    (word("left") ? mouse->typed.left_thumb : mouse->typed.right_thumb) = down;
  } else if (line == "rewind") {
    feed.begin = devices::begin_of(feed.first, emulator, now);
  } else if (line.starts_with("faults")) {
    emulator.set_faults(devices::parse_faults(line.size() > 7 ? line.substr(7) : ""));
  } else if (!line.empty() && line != "quit") {
    throw std::invalid_argument(
        "control line '" + line +
        "': expected power-cycle, press, release, left-thumb or right-thumb up or down, rewind, "
        "faults SPEC or quit");
  }
  return line != "quit";
}

/// The hand's receiver, where somebody plays a part; 0 when no stylus is plugged in.
int stylus_of(const EmulateOptions& options) {
  if (!options.stylus) return 0;
  const bool somebody = !options.trial.empty() || options.use_lcm;
  return somebody ? std::min(options.receivers, devices::kHandStation) : 1;
}

devices::FastrakEmulatorOptions unit_of(const EmulateOptions& options, const Feed& feed) {
  devices::FastrakEmulatorOptions unit;
  unit.receivers = options.receivers;
  unit.baud = options.baud;
  unit.early_firmware = options.early;
  unit.tag_2012 = options.tag_2012;
  unit.firmware = options.firmware;
  unit.seed = options.seed;
  unit.envelope = feed.place.envelope;
  unit.stylus = stylus_of(options);
  if (options.stylus) unit.p_SN_stylus = Vec3(2.5 * devices::kMetrePerInch, 0.0, 0.0);
  try {
    unit.faults = devices::parse_faults(options.faults);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return unit;
}

/// The line's name alone first, for scripts that read it.
void introduce(const EmulateOptions& options, const Line& line, const Feed& feed, int stylus) {
  std::string text = fmt::format("{}\n", line.name());
  text += fmt::format("Fastrak{}, receivers {}, {} baud, measures {}; ends at SIGINT or SIGTERM\n",
                      options.link.empty() ? "" : " at " + options.link, options.receivers,
                      options.baud,
                      options.use_lcm         ? "LCM"
                      : options.trial.empty() ? options.motion
                                              : options.trial);
  if (!feed.says.empty()) text += feed.says + "\n";
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

void wait_for_bytes(const Line& line, const Control& control) {
  std::array<pollfd, 2> wait = {
      {{line.stream().descriptor(), POLLIN, 0}, {control.descriptor(), POLLIN, 0}}};
  ::poll(wait.data(), wait.size(), 1);
}

void emulate(const EmulateOptions& options) {
  Feed feed = feed_of(options);
  std::unique_ptr<LcmFeed> lcm;
  if (options.use_lcm) {
    lcm = std::make_unique<LcmFeed>(options.lcm);
    feed.motion = [&lcm](int station, Time) { return lcm->at(station); };
  }
  const devices::FastrakEmulatorOptions unit = unit_of(options, feed);
  devices::FastrakEmulator emulator(
      unit, [&feed](int station, Time time) { return feed.at(station, time); });
  watch_stop_signals();

  std::optional<Mouse> mouse;
  if (options.use_mouse) mouse.emplace(options.mouse, feed.buttons);
  Control control(options.control);
  const Line line(options);
  introduce(options, line, feed, unit.stylus);

  go_first();  // if it may: a unit has a processor of its own
  const auto start = std::chrono::steady_clock::now();
  const auto clock = [&] {
    return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start);
  };
  std::int64_t started = 0;
  bool quit = false;
  while (!quit && stop_signal() == 0 &&
         (!options.duration || clock() < microseconds(*options.duration))) {
    wait_for_bytes(line, control);
    const Time now = clock();
    for (const std::string& typed : control.lines()) {
      try {
        quit = quit || !obey(typed, emulator, feed, options.stylus, mouse ? &*mouse : nullptr, now);
      } catch (const std::invalid_argument& error) {
        say("headpin emulate: {}\n", error.what());
      }
    }
    if (lcm) lcm->poll(now);
    // A trial begins with the unit's records, and its buttons are told by the clock of those.
    const bool of_trial = !options.trial.empty();
    if (mouse && (started > 0 || !of_trial)) {
      mouse->publish(of_trial ? now - emulator.stream_zero() : now, feed.within(now));
    }
    if (line.pty) line.pty->expect_baud(options.strict_baud ? emulator.baud() : 0);
    devices::serve(emulator, line.stream(), now);
    // A recording begins when somebody starts to listen, and again for the next one.
    const std::int64_t streams = emulator.statistics().streams;
    if (streams > started) feed.begin = devices::begin_of(feed.first, emulator, now);
    started = streams;
  }
  conclude(options, line, clock(), emulator.statistics());
}

}  // namespace

void add_emulate(CLI::App& app) {
  auto options = std::make_shared<EmulateOptions>();
  CLI::App* command = app.add_subcommand(
      "emulate", "Be a Polhemus Fastrak on a pseudo-terminal or a TCP port, as a driver sees it");
  auto* trial = command->add_option("TRIAL", options->trial,
                                    "feed it from a trial, from its start whenever a client "
                                    "switches continuous output on");
  command->add_option("--motion", options->motion, "a test pattern instead: circle or still")
      ->check(CLI::IsMember({"still", "circle"}))
      ->excludes(trial);
  auto* lcm =
      command
          ->add_option("--lcm", options->lcm,
                       "feed it from TRACKER and MOUSE3D at this LCM URL, as they come; \"\" is "
                       "LCM's default URL")
          ->excludes(trial);
  command
      ->add_option(
          "--place", options->place,
          "of the transmitter: recorded, or auto: moved if a client that sets no hemisphere "
          "or envelope could not use the trial's poses else")
      ->check(CLI::IsMember({"auto", "recorded"}))
      ->needs(trial)
      ->capture_default_str();
  add_longest_gap(*command, options->longest_gap)->needs(trial);
  command->add_flag("--loop", options->loop, "repeat the trial instead of resting at its end")
      ->needs(trial);
  auto* tcp =
      command
          ->add_option("--tcp", options->tcp,
                       "serve TCP on this port, 0 for any, at 127.0.0.1 unless an address of "
                       "this machine is given; headpin live --fastrak tcp:HOST:PORT")
          ->type_name("[ADDRESS:]PORT");
  command->add_option("--link", options->link, "make this symbolic link to the terminal")
      ->excludes(tcp);
  command->add_option("--receivers", options->receivers, "receivers plugged in")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  command->add_option("--baud", options->baud, "rate set at its switches")
      ->check(CLI::IsMember({2400, 4800, 9600, 19200, 38400, 57600, 115200}))
      ->capture_default_str();
  command
      ->add_flag("--strict-baud", options->strict_baud,
                 "clients that set another rate at the terminal get and give garbage")
      ->excludes(tcp);
  command->add_option("--faults", options->faults, "what goes wrong; see below");
  command->add_option("--seed", options->seed, "of noise and faults")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--control", options->control,
                      "named pipe (made if missing) or - for standard input, taking lines: "
                      "power-cycle, press, release, left-thumb down, left-thumb up, right-thumb "
                      "down, right-thumb up, rewind, faults SPEC, quit");
  auto* mouse =
      command
          ->add_option("--mouse", options->mouse,
                       "publish the 3D mouse's buttons on MOUSE3D at this LCM URL, as the trial or "
                       "--control press them: a Fastrak's line has no room for thumbs; \"\" is "
                       "LCM's default URL")
          ->excludes(lcm);
  command->add_flag("--stylus", options->stylus,
                    "the hand's receiver (2; 1 of a test pattern) is a stylus, its tip 2.5 inches "
                    "ahead, its switch the trigger; without it the unit has no switch");
  command->add_flag("--tag-2012", options->tag_2012, "status record as of firmware of 2012");
  command->add_flag("--early-firmware", options->early, "output items 18 to 20 as well");
  command->add_option("--firmware", options->firmware, "version in the status record, 6 characters")
      ->check([](const std::string& text) {
        const auto shown = [](char c) { return c >= ' ' && c <= '~'; };
        if (!std::ranges::all_of(text, shown)) return std::string("expected ASCII, 6 characters");
        return text.size() == 6 ? ""
                                : "expected 6 characters, found " + std::to_string(text.size());
      })
      ->capture_default_str();
  add_duration(*command, options->duration, "end by itself after so many seconds");
  command->add_flag("--json", options->json,
                    "print one JSON object at the end; the terminal's name goes to standard error");
  command->footer("Faults, separated by commas (times in seconds from the start):\n" +
                  devices::faults_help() +
                  "\nExample:\n  headpin emulate --link /tmp/fastrak --motion circle --faults "
                  "garbage=0.01,silence=4@20\n");
  command->callback([options, lcm, mouse] {
    options->use_lcm = lcm->count() > 0;
    options->use_mouse = mouse->count() > 0;
    emulate(*options);
  });
}

}  // namespace headpin::apps
