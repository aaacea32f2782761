#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "devices/trial/event_log.h"
#include "devices/trial/messages.h"
#include "devices/trial/trial.h"

namespace headpin::devices {

/// Adds to the troubles of a trial, to the last one of its kind and device if that is near.
void note_trouble(TrialSummary& summary, const char* kind, const std::string& of, Time at,
                  std::int64_t messages = 1);

/// The messages of a trial, one after the other. What cannot be used is passed over and counted.
class Messages {
 public:
  /// @param session  the trial is what a session published, not what it listened to
  Messages(LogReader reader, bool session) : reader_(reader), session_(session) {}

  /// The next sample, event, state or frame, nothing at the end or where another trial begins.
  std::optional<Message> next();

  /// Of the message at hand: its number among all that were taken, and its stamp.
  std::int64_t number() const { return taken_ - 1; }
  Time stamp() const { return stamp_; }
  Time since_first() const { return stamp_ - *first_stamp_; }

  /// Channels, header, what was passed over, and whether the end was there.
  TrialSummary& counted() { return counted_; }

 private:
  std::optional<Message> take(const LogEvent& event);
  void take(TrialHeader& header);

  LogReader reader_;
  bool session_, over_ = false;
  bool drawn_by_ = false;  ///< has been told
  std::int64_t taken_ = 0;
  Time stamp_{};
  std::optional<Time> first_stamp_;
  TrialSummary counted_;
};

}  // namespace headpin::devices
