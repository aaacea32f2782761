#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "devices/base/sample.h"
#include "scene/record/details.h"

/// The parts of a trial as plain data: all inputs and outputs of one session.
namespace headpin::scene {

/// First message of every trial; over LCM it is repeated for later listeners.
struct TrialHeader {
  std::string participant;
  std::string condition;
  std::uint64_t seed = 0;
  std::string scenario;                 ///< TOML, whole
  std::vector<std::string> body_names;  ///< of the bodies of each TickState, in their order

  // The Recorder sets these.
  std::int32_t format_version = 0;
  std::string software_version;
  std::string software_commit;
  std::string schema;  ///< text of the .lcm files

  bool operator==(const TrialHeader&) const = default;
};

constexpr std::int32_t kFormatVersion = 1;         ///< every state is whole
constexpr std::int32_t kChangesFormatVersion = 2;  ///< most are stored as changes

/// An event. Vectors are in the world frame W; values that do not apply are zero or empty.
struct Event {
  Time time{};
  std::int64_t tick = -1;  ///< of the simulation; -1 outside it
  std::string kind;        ///< see scene/record/events.h
  std::vector<std::string> bodies;
  Vec3 p_W = Vec3::Zero();  ///< where [m]
  Vec3 j_W = Vec3::Zero();  ///< impulse on the first body [N s]
  double value = 0.0;       ///< what the kind says
  Detail detail;
};

/// Kind of the last event of a finished log; its value counts the messages before it.
constexpr const char* kEndEvent = "end";

/// Kind of the event that says what drew the frames (scene/watch/drawn_by.h). A publisher repeats
/// it with the header; the first one counts.
constexpr const char* kDrawnByEvent = "drawn_by";

struct BodyState {
  Pose X_WB;
  Twist V_WB;
  bool asleep = false;
};

/// The world after one tick: its visible state, which the hash covers.
///
/// The engine's memory between ticks (`engine::Memory`) is left out. A world that starts from this
/// state continues similarly, but not with equal bits; for those, replay the samples.
struct TickState {
  Time time{};
  std::int64_t tick = 0;
  std::uint64_t hash = 0;  ///< of the bits of tick, poses, velocities and sleep flags
  std::int32_t contacts = 0;
  std::vector<BodyState> bodies;
};

/// A session after one tick, saved: a replay can start there (scene/play/save.h). It is an aid: a
/// trial without it has the same content, and the end event does not count it.
struct Snapshot {
  Time time{};
  std::int64_t tick = 0;
  std::vector<std::uint8_t> saved;
};

/// One rendered frame.
struct FrameRecord {
  Time time{};
  std::int64_t frame = 0;
  std::int64_t tick = 0;
  std::array<Pose, 2> X_WE;             ///< left and right eye: x right, y up, looking along -z
  std::array<std::uint64_t, 2> hash{};  ///< of the pixels of each
};

/// Messages of one channel of a log.
struct Channel {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  Time first{}, last{};  ///< stamps of LCM's event headers
};

/// Parts that were skipped when a log was read.
struct Skipped {
  std::int64_t bytes = 0;        ///< between events or of events that do not hold together
  std::int64_t cut_bytes = 0;    ///< of an event the file ends in
  std::int64_t undecodable = 0;  ///< messages on our channels with a wrong type or size
  std::int64_t implausible =
      0;  ///< messages with NaN, quaternions not unit, times or places out of range
  std::int64_t other_trials = 0;  ///< a second header: what follows it is another trial
  std::int64_t foreign = 0;       ///< samples in another frame than the transmitter's
  std::int64_t baseless = 0;      ///< states stored as changes from an unknown state
  std::int64_t doubled = 0;       ///< messages that equal an earlier one to the byte
  std::int64_t misdated = 0;      ///< samples and states whose time, unlike those around them, is
                                  ///< another than the log's

  bool nothing() const {
    return bytes + cut_bytes + undecodable + implausible + other_trials + foreign + baseless +
               doubled + misdated ==
           0;
  }
};

/// Consecutive messages with the same fault, at most a second apart.
struct Trouble {
  std::string
      kind;  ///< undecodable, implausible, foreign, baseless, doubled, misdated, late, lost, astray
  std::string device;  ///< whose samples, or the channel
  std::int64_t messages = 0;
  Time from{}, to{};  ///< by the stamps of LCM's event headers, since the log's first
};
constexpr std::size_t kMostTroubles = 100;  ///< that are kept; all of them are counted

/// Samples of one device.
struct DeviceSummary {
  std::int64_t samples = 0;
  Time first{}, last{};
  Time longest_gap{};
  std::int64_t lost = 0;       ///< holes in the sequence
  std::int64_t bad = 0;        ///< with a status other than good
  std::int64_t estimated = 0;  ///< with a position that the device did not track
  std::int64_t astray = 0;     ///< single samples 0.1 m and 50 m/s or more from those around
};

/// A stretch of time in which no sample became available.
struct Gap {
  Time from{}, to{};
  Time length() const { return to - from; }
};

/// The summary of a log, without its samples, states and frames.
struct TrialSummary {
  bool has_header = false;
  TrialHeader header;
  std::vector<Event> events;  ///< without the end event
  std::int64_t sample_count = 0, state_count = 0, frame_count = 0;
  std::map<devices::Device, DeviceSummary> devices;
  std::optional<Time> first, last;  ///< of the times of samples, states and frames
  Time end{};                       ///< when the last sample is available
  Time session_end{};               ///< when the session ended, as an event says; 0 if none does
  Time disorder{};             ///< most that a sample is available before an earlier one in the log
  std::int64_t last_tick = 0;  ///< of the last state
  std::size_t bodies = 0;      ///< in it

  std::map<std::string, Channel> channels;  ///< foreign ones too
  Skipped skipped;
  std::vector<Trouble> trouble;
  std::int64_t backwards = 0;  ///< samples not later than the one before of the same device
  std::int64_t late = 0;       ///< samples that the session used later than they were available
  Gap longest_gap;             ///< from 0 to the first sample, from one to the next, or from the
                               ///< last one to session_end
  bool complete = false;       ///< the end event is there, and all messages it counts
};

/// A whole trial, as read from a log.
struct Trial : TrialSummary {
  std::vector<devices::Sample> samples;  ///< in the order of the log
  std::vector<TickState> states;
  std::vector<FrameRecord> frames;
};

}  // namespace headpin::scene
