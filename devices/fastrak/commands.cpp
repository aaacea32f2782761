#include "devices/fastrak/commands.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devices/base/text.h"

namespace headpin::devices {
namespace {

constexpr std::size_t kLongestRecord = 254;  // bytes (p. 57)
constexpr std::size_t kMostItems = 32;       // (p. 57)

// Largest values that the columns of read-backs can hold.
constexpr double kWidest7 = 999.99, kWidest8 = 999.999;
constexpr std::array<double, 3> kWidest7s = {kWidest7, kWidest7, kWidest7};
constexpr std::array<double, 3> kWidest8s = {kWidest8, kWidest8, kWidest8};
constexpr std::array<double, 3> kAngles = {180.0, 90.0, 180.0};

/// Thrown inside a command; its field, one of the line, is counted from 0 after the letter.
struct RefusedField {
  FastrakRefusal why;
  std::size_t field;
};

/// A line command cut into its fields.
struct Line {
  explicit Line(std::string_view whole) : text(whole), letter(whole.front()) {
    std::size_t at = 1;
    while (true) {
      const std::size_t comma = text.find(',', at);
      fields.push_back(without_spaces(text.substr(at, comma - at)));
      starts.push_back(at);
      if (comma == std::string_view::npos) break;
      at = comma + 1;
    }
  }

  bool blank(std::size_t field) const { return field >= fields.size() || fields[field].empty(); }

  /// True when nothing follows the fields before `first`: a read-back, with or without commas.
  bool blank_from(std::size_t first) const {
    for (std::size_t i = first; i < fields.size(); ++i) {
      if (!blank(i)) return false;
    }
    return true;
  }

  double number(std::size_t field) const {
    if (blank(field)) throw RefusedField{FastrakRefusal::field_missing, field};
    std::string_view digits = fields[field];
    if (digits.front() == '+') digits.remove_prefix(1);
    if (digits.starts_with("-") && fields[field].front() == '+') digits = {};
    double value = 0.0;
    const bool shaped = digits.find_first_not_of("0123456789.eE+-") == std::string_view::npos;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (!shaped || digits.empty() || read.ptr != digits.data() + digits.size()) {
      throw RefusedField{FastrakRefusal::not_numeric, field};
    }
    if (read.ec != std::errc{}) throw RefusedField{FastrakRefusal::out_of_range, field};
    return value;
  }

  double number(std::size_t field, double low, double high) const {
    const double value = number(field);
    if (!(value >= low && value <= high)) throw RefusedField{FastrakRefusal::out_of_range, field};
    return value;
  }

  int whole(std::size_t field, int low, int high) const {
    const double value = number(field, low, high);
    if (value != std::floor(value)) throw RefusedField{FastrakRefusal::out_of_range, field};
    return static_cast<int>(value);
  }

  /// Index 0 to 3 of the station in the first field.
  std::size_t station() const {
    return static_cast<std::size_t>(whole(0, 1, kFastrakStations)) - 1;
  }

  /// First station and one past the last: one, or all for `*`.
  std::pair<std::size_t, std::size_t> stations() const {
    if (!fields[0].empty() && fields[0] == "*") return {0, kFastrakStations};
    const std::size_t s = station();
    return {s, s + 1};
  }

  /// The stored values, replaced by the fields from `first` on; empty fields keep the stored value.
  template <std::size_t N>
  std::array<double, N> merged(std::size_t first, std::array<double, N> stored,
                               const std::array<double, N>& limits) const {
    for (std::size_t i = 0; i < N; ++i) {
      if (!blank(first + i)) stored[i] = number(first + i, -limits[i], limits[i]);
    }
    return stored;
  }

  std::string_view text;
  char letter;
  std::vector<std::string_view> fields;
  std::vector<std::size_t> starts;  ///< of each field in `text`
};

double metre_per_unit(const FastrakMemory& memory) {
  return memory.setup.centimetres ? kMetrePerCentimetre : kMetrePerInch;
}

int number_of(std::size_t station) {
  return static_cast<int>(station) + 1;
}

/// The answer of a station, or of the unit (0), in columns.
std::string answer(const Line& line, int station, std::span<const double> values, int width,
                   int decimals) {
  return encode_reply(station, line.letter, encode_columns(values, width, decimals));
}

/// Three values, in units of `metre`: sets them, or reads them back when no field follows.
std::string three(const Line& line, Vec3& stored, double metre, const std::array<double, 3>& limits,
                  int width, int decimals) {
  const std::array<double, 3> values = {stored.x() / metre, stored.y() / metre, stored.z() / metre};
  if (line.blank_from(1)) {
    return answer(line, number_of(line.station()), values, width, decimals);
  }
  const auto v = line.merged(1, values, limits);
  stored = metre * Vec3(v[0], v[1], v[2]);
  return "";
}

/// A box: three largest values, then three smallest.
std::string box(const Line& line, std::array<Vec3, 2>& stored, double metre,
                const std::array<double, 6>& limits) {
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < 6; ++i) {
    values[i] = stored[i / 3](static_cast<Eigen::Index>(i % 3)) / metre;
  }
  if (line.blank_from(1)) return answer(line, number_of(line.station()), values, 8, 3);
  values = line.merged(1, values, limits);
  for (std::size_t i = 0; i < 3; ++i) {
    if (values[i] < values[i + 3]) throw RefusedField{FastrakRefusal::out_of_range, i + 1};
  }
  stored = {metre * Vec3(values[0], values[1], values[2]),
            metre * Vec3(values[3], values[4], values[5])};
  return "";
}

// --- One function for each letter ------------------------------------------------------------

/// A: alignment frame; A0: guided by three points.
std::string alignment(const Line& line, FastrakMemory& m) {
  if (line.fields[0] == "0" && line.blank_from(1)) {
    for (FastrakStationSetup& station : m.setup.stations) {
      station.p_TA = FastrakStationSetup{}.p_TA;
    }
    m.guided.emplace();
    return "";
  }
  const std::size_t s = line.station();
  if (line.blank_from(1)) return alignment_answer(m, s);
  // New points are given in the present frame, in which its own three points are the factory's.
  const double unit = metre_per_unit(m);
  const std::array<Vec3, 3> start = FastrakStationSetup{}.p_TA;
  std::array<double, 9> values{}, limits{};
  for (std::size_t i = 0; i < 9; ++i) {
    values[i] = start[i / 3](static_cast<Eigen::Index>(i % 3)) / unit;
    limits[i] = kWidest7;
  }
  values = line.merged(1, values, limits);
  std::array<Vec3, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    points[i] = unit * Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  }
  if (!align(m.setup.stations[s], points)) throw RefusedField{FastrakRefusal::out_of_range, 1};
  return "";
}

/// R: alignment as from the factory.
std::string no_alignment(const Line& line, FastrakMemory& m) {
  const auto [first, last] = line.stations();
  for (std::size_t s = first; s < last; ++s) {
    m.setup.stations[s].p_TA = FastrakStationSetup{}.p_TA;
  }
  return "";
}

/// B: boresight.
std::string boresight(const Line& line, FastrakMemory& m) {
  const auto [first, last] = line.stations();
  for (std::size_t s = first; s < last; ++s) {
    if (m.setup.stations[s].on) m.setup.stations[s].q_boresight = m.attitude(s);
  }
  return "";
}

/// b: no boresight.
std::string no_boresight(const Line& line, FastrakMemory& m) {
  const auto [first, last] = line.stations();
  for (std::size_t s = first; s < last; ++s) m.setup.stations[s].q_boresight.reset();
  return "";
}

/// G: angles that the orientation reads as after boresight.
std::string boresight_angles(const Line& line, FastrakMemory& m) {
  return three(line, m.setup.stations[line.station()].boresight_deg, 1.0, kAngles, 7, 2);
}

/// H: hemisphere.
std::string hemisphere(const Line& line, FastrakMemory& m) {
  return three(line, m.setup.stations[line.station()].zenith, 1.0, kWidest7s, 7, 2);
}

/// N: tip offset.
std::string tip_offset(const Line& line, FastrakMemory& m) {
  return three(line, m.setup.stations[line.station()].p_SN, metre_per_unit(m), kWidest8s, 8, 3);
}

/// r: mounting frame of the transmitter.
std::string mounting(const Line& line, FastrakMemory& m) {
  return three(line, m.setup.stations[line.station()].mounting_deg, 1.0, kAngles, 8, 3);
}

/// I: increment.
std::string increment(const Line& line, FastrakMemory& m) {
  double& stored = m.setup.stations[line.station()].increment;
  if (line.blank_from(1)) {
    const std::array<double, 1> value = {stored / metre_per_unit(m)};
    return answer(line, number_of(line.station()), value, 7, 2);
  }
  stored = metre_per_unit(m) * line.number(1, 0.0, kWidest7);
  return "";
}

/// V: position envelope.
std::string position_envelope(const Line& line, FastrakMemory& m) {
  std::array<double, 6> limits{};
  limits.fill(kWidest8);
  return box(line, m.setup.stations[line.station()].position_envelope, metre_per_unit(m), limits);
}

/// Q: angular envelope.
std::string angular_envelope(const Line& line, FastrakMemory& m) {
  return box(line, m.setup.stations[line.station()].angle_envelope_deg, 1.0,
             {180, 90, 180, 180, 90, 180});
}

/// l: stations on and off.
std::string stations_on(const Line& line, FastrakMemory& m) {
  const auto [first, last] = line.stations();
  if (line.blank_from(1)) {
    std::array<bool, kFastrakStations> on{};
    for (std::size_t s = 0; s < on.size(); ++s) on[s] = m.setup.stations[s].on;
    return encode_active(number_of(first), on);
  }
  const bool on = line.whole(1, 0, 1) == 1;
  for (std::size_t s = first; s < last; ++s) m.setup.stations[s].on = on && m.plugged(s);
  return "";
}

/// O: output list.
std::string output_list(const Line& line, FastrakMemory& m) {
  const std::size_t s = line.station();
  std::vector<int>& items = m.setup.stations[s].items;
  if (line.blank_from(1)) return encode_list(number_of(s), items);
  std::vector<int> list;
  for (std::size_t i = 1; i < line.fields.size(); ++i) {
    if (i > kMostItems) throw RefusedField{FastrakRefusal::buffer_limit, i};
    const bool keeps = line.blank(i) && i <= items.size();
    const int item = keeps ? items[i - 1] : line.whole(i, 0, 99);
    if (!is_fastrak_item(item, m.early_firmware)) {
      throw RefusedField{FastrakRefusal::out_of_range, i};
    }
    list.push_back(item);
  }
  if (fastrak_record_length({.items = list}) > kLongestRecord) {
    throw RefusedField{FastrakRefusal::buffer_limit, line.fields.size() - 1};
  }
  items = std::move(list);
  return "";
}

/// e: function of the stylus switch. The station may be left out; the unit ignores it.
std::string stylus_switch(const Line& line, FastrakMemory& m) {
  const bool alone = line.fields.size() == 1;
  m.setup.point_mode = line.whole(alone ? 0 : 1, 0, 1) == 1;
  return "";
}

/// o: port.
std::string port(const Line& line, FastrakMemory& m) {
  FastrakPort port = m.port;
  if (!line.blank(0)) {
    port.baud = 100 * line.whole(0, 24, 1152);
    if (std::ranges::find(kFastrakBauds, port.baud) == kFastrakBauds.end()) {
      throw RefusedField{FastrakRefusal::out_of_range, 0};
    }
  }
  if (!line.blank(1)) {
    const std::string_view parity = line.fields[1];
    if (parity != "N" && parity != "O" && parity != "E") {
      throw RefusedField{FastrakRefusal::out_of_range, 1};
    }
    port.parity = parity != "N";
  }
  if (!line.blank(2)) port.bits = line.whole(2, 7, 8);
  if (!line.blank(3)) line.whole(3, 0, 1);  // hardware handshake: there is no such wire
  if (port.bits == 8 && port.parity) throw RefusedField{FastrakRefusal::out_of_range, 1};
  m.port = port;
  return "";
}

/// T: the built-in test.
std::string built_in_test(const Line& line, FastrakMemory& m) {
  const int number = line.blank(0) ? m.error : line.whole(0, 0, 122);
  if (!line.blank(1)) {
    line.whole(1, 0, 0);
    m.error = 0;
    return "";
  }
  const std::string digits = std::to_string(number);
  const std::string column = std::string(3 - digits.size(), ' ') + digits + " ";
  return encode_reply(0, 'T', column + std::string(fastrak_error_text(number)));
}

/// v, x: filters of orientation and position.
std::string filter(const Line& line, FastrakMemory& m) {
  FastrakFilter& stored = line.letter == 'v' ? m.setup.attitude_filter : m.setup.position_filter;
  const std::array<double, 4> values = {stored.sensitivity, stored.low, stored.high, stored.factor};
  if (line.blank_from(0)) return answer(line, 0, values, 7, 3);
  if (line.blank_from(1) && line.number(0) >= 2.0) {
    // Macros (p. 77); the numbers are those of the maker's later trackers.
    constexpr std::array<FastrakFilter, 4> kMacros = {
        {{0.2, 1.0, 0.8, 0.95}, {0.2, 0.2, 0.8, 0.8}, {0.2, 0.1, 0.7, 0.8}, {0.2, 0.05, 0.6, 0.8}}};
    stored = kMacros[static_cast<std::size_t>(line.whole(0, 2, 5)) - 2];
    return "";
  }
  const auto v = line.merged(0, values, {1.0, 1.0, 1.0, 1.0});
  for (std::size_t i = 0; i < 4; ++i) {
    if (v[i] < 0.0) throw RefusedField{FastrakRefusal::out_of_range, i};
  }
  if (v[1] < 1.0 && !(v[1] > 0.0 && v[1] <= v[2])) {
    throw RefusedField{FastrakRefusal::out_of_range, 1};
  }
  stored = {v[0], v[1], v[2], v[3]};
  return "";
}

/// X: identification.
std::string identification(const Line& line, FastrakMemory& m) {
  const std::string_view text = line.text.substr(1);
  if (text.empty()) {
    std::string shown = m.setup.identification;
    shown.resize(32, ' ');
    return encode_reply(0, 'X', shown);
  }
  if (text.size() > 32) throw RefusedField{FastrakRefusal::buffer_limit, 0};
  m.setup.identification = text;
  return "";
}

/// y: synchronisation.
std::string synchronisation(const Line& line, FastrakMemory& m) {
  if (line.blank_from(0)) return encode_reply(0, 'y', std::to_string(m.setup.sync));
  m.setup.sync = line.whole(0, 0, 2);
  return "";
}

struct Command {
  char letter;
  std::string (*carry_out)(const Line&, FastrakMemory&);
};

constexpr std::array<Command, 20> kCommands = {
    {{'A', alignment},        {'B', boresight},      {'b', no_boresight},  {'e', stylus_switch},
     {'G', boresight_angles}, {'H', hemisphere},     {'I', increment},     {'l', stations_on},
     {'N', tip_offset},       {'O', output_list},    {'o', port},          {'Q', angular_envelope},
     {'R', no_alignment},     {'r', mounting},       {'T', built_in_test}, {'V', position_envelope},
     {'v', filter},           {'X', identification}, {'x', filter},        {'y', synchronisation}}};

/// The station that a refusal names, 1 to 4: the one in the first field, or 1.
int refused_station(const Line& line) {
  constexpr std::string_view kOfWholeUnit = "oTvXxy";  // commands without a station
  if (kOfWholeUnit.find(line.letter) != std::string_view::npos) return 1;
  const std::string_view first = line.fields[0];
  return first.size() == 1 && first[0] >= '1' && first[0] <= '4' ? first[0] - '0' : 1;
}

}  // namespace

bool is_fastrak_line_command(char letter) {
  return std::ranges::find(kCommands, letter, &Command::letter) != kCommands.end();
}

bool switch_setting(char letter, FastrakSetup& setup) {
  switch (letter) {
    case 'F':
    case 'f':
      setup.binary = letter == 'f';
      return true;
    case 'U':
    case 'u':
      setup.centimetres = letter == 'u';
      return true;
    case 'D':
    case 'd':
      setup.compensation = letter == 'D';
      return true;
    default:
      return false;
  }
}

std::string carry_out(std::string_view text, FastrakMemory& memory) {
  const Line line(text);
  const auto command = std::ranges::find(kCommands, line.letter, &Command::letter);
  try {
    return command->carry_out(line, memory);
  } catch (const RefusedField& refused) {
    throw FastrakRefused{refused.why, refused.field, line.starts.at(refused.field),
                         refused_station(line)};
  }
}

bool align(FastrakStationSetup& station, const std::array<Vec3, 3>& points) {
  const Pose X_TA = frame_through(station.p_TA[0], station.p_TA[1], station.p_TA[2]).value();
  const std::array<Vec3, 3> p_T = {X_TA * points[0], X_TA * points[1], X_TA * points[2]};
  if (!frame_through(p_T[0], p_T[1], p_T[2])) return false;
  station.p_TA = p_T;
  return true;
}

std::string alignment_answer(const FastrakMemory& memory, std::size_t station) {
  std::array<double, 9> values{};
  for (std::size_t i = 0; i < 9; ++i) {
    values[i] = memory.setup.stations[station].p_TA[i / 3](static_cast<Eigen::Index>(i % 3)) /
                metre_per_unit(memory);
  }
  return encode_reply(number_of(station), 'A', encode_columns(values, 7, 2));
}

}  // namespace headpin::devices
