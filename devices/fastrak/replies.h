#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/fastrak/codec.h"

/// Answers of a Fastrak other than data records: status, settings, refusals.
namespace headpin::devices {

/// The answer to the command S (p. 68).
struct FastrakStatus {
  int station = 1;
  bool binary = false;
  bool centimetres = false;
  bool compensation = false;
  bool continuous = false;
  int error = 0;                    ///< built-in-test number, 0 none
  std::string tag;                  ///< columns 11 to 15: blank before 2012, then "F3" and a map
  std::string firmware = "103.00";  ///< 6 characters
  std::string identification;       ///< 32 characters, the X string
};

constexpr std::size_t kFastrakStatusLength = 55;
std::string encode_status(const FastrakStatus& status);

/// @return  nothing unless it is a whole status record, CR LF included
std::optional<FastrakStatus> decode_status(std::string_view line);

/// A type-2 record: `2`, station or blank, command letter, body, CR LF.
///
/// @param station  1 to 4, or 0 for a blank
std::string encode_reply(int station, char command, std::string_view body);

/// Answer to `l`: which of the stations 1 to 4 are on, e.g. `21l1100`.
std::string encode_active(int station, const std::array<bool, kFastrakStations>& on);
std::optional<std::array<bool, kFastrakStations>> decode_active(std::string_view line);

/// Answer to `O`: the output list in columns of two, e.g. `21O 2 4 1`.
std::string encode_list(int station, std::span<const int> items);
std::optional<std::vector<int>> decode_list(std::string_view line, int station);

/// Why a command was refused (p. 89).
enum class FastrakRefusal {
  field_missing = -1,
  not_numeric = -2,
  out_of_range = -3,
  no_frequency = -4,
  buffer_limit = -5,
  unknown_command = -99,
};

/// The record that answers a refused command. Its parts are the manual's, the blanks between them
/// and the widths of its numbers our choice; unprintable bytes of the command show as '?'.
///
/// @param position  of the offending character, from 0
/// @param field     from 0 after the letter
/// @param station   1 to 4
std::string encode_refusal(std::string_view command, FastrakRefusal why, std::size_t position,
                           std::size_t field, int station);

/// The meaning of a built-in-test number (p. 71); empty for an unknown one.
std::string_view fastrak_error_text(int number);

}  // namespace headpin::devices
