#include "scene/record/log.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <sched.h>
#include <stdio_ext.h>
#include <unistd.h>

#include "base/output_file.h"
#include "devices/base/sources.h"
#include "scene/record/file.h"
#include "scene/record/messages.h"
#include "scene/record/state_change.h"

namespace headpin::scene {

namespace {

Trial whole(const TrialFile& file) {
  Trial trial;
  static_cast<TrialSummary&>(trial) = file.summary();
  file.walk([&](TrialFile::Item& item) {
    if (auto* sample = std::get_if<devices::Sample>(&item))
      trial.samples.push_back(std::move(*sample));
    if (auto* state = std::get_if<TickState>(&item)) trial.states.push_back(std::move(*state));
    if (const auto* frame = std::get_if<FrameRecord>(&item)) trial.frames.push_back(*frame);
    return true;
  });
  return trial;
}

}  // namespace

Trial read_log(std::span<const std::uint8_t> bytes) {
  return whole(TrialFile(bytes));
}

Trial read_log(const std::string& path) {
  return whole(TrialFile(path));
}

Trial read_trial(const std::string& path, Time longest_gap) {
  const TrialFile file(path);
  file.require_trial(longest_gap);
  return whole(file);
}

struct Recorder::File {
  base::OutputFile output;
  lcm_eventlog_t* log = nullptr;
  std::int64_t size = 0;  // of the file, up to the last whole event
  std::optional<TrialEvents> events;
  std::atomic<bool> unsynced = false;
  std::jthread syncing;  // last member, so that it ends before the others

  explicit File(base::OutputFile file_to_write) : output(std::move(file_to_write)) {
    // liblcm can only open a name and would open an existing file. So it opens /dev/null.
    std::FILE* file = fdopen(fcntl(output.descriptor(), F_DUPFD_CLOEXEC, 3), "w");
    log = file ? lcm_eventlog_create("/dev/null", "w") : nullptr;
    if (!log) throw std::runtime_error(output.path() + ": cannot create: " + std::strerror(errno));
    std::fclose(std::exchange(log->f, file));
    setvbuf(log->f, nullptr, _IOFBF, 1 << 16);
    if (output.live()) {
      syncing = std::jthread([this](const std::stop_token& stopped) { sync_until(stopped); });
    }
  }

  ~File() {
    if (log) lcm_eventlog_destroy(log);
  }

  /// Syncs the written data to the disk every second, in parallel with the session, because a disk
  /// may be slow.
  void sync_until(const std::stop_token& stopped) {
    const sched_param as_others{};  // normal priority, whatever that of the session's ticks is
    sched_setscheduler(0, SCHED_OTHER, &as_others);
    std::mutex none;
    std::condition_variable_any nap;
    std::unique_lock lock(none);
    while (!nap.wait_for(lock, stopped, std::chrono::seconds(1), [] { return false; }) &&
           !stopped.stop_requested()) {
      try {
        output.sync();
      } catch (const std::exception&) {
        unsynced = true;
      }
    }
  }

  void write(const devices::LogEvent& event) {
    if (!log) throw std::runtime_error(output.path() + ": is closed; nothing more can be written");
    if (unsynced)
      throw std::runtime_error(output.path() + ": the disk did not store what was written");
    lcm_eventlog_event_t out{};
    out.timestamp = event.time.count();
    out.channellen = static_cast<std::int32_t>(event.channel.size());
    out.datalen = static_cast<std::int32_t>(event.data.size());
    out.channel = const_cast<char*>(event.channel.data());
    out.data = const_cast<std::uint8_t*>(event.data.data());
    if (lcm_eventlog_write_event(log, &out) != 0 || std::fflush(log->f) != 0) {
      cut_back(event.number);
    }
    constexpr std::int64_t kEventHeader = 28;
    size += kEventHeader + out.channellen + out.datalen;
  }

  /// After a failed write, truncates the file to its complete events.
  [[noreturn]] void cut_back(std::int64_t number) {
    const int error = errno;
    __fpurge(log->f);  // otherwise close would try again
    const bool cut = output.cut_back(size);
    lcm_eventlog_destroy(log);
    log = nullptr;
    throw std::runtime_error(output.path() + ": cannot write event " + std::to_string(number) +
                             ": " + std::strerror(error) +
                             (cut && output.live() ? "; the events before it are kept" : ""));
  }
};

Recorder::Recorder(base::OutputFile output, const TrialHeader& header, const Options& options)
    : file_(std::make_unique<File>(std::move(output))) {
  file_->events.emplace(header, options, [file = file_.get()](const devices::LogEvent& event) {
    file->write(event);
  });
}

Recorder::Recorder(base::OutputFile output, const TrialHeader& header)
    : Recorder(std::move(output), header, Options{}) {}

Recorder::Recorder(const std::string& path, const TrialHeader& header)
    : Recorder(base::OutputFile(path, {.standard_output = true}), header) {}

Recorder::~Recorder() = default;

void Recorder::write(const devices::Sample& sample) {
  file_->events->write(sample);
}

void Recorder::write(const Event& event) {
  file_->events->write(event);
}

void Recorder::write(const TickState& state) {
  file_->events->write(state);
}

void Recorder::write(const FrameRecord& frame) {
  file_->events->write(frame);
}

void Recorder::write(const Snapshot& snapshot) {
  file_->events->write(snapshot);
}

void Recorder::require_kept() const {
  file_->output.require_kept(file_->size);
}

void Recorder::close() {
  file_->events->close();
  require_kept();
  file_->syncing = {};
  lcm_eventlog_destroy(file_->log);
  file_->log = nullptr;
  file_->output.commit();
}

void write(Recorder& recorder, std::span<const devices::Sample> samples,
           std::span<const Event> events) {
  auto event = events.begin();
  for (const devices::Sample& sample : samples) {
    for (; event != events.end() && event->time < devices::available(sample); ++event) {
      recorder.write(*event);
    }
    if (!devices::plausible(sample)) {
      throw std::invalid_argument(fmt::format("sample at {:.6f} s: its numbers are impossible",
                                              seconds(devices::available(sample))));
    }
    recorder.write(sample);
  }
  for (; event != events.end(); ++event) recorder.write(*event);
}

}  // namespace headpin::scene
