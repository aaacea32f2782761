#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "devices/log/event_log.h"
#include "scene/play/score.h"
#include "scene/record/messages.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// A log that is read while it comes in, for those who watch the session. Memory does not grow with
/// the log, but for its throws. It accepts any bytes.
class FollowedLog {
 public:
  /// @param played  the scenario of the session, as some device plays it. Of the one that the log has,
  ///                only a usable rig is used: a log that comes from elsewhere must cost no work here
  explicit FollowedLog(const Scenario& played = {}) : scenario_(played) {}

  /// @param piece  the bytes that follow those before
  void add(std::span<const std::uint8_t> piece);

  /// How the session is going: tick, time, score, frames, tracking, and where everything is drawn, as
  /// PageSession::see() has it (quaternion w, x, y, z, then place [m], in the world).
  nlohmann::json state() const;

  /// Whether the log's end has come.
  bool ended() const { return ended_; }

 private:
  void take(const devices::LogEvent& event);
  void take(const TrialHeader& header);
  void take(const devices::TrackerSample& sample);
  void take(const devices::MouseSample&) {}
  void take(const Event& event);
  void take(const TickState& state);
  void take(const StateChange& change);
  void take(const Snapshot&) {}
  void take(const FrameRecord& frame);

  void watch_hand();
  bool shows_ellipsoids() const;
  double raised() const;
  std::optional<Pose> head() const;
  std::optional<Pose> hand() const;
  double closed() const;
  double frame_rate_hz() const;

  std::vector<std::uint8_t> rest_;  ///< an event that is not whole yet
  std::int64_t unusable_ = 0;       ///< bytes and messages that cannot be read
  bool ended_ = false;
  std::optional<TrialHeader> header_;
  Scenario scenario_;  ///< of the version that is played, with the log's rig
  /// Heights of a skittle's origin above its base [m]: as the session begins, in red, in blue.
  std::array<double, 3> centres_{};
  std::size_t version_ = 0;  ///< of centres_
  StateHistory history_;
  TickState last_;
  Score score_;
  std::map<std::int32_t, Pose> X_TS_;  ///< of each station, the last good one
  std::set<std::string> lost_;         ///< what is not tracked now
  std::int64_t times_lost_ = 0, pauses_ = 0, frames_ = 0;
  bool holds_ = false;                     ///< the hand, something
  std::size_t held_ = 0;                   ///< which of the bodies; too large where that is unknown
  std::optional<std::int64_t> grip_tick_;  ///< of the last grab or release
  std::deque<Time> frame_times_;           ///< of the last ones
  std::optional<FrameRecord> frame_;
  std::string played_with_;
};

}  // namespace headpin::scene
