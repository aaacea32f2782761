#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "devices/base/sources.h"
#include "scene/looks/looks.h"
#include "scene/play/session.h"
#include "scene/record/trial_events.h"
#include "scene/sound/hearing.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"

/// The session that a page plays: the same as a live one, with the samples that the page gives.
namespace headpin::scene {

/// Samples that are handed over one by one.
class GivenSamples : public devices::Source {
 public:
  void give(const devices::Sample& sample) { given_.push_back(sample); }
  void poll(Time now, std::vector<devices::Sample>& out) override;
  bool exhausted() const override { return false; }

 private:
  std::vector<devices::Sample> given_;
};

class PageSession {
 public:
  struct Options {
    std::string device;  ///< see browser_device.h
    bool left_hand = false;
    std::string participant, condition;
    std::uint64_t seed = 0;
    Time epoch{};  ///< wall clock at the session's start
  };

  /// Begins a session and its log.
  ///
  /// @param scenario  whole TOML, as a trial has it
  /// @throws std::invalid_argument  as scenario_of_trial, browser_device and check
  PageSession(std::string_view scenario, const Options& options);
  PageSession(const PageSession&) = delete;

  /// @param sample  of a tracker; its sequence number is put in here
  /// @throws std::invalid_argument  when its numbers are impossible
  void take(devices::TrackerSample sample);
  void take(const devices::MouseSample& sample);

  /// Writes an event that belongs to no tick.
  void note(std::string_view kind, std::string detail, double value);
  /// Writes that a frame was drawn.
  void drew(const FrameRecord& frame);

  /// Makes all ticks up to a time.
  /// @return  their number
  /// @throws std::runtime_error  when the state turns non-finite
  std::int64_t advance(Time until);

  /// What is visible after the last tick: whether skittles are drawn as ellipsoids, how closed the
  /// hand is, whether hand and head are seen, whether something is held; then poses (w, x, y, z, p):
  /// X_WP, X_WH, X_WD, each skittle, each ball.
  void see(std::vector<float>& out) const;

  /// Events since the last call, the score (and which versions have no game yet), the text of the score board, and the rings of oil on a
  /// ball (its number among the balls, and of_rings()); null if nothing of it is new.
  nlohmann::json take_news();

  /// What the player heard since the last call; nothing if the scenario has no sound.
  std::vector<StereoSample> take_sound();

  /// The bytes of the log since the last call.
  std::vector<std::uint8_t> take_log();

  /// Ends the log.
  ///
  /// @param frames  drawn; `late_frames` of them more than half a period too late
  /// @return  game hash, state hash, ticks, skittles down
  nlohmann::json finish(std::int64_t frames, std::int64_t late_frames);

 private:
  Session session_;
  DrawnCentres drawn_;
  std::vector<std::uint8_t> log_;
  std::optional<TrialWriter> writer_;
  GivenSamples given_;
  devices::MergedSource samples_;
  std::map<std::int32_t, std::int64_t> sequence_;  ///< of each station
  Totals totals_;
  std::vector<Event> news_;
  std::size_t told_rings_ = 0;
  std::vector<std::string> told_board_;
  std::optional<Hearing> hearing_;  ///< if the scenario has sound
  std::vector<StereoSample> heard_;
};

}  // namespace headpin::scene
