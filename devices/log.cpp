#include "devices/log.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
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
    } else if (trial_.has_header && std::holds_alternative<TrialHeader>(*message)) {
      ++trial_.skipped.other_trials;
      return false;
    } else {
      std::visit([&](auto& m) { take(m); }, *message);
      ++taken_;
    }
    return true;
  }

 private:
  void take(TrialHeader& header) {
    trial_.header = std::move(header);
    trial_.has_header = true;
  }
  void take(TrackerSample& sample) { take_sample(std::move(sample)); }
  void take(MouseSample& sample) { take_sample(sample); }
  void take(TickState& state) { trial_.states.push_back(std::move(state)); }
  void take(FrameRecord& frame) { trial_.frames.push_back(frame); }
  void take(Event& event) {
    if (event.kind == kEndEvent) {
      trial_.complete = event.value == static_cast<double>(taken_);
    } else {
      trial_.events.push_back(std::move(event));
    }
  }

  void take_sample(Sample sample) {
    const Time time = device_time(sample);
    const auto [last, is_first] = last_time_.try_emplace(device(sample), time);
    if (!is_first && time <= last->second) ++trial_.backwards;
    last->second = time;
    if (!trial_.states.empty() && available(sample) <= trial_.states.back().time) {
      const Time then = trial_.states.back().time + Time{1};
      std::visit([&](auto& s) { s.session_time = then; }, sample);
    }
    trial_.samples.push_back(std::move(sample));
  }

  Trial& trial_;
  std::map<std::int32_t, Time> last_time_;
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

Trial read_trial(const std::string& path) {
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

void Recorder::close() {
  Event end;
  end.time = file_->last;
  end.kind = kEndEvent;
  end.value = static_cast<double>(file_->count);
  write(end);
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
