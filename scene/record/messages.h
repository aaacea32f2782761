#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "devices/log/sample_messages.h"
#include "scene/record/state_change.h"
#include "scene/record/trial.h"

/// What a trial consists of <-> the bytes of LCM messages; pure functions. Those of samples are in
/// devices/log/sample_messages.h.
namespace headpin::scene {

constexpr std::string_view kTrialChannel = "HEADPIN_TRIAL";
constexpr std::string_view kEventChannel = "EVENT";
constexpr std::string_view kStateChannel = "STATE";
constexpr std::string_view kStateChangeChannel = "STATE_CHANGE";
constexpr std::string_view kSnapshotChannel = "SNAPSHOT";
constexpr std::string_view kFrameChannel = "FRAME";

/// Prefix of the channels of a session's own trial, which distinguishes them from its inputs:
/// SESSION_STATE.
constexpr std::string_view kSessionPrefix = "SESSION_";

/// Writes the message into `out`, which is resized; its memory is reused.
///
/// @throws std::invalid_argument  when a list is longer than a message can hold
void encode(const TrialHeader& header, devices::Buffer& out);
void encode(const Event& event, devices::Buffer& out);
void encode(const TickState& state, devices::Buffer& out);
void encode(const StateChange& change, devices::Buffer& out);
void encode(const Snapshot& snapshot, devices::Buffer& out);
void encode(const FrameRecord& frame, devices::Buffer& out);

/// Any message of a trial.
using Message = std::variant<TrialHeader, devices::TrackerSample, devices::MouseSample, Event,
                             TickState, StateChange, Snapshot, FrameRecord>;

/// Whether headpin decodes messages on `channel`.
bool is_trial_channel(std::string_view channel);

/// Decodes a message on one of our channels; nothing if its type, its size or a length is wrong.
std::optional<Message> decode(std::string_view channel, std::span<const std::uint8_t> bytes);

/// Whether numbers are finite, quaternions unit to 1e-3, times less than 126 years from 0, counts
/// not negative.
bool plausible(const Message& message);

}  // namespace headpin::scene
