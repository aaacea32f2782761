#include "devices/fastrak/replies.h"

#include <algorithm>
#include <charconv>

namespace headpin::devices {
namespace {

bool ends_line(std::string_view line) {
  return line.ends_with("\r\n");
}

std::string padded(std::string_view text, std::size_t width) {
  std::string out(text.substr(0, width));
  out.resize(width, ' ');
  return out;
}

std::string right_justified(long long number, std::size_t width) {
  std::string digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), ' ') + digits;
}

}  // namespace

std::string encode_reply(int station, char command, std::string_view body) {
  std::string line = "2";
  line += station == 0 ? ' ' : static_cast<char>('0' + station);
  line += command;
  line += body;
  return line + "\r\n";
}

std::string encode_status(const FastrakStatus& status) {
  // Bits 4 to 9 are always set: 3F0 is a unit in ASCII, inches, not continuous.
  const int flags = 0x3F0 | (status.binary ? 1 : 0) | (status.centimetres ? 2 : 0) |
                    (status.compensation ? 4 : 0) | (status.continuous ? 8 : 0);
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string body;
  for (const int shift : {8, 4, 0}) body += kHex[(flags >> shift) & 0xF];
  body += right_justified(status.error, 3) + " " + padded(status.tag, 5);
  body += padded(status.firmware, 6) + padded(status.identification, 32);
  return encode_reply(status.station, 'S', body);
}

std::optional<FastrakStatus> decode_status(std::string_view line) {
  if (line.size() != kFastrakStatusLength || line[0] != '2' || line[1] < '1' || line[1] > '4' ||
      line[2] != 'S' || !ends_line(line)) {
    return std::nullopt;
  }
  unsigned flags = 0;
  const auto hex = std::from_chars(line.data() + 3, line.data() + 6, flags, 16);
  if (hex.ec != std::errc{} || hex.ptr != line.data() + 6) return std::nullopt;
  FastrakStatus status;
  const std::string_view number = line.substr(6, 3);
  if (const auto digits = number.find_first_not_of(' '); digits != std::string_view::npos) {
    const auto end = number.data() + number.size();
    const auto read = std::from_chars(number.data() + digits, end, status.error);
    if (read.ec != std::errc{} || read.ptr != end || status.error < 0) return std::nullopt;
  }
  status.station = line[1] - '0';
  status.binary = flags & 1;
  status.centimetres = flags & 2;
  status.compensation = flags & 4;
  status.continuous = flags & 8;
  status.tag = line.substr(10, 5);
  status.firmware = line.substr(15, 6);
  status.identification = line.substr(21, 32);
  return status;
}

std::string encode_active(int station, const std::array<bool, kFastrakStations>& on) {
  std::string body;
  for (const bool active : on) body += active ? '1' : '0';
  return encode_reply(station, 'l', body);
}

std::optional<std::array<bool, kFastrakStations>> decode_active(std::string_view line) {
  if (line.size() != 9 || line[0] != '2' || line[2] != 'l' || !ends_line(line)) {
    return std::nullopt;
  }
  std::array<bool, kFastrakStations> on{};
  for (std::size_t i = 0; i < on.size(); ++i) {
    const char c = line[3 + i];
    if (c != '0' && c != '1') return std::nullopt;
    on[i] = c == '1';
  }
  return on;
}

std::string encode_list(int station, std::span<const int> items) {
  std::string body;
  for (const int item : items) body += right_justified(item, 2);
  return encode_reply(station, 'O', body);
}

std::optional<std::vector<int>> decode_list(std::string_view line, int station) {
  if (line.size() < 5 || line[0] != '2' || line[1] != '0' + station || line[2] != 'O' ||
      !ends_line(line)) {
    return std::nullopt;
  }
  std::vector<int> items;
  for (std::size_t at = 3; at + 2 < line.size(); at += 2) {
    const char tens = line[at], ones = line[at + 1];
    if ((tens != ' ' && (tens < '0' || tens > '9')) || ones < '0' || ones > '9') {
      return std::nullopt;
    }
    items.push_back((tens == ' ' ? 0 : 10 * (tens - '0')) + (ones - '0'));
  }
  return items;
}

std::string encode_refusal(std::string_view command, FastrakRefusal why, std::size_t position,
                           std::size_t field, int station) {
  std::string shown(command);
  for (char& c : shown) {
    if (c < 0x20 || c > 0x7E) c = '?';
  }
  return encode_reply(0, 'E',
                      "*ERROR* " + shown + " *ERROR* EC" +
                          right_justified(static_cast<int>(why), 3) + " *PS" +
                          right_justified(static_cast<long long>(position), 3) + " *FL" +
                          right_justified(static_cast<long long>(field), 2) + " *ST" +
                          right_justified(station - 1, 2));
}

std::string_view fastrak_error_text(int number) {
  constexpr auto between = [](int n, char first, char last) { return n >= first && n <= last; };
  if (number == 0 || number == ' ') return "no error";
  if (between(number, 'A', 'C')) return "driver linearity";
  if (between(number, 'D', 'F')) return "gain linearity";
  if (between(number, 'G', 'I')) return "driver slope";
  if (between(number, 'J', 'L')) return "coil slope";
  if (between(number, 'T', 'Z')) return "PROM or characterisation data not valid";
  if (between(number, 'a', 'g')) return "self-calibration limits";
  switch (number) {
    case 'j':
      return "signal saturated";
    case 'k':
      return "low signal";
    case 'l':
      return "maximum signal element zero";
    case 'm':
      return "EEPROM checksum";
    case 's':
      return "position normal reset";
    case 't':
      return "compensation table";
    case 'u':
      return "point outside compensation map";
    case 'v':
      return "no CRT sync";
    case 'w':
      return "EEPROM write";
    case 'x':
      return "position envelope exceeded";
    case 'y':
      return "angular envelope exceeded";
    default:
      return "";
  }
}

}  // namespace headpin::devices
