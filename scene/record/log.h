#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "devices/log/event_log.h"
#include "scene/record/sink.h"
#include "scene/record/trial.h"
#include "scene/record/trial_events.h"

namespace headpin::base {
class OutputFile;
}

/// A trial on disk: one LCM event log, NAME.lcmlog, that lcm-logplayer can play.
namespace headpin::scene {

/// A gap between samples is longer than what is accepted.
struct LongGap : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a whole trial.
///
/// Unusable messages are skipped and counted, see Trial.
///
/// @param longest_gap  longest accepted gap between samples
/// @throws std::runtime_error  when there is no such file, no event in it, no header, a header of a
///                             format version not known here, or a longer gap
Trial read_trial(const std::string& path, Time longest_gap = devices::kLongestGap);

/// Reads any log, with or without a header.
///
/// A sample or a state is dropped when its time, or a state's tick, jumps away from those before it
/// and after it by more than a second, while the log's own stamps go on: a flipped bit does that.
/// A jump that lasts, as of a publisher that started again, is kept. The first and the last of a device are
/// dropped only if other messages there, or the sample's own other times, show that the stamps did not jump.
///
/// Samples of a session have the time at which the session used them. In older logs, a sample that
/// follows a state although it was available before reached the session only then; its
/// `session_time` is set just after the state's.
///
/// @throws std::runtime_error  when there is no such file or no event in it
Trial read_log(const std::string& path);

/// The same from the bytes of a log; never throws for what is in them.
Trial read_log(std::span<const std::uint8_t> bytes);

/// Writes a trial through liblcm's event log, each message whole before the next begins.
///
/// The file is complete under its name or absent, unless it is live. Every message is written at once, so a killed process leaves a log that is readable up to its last
/// complete event. When the disk is full, the file is truncated to that event.
class Recorder : public TrialSink {
 public:
  using Options = TrialEvents::Options;

  /// Writes the header, with format, software and schema put in.
  ///
  /// @param output  open and empty; a live one is synced to the disk every second
  Recorder(base::OutputFile output, const TrialHeader& header, const Options& options);
  Recorder(base::OutputFile output, const TrialHeader& header);
  /// Opens a new file.
  /// @param path  `-` is standard output
  /// @throws as base::OutputFile
  Recorder(const std::string& path, const TrialHeader& header);

  /// Without close(): a live file stays as it is, another one is removed.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// @throws std::runtime_error  when nothing more can be written; earlier messages stay
  void write(const devices::Sample& sample) override;
  void write(const Event& event) override;
  void write(const TickState& state) override;
  void write(const FrameRecord& frame) override;
  void write(const Snapshot& snapshot) override;

  /// @throws std::runtime_error  when the live file was deleted, replaced, moved or cut by another
  void require_kept() const override;

  /// Writes the end event and gives the file its final name.
  ///
  /// @throws std::runtime_error  as write() and require_kept()
  void close() override;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Writes samples and events in the order in which they were available.
void write(Recorder& recorder, std::span<const devices::Sample> samples,
           std::span<const Event> events);

}  // namespace headpin::scene
