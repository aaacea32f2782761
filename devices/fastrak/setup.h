#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/base/bytes.h"
#include "devices/fastrak/codec.h"

/// The settings that a driver gives to a Fastrak, and how it reads them back.
namespace headpin::devices {

/// A direction for each station.
using FastrakZeniths = std::array<Vec3, kFastrakStations>;

/// Factory values: every receiver is ahead of the transmitter.
inline FastrakZeniths zeniths_ahead() {
  FastrakZeniths zeniths;
  zeniths.fill(Vec3::UnitX());
  return zeniths;
}

/// Reads `X,Y,Z`, for all stations, or `STATION:X,Y,Z`, into the zeniths.
///
/// @throws std::invalid_argument  naming the text and what was expected; nothing is changed then
void read_zenith(std::string_view text, FastrakZeniths& zeniths);

/// Options of the driver.
struct FastrakOptions {
  /// Output list of all stations: a position, an orientation, anything else, and a space or CR LF
  /// at the end, by which records are told apart.
  std::vector<int> items = {2, 11, 16, 1};
  bool binary = true;
  bool centimetres = true;
  std::array<bool, kFastrakStations> stations = {true, true, true, true};  ///< wanted, if plugged
  /// In T, into the half-space that a station's receiver stays in; of any length. 0,0,0: it starts
  /// ahead of the transmitter, and the unit follows it from there.
  FastrakZeniths zenith = zeniths_ahead();
  int baud = 115200;          ///< the line's rate
  bool search_baud = true;    ///< try the other rates when nothing is heard at this one
  Time watchdog{2'000'000};   ///< without a record: start again
  Time quiet{150'000};        ///< without a byte: the unit has stopped
  Time answer{1'000'000};     ///< longest wait for an answer
  Time command_gap{20'000};   ///< between commands
  Time start_up{10'000'000};  ///< silence after ^Y
};

/// The form of the orientation in records.
enum class FastrakAttitude { quaternion, matrix, angles };

/// The best form in an output list.
/// @throws std::invalid_argument  when there is none
FastrakAttitude attitude_of(const std::vector<int>& items);

/// The pose in a record; its orientation from the best form in the output list.
/// @throws std::invalid_argument  when the list has no orientation
Pose pose_of(const FastrakRecord& record, const FastrakFormat& format);

/// @throws std::invalid_argument  when the list lacks a position, an orientation or an end
void check_items(const std::vector<int>& items);

/// A question to the unit, and the expected answer.
struct FastrakCheck {
  char letter = 'S';  ///< S, or the command that reads a station's setting back
  int station = 0;    ///< 1 to 4; 0 of the whole unit
  std::vector<double> values;
  bool must = true;  ///< records would be wrong if the answer is different
};

enum class FastrakVerdict { no_answer, as_said, otherwise };

/// Commands that set the unit and each station as the options say, one command each.
std::vector<std::string> setup_commands(const FastrakOptions& options);

/// Commands that start records as the options say.
std::vector<std::string> stream_commands(const FastrakOptions& options);

/// The settings to read back from a station.
std::vector<FastrakCheck> setup_checks(const FastrakOptions& options, int station);

/// The command that asks for it.
std::string question(const FastrakCheck& check);

/// The verdict on the bytes since the question; the answer may be anywhere in them.
FastrakVerdict judge(const FastrakCheck& check, const FastrakOptions& options, Bytes heard);

/// The first `length` consecutive bytes that `decode` accepts.
template <typename Decode>
auto find_answer(Bytes heard, std::size_t length, Decode decode) {
  const std::string_view text(reinterpret_cast<const char*>(heard.data()), heard.size());
  for (std::size_t at = 0; at + length <= text.size(); ++at) {
    if (auto answer = decode(text.substr(at, length))) return answer;
  }
  return decltype(decode(text))();
}

}  // namespace headpin::devices
