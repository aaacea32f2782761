#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "devices/log/event_log.h"
#include "scene/record/messages.h"
#include "scene/record/trial.h"

namespace headpin::scene {

/// Adds a fault to the list, or to the last entry of the same kind and device if that is near.
void note_trouble(TrialSummary& summary, const char* kind, const std::string& of, Time at,
                  std::int64_t messages = 1);

/// Iterates over the messages of a trial. Unusable messages are skipped and counted.
class Messages {
 public:
  /// @param session  read the trial that a session published, not its inputs
  /// @param doubled  numbers of messages to leave out, rising; must outlive this
  Messages(devices::LogReader reader, bool session, std::span<const std::int64_t> doubled = {})
      : reader_(reader), session_(session), doubled_(doubled) {}

  /// The next sample, event, state, snapshot or frame; nothing at the end or when another trial begins.
  std::optional<Message> next();

  /// Number and time stamp of the current message; a snapshot has no number of its own.
  std::int64_t number() const { return taken_ - 1; }
  Time stamp() const { return stamp_; }
  Time since_first() const { return stamp_ - *first_stamp_; }
  /// The current message as it is in the log, or the one before a snapshot; valid until the next one.
  std::span<const std::uint8_t> bytes() const { return bytes_; }

  /// Channels, header, skipped messages, and whether the log has its end.
  TrialSummary& counted() { return counted_; }

 private:
  std::optional<Message> take(const devices::LogEvent& event);
  void take(TrialHeader& header);
  bool is_doubled();

  devices::LogReader reader_;
  bool session_, over_ = false;
  std::span<const std::int64_t> doubled_;  ///< those still ahead
  std::span<const std::uint8_t> bytes_;
  bool drawn_by_ = false;  ///< has been returned
  std::int64_t taken_ = 0, ends_ = 0;
  Time stamp_{};
  std::optional<Time> first_stamp_;
  TrialSummary counted_;
};

}  // namespace headpin::scene
