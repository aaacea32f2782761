#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "devices/trial/sink.h"
#include "devices/trial/trial.h"

/// A trial on disk: one LCM event log, NAME.lcmlog, that lcm-logplayer can play.
namespace headpin::devices {

/// A longer time without a sample is taken for damage, unless somebody says that it is meant.
constexpr Time kLongestGap{60'000'000};

/// Reads a whole trial.
///
/// What cannot be used is passed over and counted, see Trial.
///
/// @param longest_gap  time without a sample that is not yet refused
/// @throws std::runtime_error  when there is no such file, no event in it, no header, a header of a
///                             format version not known here, or a longer gap
Trial read_trial(const std::string& path, Time longest_gap = kLongestGap);

/// Reads whatever a log holds, header or not.
///
/// A sample or a state is dropped when its time, or a state's tick, jumps away from those before it
/// and after it by more than a second, while the log's own stamps go on: a flipped bit does that.
/// A jump that lasts, as of a publisher that started again, is kept.
///
/// Samples of a session say themselves when it got them. In logs from before they did, one that
/// stands behind a state although it was there before it reached the session only then; its
/// `session_time` is put just behind the state's.
///
/// @throws std::runtime_error  when there is no such file or no event in it
Trial read_log(const std::string& path);

/// The same from the bytes of a log; never throws for what is in them.
Trial read_log(std::span<const std::uint8_t> bytes);

/// How states are told: all of them whole, or most by what is new in them (state_change_t).
enum class States { all, changes };

/// A header with what this program says of itself: format, version, commit and schema.
TrialHeader stamped(TrialHeader header, States states = States::all);

/// Writes a trial through liblcm's event log, each message whole before the next begins.
///
/// The file is a files::OutputFile: whole under its name or not there, unless it is live.
/// Every message goes to the file at once, so that a process killed at any moment leaves a log that
/// reads up to its last whole event. When the disk is full the file is cut back to that event.
class Recorder : public TrialSink {
 public:
  struct Options {
    bool overwrite = false;  ///< else an existing file is refused
    bool live = false;       ///< under the final name from the start, to survive anything
    std::vector<std::filesystem::path> inputs = {};  ///< never to be written to
    States states = States::all;
    Time epoch{};  ///< added to the stamps of LCM's event headers; wall clock of time 0, if any
  };

  /// Opens the file and writes the header, with format, software and schema put in.
  ///
  /// @param path  `-` is standard output
  /// @throws std::runtime_error  when the file exists and is not to be overwritten, or cannot be
  ///                             made
  /// @throws files::Busy         when another process is writing it
  Recorder(const std::string& path, const TrialHeader& header, const Options& options);
  Recorder(const std::string& path, const TrialHeader& header)
      : Recorder(path, header, Options{}) {}

  /// Without close(): a live file stays as it is, another one is removed.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// @throws std::runtime_error  when nothing more can be written; what was written before stays
  void write(const Sample& sample) override;
  void write(const Event& event) override;
  void write(const TickState& state) override;
  void write(const FrameRecord& frame) override;

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

/// Writes samples and events, each in the order they have, mixed by when they were available.
void write(Recorder& recorder, std::span<const Sample> samples, std::span<const Event> events);

}  // namespace headpin::devices
