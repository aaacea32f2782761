#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "devices/base/sample.h"

/// Samples <-> the bytes of LCM messages; pure functions.
namespace headpin::devices {

constexpr std::string_view kTrackerChannel = "TRACKER";
constexpr std::string_view kMouseChannel = "MOUSE3D";

using Buffer = std::vector<std::uint8_t>;

/// The status of a sample as a Fastrak may send it: a space, or a letter. It is 'x' for any other one,
/// such as the 0 of a publisher that sets none.
char status_letter(const TrackerSample& sample);

/// The status of a sample that is not good, as tables and streams have it: any character that can be printed,
/// and 'x' for other bytes.
char status_character(const TrackerSample& sample);

/// Writes the message into `out`, which is resized; its memory is reused.
void encode(const TrackerSample& sample, Buffer& out);
void encode(const MouseSample& sample, Buffer& out);

/// Decodes a message on one of the two channels; nothing on another, and nothing if its type, its size
/// or a length is wrong.
std::optional<Sample> decode_sample(std::string_view channel, std::span<const std::uint8_t> bytes);

/// Whether numbers are finite, quaternions unit to 1e-3, times less than 126 years from 0, a pose is
/// for at most a second from when it was told, counts not negative.
bool plausible(const Sample& sample);

}  // namespace headpin::devices
