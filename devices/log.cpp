#include "devices/log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <stdio_ext.h>
#include <unistd.h>

#include "devices/event_log.h"
#include "devices/messages.h"
#include "devices/sources.h"
#include "devices/version.h"
#include "files/output_file.h"

namespace headpin::devices {
namespace {

/// Which device a sample is of: the station of a tracker, 0 for the 3D mouse.
std::int32_t device(const Sample& sample) {
  const auto* tracker = std::get_if<TrackerSample>(&sample);
  return tracker ? tracker->station : 0;
}

/// Which of a row of numbers jump away from those around them, and back, by more than `most`.
std::vector<bool> lone(const std::vector<double>& row, double most) {
  constexpr std::size_t kAhead = 4;
  const auto differ = [&](std::size_t i, std::size_t k) {
    return std::abs(row[i] - row[k]) > most;
  };
  // Whether one of the next few goes on where `before` was.
  const auto comes_back = [&](std::size_t before, std::size_t i) {
    const std::size_t end = std::min(row.size(), i + 1 + kAhead);
    for (std::size_t k = i + 1; k < end; ++k) {
      if (!differ(before, k)) return true;
    }
    return end == i + 1;  // nothing behind it speaks for it
  };
  std::vector<bool> out(row.size(), false);
  std::size_t before = 0;
  // The first one has nobody before it: it is wrong when those behind it agree with each other.
  if (row.size() > 2 && differ(0, 1) && differ(0, 2) && !differ(1, 2)) out[0] = true, before = 1;
  for (std::size_t i = before + 1; i < row.size(); ++i) {
    if (differ(before, i) && comes_back(before, i)) {
      out[i] = true;
    } else {
      before = i;
    }
  }
  return out;
}

/// Drops the marked ones.
template <typename T>
void drop(std::vector<T>& from, const std::vector<bool>& marked) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (marked[i]) continue;
    if (kept != i) from[kept] = std::move(from[i]);
    ++kept;
  }
  from.resize(kept);
}

/// Puts the messages of a log, one after the other, where they belong.
class Sorter {
 public:
  explicit Sorter(Trial& trial) : trial_(trial) {}

  /// @return false when another trial begins
  bool add(const LogEvent& event) {
    Channel& channel = trial_.channels[std::string(event.channel)];
    if (++channel.messages == 1) channel.first = event.time;
    channel.last = event.time;
    channel.bytes += static_cast<std::int64_t>(event.data.size());
    if (!is_trial_channel(event.channel)) return true;

    std::optional<Message> message = decode(event.channel, event.data);
    if (!message) {
      ++trial_.skipped.undecodable;
    } else if (!plausible(*message)) {
      ++trial_.skipped.implausible;
    } else if (const auto* again = std::get_if<TrialHeader>(&*message);
               again && trial_.has_header) {
      if (*again == trial_.header) return true;  // repeated
      ++trial_.skipped.other_trials;
      return false;
    } else {
      stamp_ = event.time;
      std::visit([&](auto& m) { take(m); }, *message);
      ++taken_;
    }
    return true;
  }

  /// What takes the whole log to be seen.
  void finish() {
    drop_misdated_states();
    drop_misdated_samples();
    std::map<std::int32_t, Time> last_time;
    for (std::size_t i = 0; i < trial_.samples.size(); ++i) {
      Sample& sample = trial_.samples[i];
      const Time time = device_time(sample);
      const auto [last, is_first] = last_time.try_emplace(device(sample), time);
      if (!is_first && time <= last->second) ++trial_.backwards;
      last->second = time;
      const std::size_t states = sample_notes_[i].states;
      if (states == 0) continue;
      const Time tick = trial_.states[states - 1].time;
      if (arrival(sample) <= tick) ++trial_.late;
      if (available(sample) <= tick) {
        std::visit([&](auto& s) { s.session_time = tick + Time{1}; }, sample);
      }
    }
    find_longest_gap();
  }

 private:
  /// What a log says of a sample, beside the sample.
  struct Note {
    Time stamp{};
    std::size_t states = 0;  ///< that stood before it
  };

  void take(TrialHeader& header) {
    trial_.header = std::move(header);
    trial_.has_header = true;
  }
  void take(TrackerSample& sample) {
    if (!sample.in_transmitters_frame()) {
      ++trial_.skipped.foreign;
    } else {
      take_sample(std::move(sample));
    }
  }
  void take(MouseSample& sample) { take_sample(sample); }
  void take(TickState& state) {
    trial_.states.push_back(std::move(state));
    state_stamps_.push_back(stamp_);
  }
  void take(FrameRecord& frame) { trial_.frames.push_back(frame); }
  void take(Event& event) {
    if (event.kind == kEndEvent) {
      trial_.complete = event.value == static_cast<double>(taken_);
    } else {
      trial_.events.push_back(std::move(event));
    }
  }
  void take_sample(Sample sample) {
    trial_.samples.push_back(std::move(sample));
    sample_notes_.push_back({stamp_, trial_.states.size()});
  }

  void drop_misdated_states() {
    std::vector<double> times, ticks;
    for (std::size_t i = 0; i < trial_.states.size(); ++i) {
      times.push_back(seconds(trial_.states[i].time - state_stamps_[i]));
      ticks.push_back(static_cast<double>(trial_.states[i].tick) - static_cast<double>(i));
    }
    std::vector<bool> wrong = lone(times, kMostJump_s);
    constexpr double kMostJump = 1000.0;  // ticks
    const std::vector<bool> wrong_ticks = lone(ticks, kMostJump);
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] = wrong[i] || wrong_ticks[i];
    drop(trial_.states, wrong);
    std::vector<std::size_t> kept = {0};  // of so many first ones
    for (const bool w : wrong) kept.push_back(kept.back() + (w ? 0 : 1));
    for (Note& note : sample_notes_) note.states = kept[note.states];
    trial_.skipped.misdated += std::ranges::count(wrong, true);
  }

  /// Each device's times, all that its samples have, against the log's stamps.
  void drop_misdated_samples() {
    std::map<std::int32_t, std::vector<std::size_t>> of_device;
    for (std::size_t i = 0; i < trial_.samples.size(); ++i) {
      of_device[device(trial_.samples[i])].push_back(i);
    }
    std::vector<bool> wrong(trial_.samples.size(), false);
    for (const auto& [number, indices] : of_device) {
      for (std::size_t kind = 0; kind < 3; ++kind) {
        std::vector<std::size_t> having;  // a sample without a host or a session has 0 there
        std::vector<double> row;
        for (const std::size_t i : indices) {
          const Time time = std::visit(
              [kind](const auto& s) {
                return std::array{s.device_time, s.host_time, s.session_time}[kind];
              },
              trial_.samples[i]);
          if (kind > 0 && time == Time{}) continue;
          having.push_back(i);
          row.push_back(seconds(time - sample_notes_[i].stamp));
        }
        constexpr std::size_t kFew =
            8;  // two presses of a button do not tell which of them is wrong
        if (row.size() < kFew) continue;
        const std::vector<bool> alone = lone(row, kMostJump_s);
        for (std::size_t k = 0; k < having.size(); ++k) {
          wrong[having[k]] = wrong[having[k]] || alone[k];
        }
      }
    }
    drop(trial_.samples, wrong);
    drop(sample_notes_, wrong);
    trial_.skipped.misdated += std::ranges::count(wrong, true);
  }

  void find_longest_gap() {
    std::vector<Time> times;
    for (const Sample& sample : trial_.samples) times.push_back(available(sample));
    std::ranges::sort(times);
    Time last{};
    for (const Time time : times) {
      if (time - last > trial_.longest_gap.length()) trial_.longest_gap = {last, time};
      last = time;
    }
  }

  static constexpr double kMostJump_s = 1.0;

  Trial& trial_;
  Time stamp_{};  ///< of the event at hand
  std::vector<Note> sample_notes_;
  std::vector<Time> state_stamps_;
  std::int64_t taken_ = 0;
};

}  // namespace

Trial read_log(std::span<const std::uint8_t> bytes) {
  Trial trial;
  Sorter sorter(trial);
  LogReader reader(bytes);
  while (const std::optional<LogEvent> event = reader.next()) {
    if (!sorter.add(*event)) break;
  }
  sorter.finish();
  trial.skipped.bytes = reader.skipped_bytes();
  trial.skipped.cut_bytes = reader.cut_bytes();
  return trial;
}

Trial read_log(const std::string& path) {
  const MappedFile file(path);
  Trial trial = read_log(file.bytes());
  if (trial.channels.empty()) {
    throw std::runtime_error(path + ": not an LCM event log: no whole event in " +
                             std::to_string(file.bytes().size()) + " bytes");
  }
  return trial;
}

Trial read_trial(const std::string& path, Time longest_gap) {
  Trial trial = read_log(path);
  if (!trial.has_header) {
    std::string found;
    for (const auto& [name, channel] : trial.channels) found += (found.empty() ? "" : ", ") + name;
    throw std::runtime_error(path + ": no message on " + std::string(kTrialChannel) +
                             " to say which trial this is; found " + found);
  }
  if (trial.header.format_version != kFormatVersion) {
    throw std::runtime_error(path + ": trial of format version " +
                             std::to_string(trial.header.format_version) + ", expected " +
                             std::to_string(kFormatVersion));
  }
  if (const Gap& gap = trial.longest_gap; gap.length() > longest_gap) {
    throw std::runtime_error(
        fmt::format("{}: no sample for {:.1f} s, from {:.3f} s on; expected {:.0f} s at most (if "
                    "that is meant: "
                    "--longest-gap)",
                    path, seconds(gap.length()), seconds(gap.from), seconds(longest_gap)));
  }
  return trial;
}

struct Recorder::File {
  std::string path;
  Options options;
  files::OutputFile output;
  lcm_eventlog_t* log = nullptr;
  Buffer bytes;            // of the message at hand
  std::int64_t size = 0;   // of the file, up to the last whole event
  std::int64_t count = 0;  // of messages
  Time last{};

  File(const std::string& name, const Options& how)
      : path(name),
        options(how),
        output(name, {.overwrite = how.overwrite,
                      .live = how.live,
                      .standard_output = true,
                      .inputs = how.inputs}) {
    // liblcm opens by name only, and would open what is there; so it opens nothing.
    std::FILE* file = fdopen(fcntl(output.descriptor(), F_DUPFD_CLOEXEC, 3), "w");
    log = file ? lcm_eventlog_create("/dev/null", "w") : nullptr;
    if (!log) throw std::runtime_error(path + ": cannot create: " + std::strerror(errno));
    std::fclose(std::exchange(log->f, file));
    setvbuf(log->f, nullptr, _IOFBF, 1 << 16);
  }

  ~File() {
    if (log) lcm_eventlog_destroy(log);
  }

  template <typename T>
  void write(std::string_view channel, Time time, const T& message) {
    if (!log) throw std::runtime_error(path + ": closed, nothing more can be written");
    encode(message, bytes);
    last = std::max(last, time);
    lcm_eventlog_event_t event{};
    event.timestamp = (options.epoch + last).count();
    event.channellen = static_cast<std::int32_t>(channel.size());
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.channel = const_cast<char*>(channel.data());
    event.data = bytes.data();
    if (lcm_eventlog_write_event(log, &event) != 0 || std::fflush(log->f) != 0) cut_back();
    constexpr std::int64_t kEventHeader = 28;
    size += kEventHeader + event.channellen + event.datalen;
    ++count;
  }

  /// Leaves the file with its whole events after a write that failed.
  [[noreturn]] void cut_back() {
    const int error = errno;
    __fpurge(log->f);  // else closing would try again
    const bool cut = ftruncate(fileno(log->f), size) == 0;
    lcm_eventlog_destroy(log);
    log = nullptr;
    throw std::runtime_error(path + ": cannot write event " + std::to_string(count) + ": " +
                             std::strerror(error) +
                             (cut && options.live ? "; the events before it are kept" : ""));
  }
};

Recorder::Recorder(const std::string& path, const TrialHeader& header, Options options)
    : file_(std::make_unique<File>(path, options)) {
  TrialHeader stamped = header;
  stamped.format_version = kFormatVersion;
  stamped.software_version = software_version();
  stamped.software_commit = software_commit();
  stamped.schema = schema_text();
  file_->write(kTrialChannel, Time{}, stamped);
}

Recorder::~Recorder() = default;

void Recorder::write(const Sample& sample) {
  if (const auto* tracker = std::get_if<TrackerSample>(&sample)) {
    file_->write(kTrackerChannel, available(sample), *tracker);
  } else {
    file_->write(kMouseChannel, available(sample), std::get<MouseSample>(sample));
  }
}

void Recorder::write(const Event& event) {
  file_->write(kEventChannel, event.time, event);
}

void Recorder::write(const TickState& state) {
  file_->write(kStateChannel, state.time, state);
}

void Recorder::write(const FrameRecord& frame) {
  file_->write(kFrameChannel, frame.time, frame);
}

void Recorder::require_kept() const {
  file_->output.require_kept(file_->size);
}

void Recorder::close() {
  Event end;
  end.time = file_->last;
  end.kind = kEndEvent;
  end.value = static_cast<double>(file_->count);
  write(end);
  require_kept();
  lcm_eventlog_destroy(file_->log);
  file_->log = nullptr;
  file_->output.commit();
}

void write(Recorder& recorder, std::span<const Sample> samples, std::span<const Event> events) {
  auto event = events.begin();
  for (const Sample& sample : samples) {
    for (; event != events.end() && event->time < available(sample); ++event) {
      recorder.write(*event);
    }
    recorder.write(sample);
  }
  for (; event != events.end(); ++event) recorder.write(*event);
}

}  // namespace headpin::devices
