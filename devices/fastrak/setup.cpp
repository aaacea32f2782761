#include "devices/fastrak/setup.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "devices/fastrak/geometry.h"
#include "devices/fastrak/replies.h"

namespace headpin::devices {
namespace {

bool has_any(const std::vector<int>& items, std::initializer_list<int> wanted) {
  return std::any_of(items.begin(), items.end(), [&](int item) {
    return std::find(wanted.begin(), wanted.end(), item) != wanted.end();
  });
}

std::string list_of(const std::vector<int>& items) {
  std::string text;
  for (const int item : items) text.append(",").append(std::to_string(item));
  return text;
}

/// A number as the manual writes it, signed and with two decimals.
std::string field(double value) {
  const std::array<double, 1> one = {value};
  return std::string(",").append(encode_columns(one, 7, 2));
}

/// A line command for a station.
std::string line(char letter, int station, std::string_view arguments) {
  return std::string(1, letter).append(std::to_string(station)).append(arguments).append("\r");
}

std::string arguments(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += field(value);
  return text;
}

/// The values of a zenith for the command H, which takes two decimals.
std::vector<double> zenith_values(const Vec3& zenith) {
  const Vec3 n = zenith.stableNormalized();
  return {n.x(), n.y(), n.z()};
}

/// The numbers in the answer `2`, station, letter, numbers, CR LF; they may touch at their signs.
std::optional<std::vector<double>> find_values(const FastrakCheck& check, Bytes heard) {
  const std::string_view text(reinterpret_cast<const char*>(heard.data()), heard.size());
  const std::string head = {'2', static_cast<char>('0' + check.station), check.letter};
  const std::size_t begin = text.find(head);
  const std::size_t end = text.find("\r\n", begin);  // from npos on it finds nothing
  if (end == std::string_view::npos) return std::nullopt;
  std::vector<double> values;
  const char* at = text.data() + begin + head.size();
  const char* const stop = text.data() + end;
  while (at != stop) {
    if (*at == ' ' || *at == '+') {
      ++at;
      continue;
    }
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, stop, value);
    if (error != std::errc{}) return std::nullopt;
    values.push_back(value);
    at = next;
  }
  return values;
}

}  // namespace

void read_zenith(std::string_view text, FastrakZeniths& zeniths) {
  const auto refuse = [&] {
    throw std::invalid_argument(std::string("hemisphere '")
                                    .append(text)
                                    .append("': expected X,Y,Z or STATION:X,Y,Z, three finite "
                                            "numbers and a station from 1 to 4"));
  };
  std::string_view rest = text;
  std::optional<std::size_t> station;
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    if (colon != 1 || text[0] < '1' || text[0] >= '1' + kFastrakStations) refuse();
    station = static_cast<std::size_t>(text[0] - '1');
    rest.remove_prefix(2);
  }
  Vec3 zenith;
  for (int i = 0; i < 3; ++i) {
    if (i > 0) {
      if (!rest.starts_with(',')) refuse();
      rest.remove_prefix(1);
    }
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), zenith[i]);
    if (error != std::errc() || !std::isfinite(zenith[i])) refuse();
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  if (!rest.empty()) refuse();
  if (station) {
    zeniths[*station] = zenith;
  } else {
    zeniths.fill(zenith);
  }
}

FastrakAttitude attitude_of(const std::vector<int>& items) {
  if (has_any(items, {11, 61, 20})) return FastrakAttitude::quaternion;
  if (has_any(items, {5, 55}) && has_any(items, {6, 56}) && has_any(items, {7, 57})) {
    return FastrakAttitude::matrix;
  }
  if (has_any(items, {4, 54, 19})) return FastrakAttitude::angles;
  throw std::invalid_argument(
      "output list: expected an orientation (quaternion 11, 61, 20; angles 4, 54, 19; or "
      "matrix 5 6 7, 55 56 57)");
}

Pose pose_of(const FastrakRecord& record, const FastrakFormat& format) {
  Pose X_TS;
  X_TS.p = format.metre_per_unit() * record.position;
  switch (attitude_of(format.items)) {
    case FastrakAttitude::quaternion: {
      const auto& [w, x, y, z] = record.quaternion;
      X_TS.q = Quat(w, x, y, z);
      break;
    }
    case FastrakAttitude::matrix:
      X_TS.q = Quat(record.attitude);
      break;
    case FastrakAttitude::angles:
      X_TS.q = from_angles_deg(record.angles_deg);
      break;
  }
  // A record with an error letter may hold anything.
  if (record.position.cwiseAbs().maxCoeff() > kFastrakFarthest) X_TS.p.setZero();
  const double norm = X_TS.q.norm();
  X_TS.q = norm > 1e-6 ? X_TS.q.normalized() : Quat::Identity();
  return X_TS;
}

void check_items(const std::vector<int>& items) {
  if (items.empty()) throw std::invalid_argument("output list: empty");
  for (const int item : items) {
    if (!is_fastrak_item(item, true)) {
      throw std::invalid_argument("output list: item " + std::to_string(item) + " does not exist");
    }
  }
  if (!has_any(items, {2, 52, 18})) {
    throw std::invalid_argument("output list: expected a position (2, 52 or 18)");
  }
  attitude_of(items);
  if (!has_any({items.back()}, {0, 1, 50, 51})) {
    throw std::invalid_argument("output list: expected a space (0) or CR LF (1) at its end");
  }
}

std::vector<std::string> setup_commands(const FastrakOptions& options) {
  std::vector<std::string> commands = {
      "o,N,8,0\r",  // first the port: with seven bits no binary record is complete
      options.centimetres ? "u" : "U",
      "F",           // read-backs and refusals in a known format
      "e1,0\r",      // the stylus switch only reports
      "v,1\rx,1\r",  // no filters
      "y0\r",
  };
  for (int s = 1; s <= kFastrakStations; ++s) {
    const auto i = static_cast<std::size_t>(s - 1);
    commands.push_back(line('l', s, options.stations[i] ? ",1" : ",0"));
    commands.push_back(line('R', s, ""));
    commands.push_back(line('b', s, ""));
    // Tracking starts from the present half-space, so this one is set first.
    if (options.zenith[i].isZero()) commands.push_back(line('H', s, ",1,0,0"));
    for (const FastrakCheck& check : setup_checks(options, s)) {
      if (check.letter == 'A') continue;  // the command R has set it
      commands.push_back(line(
          check.letter, s, check.letter == 'O' ? list_of(options.items) : arguments(check.values)));
    }
  }
  return commands;
}

std::vector<std::string> stream_commands(const FastrakOptions& options) {
  return {options.binary ? "f" : "F", "C"};
}

std::vector<FastrakCheck> setup_checks(const FastrakOptions& options, int station) {
  const double metre = options.centimetres ? 100.0 : 1.0 / 0.0254;
  // No envelope within the unit's reach of 300 cm; the factory's envelope flags all beyond 200 cm.
  const double reach = options.centimetres ? 300.0 : 118.0;
  const Vec3& zenith = options.zenith[static_cast<std::size_t>(station - 1)];
  const std::vector<double> items(options.items.begin(), options.items.end());
  return {{'r', station, {0, 0, 0}},
          {'N', station, {0, 0, 0}},  // the pose of the receiver, also where it is a stylus
          {'A', station, {0, 0, 0, 2 * metre, 0, 0, 0, 2 * metre, 0}},
          {'H', station, zenith_values(zenith)},
          {'O', station, items},
          {'I', station, {0}, false},
          {'V', station, {reach, reach, reach, -reach, -reach, -reach}, false},
          {'Q', station, {180, 90, 180, -180, -90, -180}, false}};
}

std::string question(const FastrakCheck& check) {
  return check.station == 0 ? "S" : line(check.letter, check.station, "");
}

FastrakVerdict judge(const FastrakCheck& check, const FastrakOptions& options, Bytes heard) {
  const auto verdict = [](bool as_said) {
    return as_said ? FastrakVerdict::as_said : FastrakVerdict::otherwise;
  };
  if (check.letter == 'S') {
    const auto status = find_answer(heard, kFastrakStatusLength, decode_status);
    if (!status) return FastrakVerdict::no_answer;
    return verdict(status->centimetres == options.centimetres && !status->binary &&
                   !status->continuous);
  }
  if (check.letter == 'O') {
    const auto decode = [&](std::string_view text) { return decode_list(text, check.station); };
    const auto list = find_answer(heard, 5 + 2 * options.items.size(), decode);
    return list ? verdict(*list == options.items) : FastrakVerdict::no_answer;
  }
  const auto values = find_values(check, heard);
  if (!values) return FastrakVerdict::no_answer;
  constexpr double kRounded = 0.0101;  // rounding to two decimals, there and back
  return verdict(std::ranges::equal(
      *values, check.values, [](double a, double b) { return std::abs(a - b) <= kRounded; }));
}

}  // namespace headpin::devices
