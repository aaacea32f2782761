#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "devices/base/source.h"
#include "scene/record/log.h"

/// A trial on disk, which can be read repeatedly in constant memory.
namespace headpin::scene {

struct LogContent;  // content of a TrialFile
class TrialWalk;    // iterates over it

/// What a log contains. Reads it once, and once more if its samples are out of order.
TrialSummary summarise(const LogContent& log);

/// Why a log has no events: it is empty, cut short, or no log.
/// @param bytes  its size
std::string why_without_events(const TrialSummary& log, std::size_t bytes);

/// Where an incomplete trial ends and how much of it is unreadable: "is incomplete: it ends at 3.000 s;
/// 12 bytes of it cannot be read". Of a complete one, how many messages are wrong and not used.
/// Also whether another trial follows in the file. Empty if all is read.
std::string what_is_missing(const TrialSummary& trial);

/// A log that ends before its first event is whole: nothing more was written yet.
struct NotBegun : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A log that has been scanned once.
///
/// See read_log for what is skipped. It stores the summary, and which messages have a time that
/// disagrees with their neighbours.
class TrialFile {
 public:
  /// @throws NotBegun            when it ends before its first event is whole
  /// @throws std::runtime_error  when there is no such file or no event in it
  explicit TrialFile(const std::string& path);
  /// The same from the bytes of a log, which must outlive the object.
  explicit TrialFile(std::span<const std::uint8_t> bytes);
  ~TrialFile();
  TrialFile(TrialFile&&) noexcept;
  TrialFile& operator=(TrialFile&&) noexcept;

  const TrialSummary& summary() const { return summary_; }

  /// Throws an exception if the log is not a trial that can be simulated, like read_trial.
  void require_trial(Time longest_gap) const;

  /// The last snapshot of at most this time; nothing if there is none.
  /// @throws std::runtime_error  when the file cannot be read
  std::optional<Snapshot> last_snapshot(Time at) const;

  using Item = std::variant<devices::Sample, TickState, FrameRecord>;
  /// Calls `see` for each message in the order of the log, until it returns false.
  /// @throws std::runtime_error  when the file was changed in the meantime
  void walk(const std::function<bool(Item&)>& see) const;

 private:
  friend class TrialPlayer;
  friend class TrialItems;

  std::unique_ptr<const LogContent> content_;
  TrialSummary summary_;
};

/// Iterates over the messages that walk() passes.
class TrialItems {
 public:
  /// @param file  must outlive this
  explicit TrialItems(const TrialFile& file);
  ~TrialItems();
  TrialItems(TrialItems&&) noexcept;
  TrialItems& operator=(TrialItems&&) noexcept;

  /// The next one, nothing at the end.
  /// @throws std::runtime_error  when the file is another by now
  std::optional<TrialFile::Item> next();

  /// The next state, nothing at the end.
  std::optional<TickState> next_state();

 private:
  friend class TrialPlayer;
  TrialItems(const LogContent& log, const TrialSummary& summary);

  std::unique_ptr<TrialWalk> walk_;
};

/// A trial as a source: returns its samples by the time at which they were available, like
/// ReplaySource, and the recorded states and frames of the same ticks.
///
/// Its memory depends on how far the samples are out of order.
class TrialPlayer : public devices::Source {
 public:
  struct Beside {
    bool states = false, frames = false;
  };

  /// @param file    must outlive this
  /// @param beside  whether states or frames will be requested
  explicit TrialPlayer(const TrialFile& file, Beside beside);
  explicit TrialPlayer(const TrialFile& file) : TrialPlayer(file, Beside{}) {}

  /// @throws std::runtime_error  when the file is another by now
  void poll(Time now, std::vector<devices::Sample>& out) override;
  bool exhausted() const override { return ended_ && samples_.empty(); }
  /// When the next sample is available; nothing when there is none.
  std::optional<Time> next_time();

  bool has_states() const { return states_.left > 0 || !states_.read.empty(); }
  bool has_frames() const { return frames_.left > 0 || !frames_.read.empty(); }
  bool complete() const { return complete_; }  ///< nothing is missing, as TrialSummary::complete

  /// The recorded state of a tick, or nothing; ticks must increase from call to call.
  const TickState* state(std::int64_t tick) { return find(states_, tick); }
  /// The next recorded frame of a tick, or nothing. A tick has several where frames came faster than
  /// ticks: each call gives another one. Ticks must not decrease from call to call.
  std::optional<FrameRecord> next_frame(std::int64_t tick);

 private:
  template <typename T>
  struct Row {
    std::deque<T> read;
    std::int64_t left = 0;  ///< to be read
  };
  friend TrialSummary summarise(const LogContent& log);
  TrialPlayer(const LogContent& log, const TrialSummary& summary, Beside beside);
  template <typename T>
  const T* find(Row<T>& row, std::int64_t tick);
  void read();

  TrialItems items_;
  bool complete_;
  Time disorder_{};
  std::optional<Time> newest_;
  std::multimap<Time, devices::Sample> samples_;  // by when they are available
  Row<TickState> states_;
  Row<FrameRecord> frames_;
  bool ended_ = false;
};

}  // namespace headpin::scene
