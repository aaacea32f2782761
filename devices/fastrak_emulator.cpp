#include "devices/fastrak_emulator.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace headpin::devices {
namespace {

constexpr std::int64_t kCycleRate = 120;     // per second, shared by the receivers (p. E-2)
constexpr Time kCycle{8333};                 // 1 / kCycleRate
constexpr Time kSolutionReady{5500};         // after the start of the field (p. E-2)
constexpr Time kMidSampling{5500 - 3750};    // effective latency 3.75 ms (p. E-4)
constexpr std::int64_t kSwitchCycles = 40;   // between looks at the stylus switch
constexpr std::size_t kLongestLine = 254;    // bytes
constexpr std::size_t kLongestRecord = 254;  // bytes (p. 57)
constexpr std::size_t kMostItems = 32;       // (p. 57)
constexpr std::size_t kOutboxLimit = 1024;   // bytes a reader may leave
constexpr std::size_t kQueueLimit = 8192;    // bytes of answers waiting for the line
constexpr std::size_t kHeldLimit = 1024;     // bytes of commands waiting for ^K

constexpr std::string_view kImmediate = "PCcSFfUuDdW";
constexpr std::string_view kLines = "ABbeGHIlNOoQRrTVvXxy";
constexpr std::array<int, 7> kBauds = {2400, 4800, 9600, 19200, 38400, 57600, 115200};

// What random numbers are drawn for.
enum Purpose : std::uint64_t { kNoise = 0, kFaults = 16 };

std::string blank_or(int number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), ' ') + digits;
}

/// Thrown inside a line command; its field is counted from 0 after the letter.
struct RefusedField {
  FastrakRefusal why;
  std::size_t field;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

/// A line command cut into its fields.
struct FastrakEmulator::Line {
  explicit Line(std::string_view whole) : text(whole), letter(whole.front()) {
    std::size_t at = 1;
    while (true) {
      const std::size_t comma = text.find(',', at);
      fields.push_back(trimmed(text.substr(at, comma - at)));
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
    if (blank(field)) throw RefusedField{FastrakRefusal::kFieldMissing, field};
    std::string_view digits = fields[field];
    if (digits.front() == '+') digits.remove_prefix(1);
    if (digits.starts_with("-") && fields[field].front() == '+') digits = {};
    double value = 0.0;
    const bool shaped = digits.find_first_not_of("0123456789.eE+-") == std::string_view::npos;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (!shaped || digits.empty() || read.ptr != digits.data() + digits.size()) {
      throw RefusedField{FastrakRefusal::kNotNumeric, field};
    }
    if (read.ec != std::errc{}) throw RefusedField{FastrakRefusal::kOutOfRange, field};
    return value;
  }

  double number(std::size_t field, double low, double high) const {
    const double value = number(field);
    if (!(value >= low && value <= high)) throw RefusedField{FastrakRefusal::kOutOfRange, field};
    return value;
  }

  int whole(std::size_t field, int low, int high) const {
    const double value = number(field, low, high);
    if (value != std::floor(value)) throw RefusedField{FastrakRefusal::kOutOfRange, field};
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

  /// Fields from `first` on in place of the stored values; empty ones keep them.
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

FastrakEmulator::FastrakEmulator(FastrakEmulatorOptions options, FastrakMotion motion)
    : options_(std::move(options)), motion_(std::move(motion)) {
  if (options_.receivers < 1 || options_.receivers > kFastrakStations) {
    throw std::invalid_argument("receivers: expected 1 to 4, found " +
                                std::to_string(options_.receivers));
  }
  if (std::find(kBauds.begin(), kBauds.end(), options_.baud) == kBauds.end()) {
    throw std::invalid_argument(
        "baud: expected one of 2400 4800 9600 19200 38400 57600 115200, "
        "found " +
        std::to_string(options_.baud));
  }
  eeprom_ = factory_setup(Time{0});
  start_up(Time{0});
  listening_from_ = Time{0};  // found switched on and ready
}

FastrakSetup FastrakEmulator::factory_setup(Time now) const {
  FastrakSetup setup;
  setup.stations[0].p_SN = options_.p_SN_stylus;
  for (std::size_t s = 0; s < setup.stations.size(); ++s) setup.stations[s].on = plugged(s, now);
  return setup;
}

bool FastrakEmulator::plugged(std::size_t station, Time t) const {
  if (station >= static_cast<std::size_t>(options_.receivers)) return false;
  return std::none_of(options_.faults.unplugged.begin(), options_.faults.unplugged.end(),
                      [&](const StationFault& fault) {
                        return fault.station == static_cast<int>(station) + 1 &&
                               fault.when.holds(t);
                      });
}

void FastrakEmulator::start_up(Time now) {
  setup_ = eeprom_;
  for (std::size_t s = 0; s < setup_.stations.size(); ++s) {
    setup_.stations[s].on = setup_.stations[s].on && plugged(s, now);
  }
  port_ = {options_.baud, 8, false};
  drop_unsent();
  listening_from_ = now + options_.boot_time;
  saved_at_ = Time{0};
  held_.clear();
  solutions_ = {};
  position_weights_ = {};
  attitude_weights_ = {};
  last_output_ = {};
  error_ = 0;
  switch_was_down_ = switched_off_ = false;
  guided_.reset();
  expected_.reset();
  suspended_ = false;
  line_.clear();
  swallow_ = Swallow::kNothing;
}

void FastrakEmulator::power_cycle(Time now) {
  advance(now);
  queue_.clear();
  start_up(now_);
}

// --- Time ------------------------------------------------------------------------------------

bool FastrakEmulator::silent(Time t) const {
  return t < listening_from_ ||
         std::any_of(options_.faults.silence.begin(), options_.faults.silence.end(),
                     [&](const FaultWindow& window) { return window.holds(t); });
}

void FastrakEmulator::receive(Bytes bytes, Time now) {
  advance(now);
  hear_all(bytes, now_);
}

Bytes FastrakEmulator::due(Time now) {
  advance(now);
  return outbox_;
}

void FastrakEmulator::taken(std::size_t count) {
  outbox_.erase(outbox_.begin(),
                outbox_.begin() + static_cast<std::ptrdiff_t>(std::min(count, outbox_.size())));
}

void FastrakEmulator::advance(Time now) {
  now = std::max(now, now_);
  if (!held_.empty() && saved_at_ <= now) {
    run_cycles(saved_at_);
    hear_all(std::exchange(held_, {}), saved_at_);
  }
  run_cycles(now);
  pump(now);
  now_ = now;
}

void FastrakEmulator::run_cycles(Time now) {
  while (true) {
    const Time start = tick_time(cycle_, kCycleRate);
    const Time ready = start + kSolutionReady;
    if (ready > now) return;
    pump(ready);
    if (!silent(ready) && ready >= saved_at_) {
      if (const auto station = next_active(measured_)) {
        measured_ = *station;
        measure(*station, start + kMidSampling);
        offer(*station, ready);
      }
      if (cycle_ % kSwitchCycles == 0) look_at_switch(ready);
    }
    ++cycle_;
  }
}

void FastrakEmulator::measure(std::size_t station, Time at) {
  const int number = static_cast<int>(station) + 1;
  Solution& solution = solutions_[station];
  const bool pulled_out = !plugged(station, at);
  Time when = at;
  for (const StationFault& stuck : options_.faults.stuck) {
    if (stuck.station == number && stuck.when.holds(at)) when = stuck.when.from;
  }
  const FastrakTruth truth = motion_(number, when);
  const FastrakStationSetup& setup = setup_.stations[station];

  solution.error = pulled_out ? 'l' : truth.error;
  // The one switch is wired to station 1, and any station's record may carry it.
  solution.pressed = truth.pressed || (station != 0 && motion_(1, at).pressed);
  solution.measured = at;
  if (pulled_out && solution.valid) {
    error_ = static_cast<unsigned char>(solution.error);
    return;
  }

  Pose X_TS = distort(truth.X_TS, options_.faults.metal);
  const double range = X_TS.p.norm();
  if (range > kFastrakRange && solution.error == ' ') solution.error = 'k';
  if (setup_.sync == 2 && solution.error == ' ') solution.error = 'v';
  const FastrakNoise noise = noise_at(range);
  Random random(options_.seed, kNoise + station,
                static_cast<std::uint64_t>(tick_time(cycle_, kCycleRate).count()));
  X_TS.p += options_.faults.noise * noise.position * random.normal3();
  X_TS.q = rotation(options_.faults.noise * noise.rotation * random.normal3()) * X_TS.q;

  // With tracking on, the half-space is the one around the last position.
  const bool tracking = setup.zenith.isZero();
  const Vec3 zenith = !tracking        ? setup.zenith
                      : solution.valid ? solution.X_TS.p
                                       : Vec3(Vec3::UnitX());
  X_TS.p = in_hemisphere(X_TS.p, zenith);

  if (solution.valid) {
    const Pose& last = solution.X_TS;
    if (setup_.position_filter.enabled()) {
      const double inches = (X_TS.p - last.p).norm() / kMetrePerInch;
      const double a = position_weights_[station].next(setup_.position_filter, inches);
      X_TS.p = a * X_TS.p + (1.0 - a) * last.p;
    }
    if (setup_.attitude_filter.enabled()) {
      const double degrees =
          rotation_vector(last.q.conjugate() * X_TS.q).norm() * 180.0 / std::numbers::pi;
      const double a = attitude_weights_[station].next(setup_.attitude_filter, degrees);
      X_TS.q = interpolate({last.q, Vec3::Zero()}, {X_TS.q, Vec3::Zero()}, a).q;
    }
  }
  solution.X_TS = X_TS;
  solution.valid = true;
  if (solution.error != ' ') error_ = static_cast<unsigned char>(solution.error);
}

void FastrakEmulator::look_at_switch(Time now) {
  const bool down = motion_(1, now).pressed;
  const bool pressed_now = down && !switch_was_down_;
  switch_was_down_ = down;
  if (!setup_.point_mode) return;
  if (setup_.continuous) {
    if (pressed_now) switched_off_ = !switched_off_;
  } else if (down) {
    send_point(now);
  }
}

void FastrakEmulator::pump(Time now) {
  const std::int64_t now_ns = now.count() * 1000;
  const int baud =
      options_.faults.slow_baud > 0 ? std::min(port_.baud, options_.faults.slow_baud) : port_.baud;
  const int bits = 1 + port_.bits + (port_.parity ? 1 : 0) + 1;  // start, data, parity, stop
  const std::int64_t byte_ns = bits * 1'000'000'000LL / baud;
  while (!queue_.empty() && !suspended_ && outbox_.size() < kOutboxLimit) {
    Message& message = queue_.front();
    const std::int64_t start_ns = std::max(line_free_ns_, message.due.count() * 1000);
    if (message.sent == 0) {
      if (start_ns > now_ns) return;
      if (silent(Time{start_ns / 1000})) {
        queue_.pop_front();
        continue;
      }
    }
    if (start_ns + byte_ns > now_ns) return;
    const std::uint8_t byte = message.bytes[message.sent++];
    outbox_.push_back(port_.bits == 7 ? byte & 0x7F : byte);
    line_free_ns_ = start_ns + byte_ns;
    if (message.sent < message.bytes.size()) continue;
    statistics_.records += static_cast<std::int64_t>(message.records.size());
    statistics_.garbage_bytes += static_cast<std::int64_t>(message.garbage);
    for (const FastrakSent& record : message.records) {
      if (record.damaged) ++statistics_.damaged;
      if (options_.on_record) options_.on_record(record);
    }
    queue_.pop_front();
  }
}

// --- Output ----------------------------------------------------------------------------------

std::optional<std::size_t> FastrakEmulator::next_active(std::size_t after) const {
  for (std::size_t i = 1; i <= kFastrakStations; ++i) {
    const std::size_t station = (after + i) % kFastrakStations;
    if (active(station)) return station;
  }
  return std::nullopt;
}

bool FastrakEmulator::line_free() const {
  if (suspended_ || outbox_.size() >= kOutboxLimit) return false;
  // The last byte leaves by itself; the next record may be written behind it.
  return queue_.empty() ||
         (queue_.size() == 1 && queue_.front().sent + 1 >= queue_.front().bytes.size());
}

FastrakFormat FastrakEmulator::format_of(std::size_t station) const {
  return {setup_.stations[station].items, setup_.binary, setup_.centimetres};
}

Pose FastrakEmulator::outcome(std::size_t station) const {
  const FastrakStationSetup& setup = setup_.stations[station];
  Pose X = solutions_[station].X_TS;
  X.p = X * setup.p_SN;
  X = frame_through(setup.p_TA[0], setup.p_TA[1], setup.p_TA[2]).value().inverse() * X;
  X = Pose{from_angles_deg(setup.mounting_deg), Vec3::Zero()} * X;
  return X;
}

FastrakRecord FastrakEmulator::record_of(std::size_t station) {
  const FastrakStationSetup& setup = setup_.stations[station];
  Pose X = outcome(station);
  if (setup.q_boresight) {
    X.q = X.q * setup.q_boresight->conjugate() * from_angles_deg(setup.boresight_deg);
  }
  X.q.normalize();
  if (X.q.w() < 0.0) X.q.coeffs() = -X.q.coeffs();
  const double unit = format_of(station).metre_per_unit();

  FastrakRecord record;
  record.station = static_cast<int>(station) + 1;
  record.error = solutions_[station].error;
  record.position = X.p / unit;
  record.relative = (X.p - last_output_[station].value_or(Vec3::Zero())) / unit;
  record.angles_deg = angles_deg(X.q);
  record.attitude = X.q.toRotationMatrix();
  record.quaternion = {X.q.w(), X.q.x(), X.q.y(), X.q.z()};
  record.pressed = solutions_[station].pressed;

  const auto outside = [](const Vec3& v, const std::array<Vec3, 2>& box) {
    return (v.array() > box[0].array()).any() || (v.array() < box[1].array()).any();
  };
  if (record.error == ' ') {
    if (outside(X.p, setup.position_envelope)) record.error = 'x';
    if (outside(record.angles_deg, setup.angle_envelope_deg)) record.error = 'y';
    if (record.error != ' ') error_ = static_cast<unsigned char>(record.error);
  }
  last_output_[station] = X.p;
  return record;
}

void FastrakEmulator::offer(std::size_t station, Time now) {
  if (!setup_.continuous || switched_off_) return;
  if (!expected_ || !active(*expected_)) expected_ = next_active(kFastrakStations - 1);
  if (station != *expected_ || !line_free()) {
    ++statistics_.dropped;
    return;
  }
  expected_ = next_active(station);
  const double increment = setup_.stations[station].increment;
  if (increment > 0.0 && last_output_[station] &&
      (outcome(station).p - *last_output_[station]).norm() < increment) {
    return;
  }
  Random random(options_.seed, kFaults, outputs_);
  if (random.uniform() < options_.faults.dropout) {
    ++outputs_;
    ++statistics_.lost;
    return;
  }
  Message message;
  message.due = now;
  message.stream = true;
  add_record(station, message);
  queue(std::move(message));
}

void FastrakEmulator::add_record(std::size_t station, Message& message) {
  Random random(options_.seed, kFaults + 1, outputs_++);
  if (random.uniform() < options_.faults.garbage) {
    const std::size_t count = 1 + random.next() % 8;
    for (std::size_t i = 0; i < count; ++i) {
      message.bytes.push_back(static_cast<std::uint8_t>(random.next()));
    }
    message.garbage += count;
  }
  FastrakSent sent;
  sent.station = static_cast<int>(station) + 1;
  sent.measured = solutions_[station].measured;
  encode_record(record_of(station), format_of(station), sent.bytes);
  if (random.uniform() < options_.faults.damage) {
    sent.bytes[random.next() % sent.bytes.size()] ^=
        static_cast<std::uint8_t>(1u << (random.next() % 8));
    sent.damaged = true;
  }
  message.bytes.insert(message.bytes.end(), sent.bytes.begin(), sent.bytes.end());
  message.records.push_back(std::move(sent));
}

void FastrakEmulator::send_point(Time now) {
  if (guided_) {
    point_of_alignment(now);
    return;
  }
  Message message;
  message.due = now + kCycle;
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    if (!active(s)) continue;
    if (!solutions_[s].valid) measure(s, now);
    add_record(s, message);
  }
  queue(std::move(message));
}

void FastrakEmulator::reply(const std::string& line, Time now) {
  Message message;
  message.due = now + kCycle;
  message.bytes.assign(line.begin(), line.end());
  queue(std::move(message));
}

void FastrakEmulator::queue(Message message) {
  if (message.bytes.empty()) return;
  std::size_t waiting = message.bytes.size();
  for (const Message& other : queue_) waiting += other.bytes.size() - other.sent;
  if (waiting > kQueueLimit) {
    statistics_.dropped += static_cast<std::int64_t>(message.records.size());
    return;
  }
  queue_.push_back(std::move(message));
}

void FastrakEmulator::drop_unsent() {
  std::erase_if(queue_, [](const Message& message) { return message.sent == 0; });
}

// --- Commands --------------------------------------------------------------------------------

void FastrakEmulator::hear_all(Bytes bytes, Time now) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (silent(now)) return;
    if (now < saved_at_) {
      const std::size_t room = kHeldLimit - std::min(kHeldLimit, held_.size());
      const Bytes rest = bytes.subspan(i, std::min(room, bytes.size() - i));
      held_.insert(held_.end(), rest.begin(), rest.end());
      return;
    }
    hear(port_.bits == 7 ? bytes[i] & 0x7F : bytes[i], now);
  }
}

void FastrakEmulator::hear(std::uint8_t byte, Time now) {
  if (control(byte, now)) return;
  const Swallow swallow = std::exchange(swallow_, Swallow::kNothing);
  const char c = static_cast<char>(byte);
  if (c == '\r' || c == '\n') {
    const bool cr = c == '\r';
    if (!line_.empty()) {
      run_line(now);
      line_.clear();
    } else if (swallow == (cr ? Swallow::kReturn : Swallow::kLineFeed)) {
      return;  // the second half of CR LF or LF CR
    } else if (cr && swallow != Swallow::kAnyEnd) {
      refuse("", FastrakRefusal::kUnknownCommand, 0, 0, 1, now);
    }
    swallow_ = cr ? Swallow::kLineFeed : Swallow::kReturn;
  } else if (!line_.empty()) {
    if (line_.size() <= kLongestLine) line_ += c;  // one more than allowed marks it as too long
  } else if (kImmediate.find(c) != std::string_view::npos) {
    immediate(c, now);
    swallow_ = Swallow::kAnyEnd;
  } else if (kLines.find(c) != std::string_view::npos) {
    line_ = c;
  } else if (c != ' ') {
    refuse(std::string_view(&c, 1), FastrakRefusal::kUnknownCommand, 0, 0, 1, now);
    swallow_ = Swallow::kAnyEnd;
  }
}

/// Control bytes act at once, in the middle of a line too; the line goes on behind them.
bool FastrakEmulator::control(std::uint8_t byte, Time now) {
  switch (byte) {
    case 0x0B:  // ^K
      eeprom_ = setup_;
      for (FastrakStationSetup& station : eeprom_.stations) {
        station.q_boresight.reset();
        station.p_SN = Vec3::Zero();
      }
      eeprom_.stations[0].p_SN = options_.p_SN_stylus;
      if (eeprom_.sync == 1) eeprom_.sync = 0;
      saved_at_ = now + options_.save_time;
      break;
    case 0x11:  // ^Q
      if (suspended_) line_free_ns_ = std::max<std::int64_t>(line_free_ns_, now.count() * 1000);
      suspended_ = false;
      break;
    case 0x13:  // ^S
      suspended_ = true;
      break;
    case 0x19:  // ^Y
      start_up(now);
      break;
    default:
      return false;
  }
  if (line_.empty()) swallow_ = Swallow::kAnyEnd;
  ++statistics_.commands;
  return true;
}

void FastrakEmulator::immediate(char command, Time now) {
  ++statistics_.commands;
  switch (command) {
    case 'P':
      send_point(now);
      break;
    case 'C':
      if (!setup_.continuous) expected_.reset();
      setup_.continuous = true;
      switched_off_ = false;
      break;
    case 'c':
      setup_.continuous = false;
      switched_off_ = false;
      std::erase_if(queue_, [](const Message& m) { return m.stream && m.sent == 0; });
      break;
    case 'S': {
      if (++status_requests_ <= options_.faults.deaf) break;
      FastrakStatus status;
      status.binary = setup_.binary;
      status.centimetres = setup_.centimetres;
      status.compensation = setup_.compensation;
      status.continuous = setup_.continuous;
      status.error = error_;
      status.firmware = options_.firmware;
      status.identification = setup_.identification;
      if (options_.tag_2012) {
        // The coding of the sensor map is not known; ours: one hex digit, bit 0 for station 1.
        int map = 0;
        for (std::size_t s = 0; s < kFastrakStations; ++s) map |= plugged(s, now) ? 1 << s : 0;
        status.tag = std::string("F3") + "0123456789ABCDEF"[map];
      }
      reply(encode_status(status), now);
      break;
    }
    case 'F':
      setup_.binary = false;
      break;
    case 'f':
      setup_.binary = true;
      break;
    case 'U':
      setup_.centimetres = false;
      break;
    case 'u':
      setup_.centimetres = true;
      break;
    case 'D':
      setup_.compensation = true;
      break;
    case 'd':
      setup_.compensation = false;
      break;
    case 'W':
      setup_ = factory_setup(now);
      std::erase_if(queue_, [](const Message& m) { return m.stream && m.sent == 0; });
      break;
    default:
      break;
  }
}

void FastrakEmulator::refuse(std::string_view command, FastrakRefusal why, std::size_t position,
                             std::size_t field, int station, Time now) {
  ++statistics_.refused;
  if (!setup_.binary) reply(encode_refusal(command, why, position, field, station), now);
}

void FastrakEmulator::run_line(Time now) {
  if (line_.size() > kLongestLine) {
    refuse(line_, FastrakRefusal::kBufferLimit, kLongestLine, 0, 1, now);
    return;
  }
  const Line line(line_);
  try {
    carry_out(line, now);
    ++statistics_.commands;
  } catch (const RefusedField& refused) {
    const std::string_view first = line.fields[0];
    const bool known = first.size() == 1 && first[0] >= '1' && first[0] <= '4';
    const std::size_t position =
        refused.field < line.starts.size() ? line.starts[refused.field] : line_.size();
    refuse(line_, refused.why, position, refused.field, known ? first[0] - '0' : 1, now);
  }
}

bool FastrakEmulator::align(std::size_t station, const std::array<Vec3, 3>& points) {
  std::array<Vec3, 3>& stored = setup_.stations[station].p_TA;
  const Pose X_TA = frame_through(stored[0], stored[1], stored[2]).value();
  const std::array<Vec3, 3> p_T = {X_TA * points[0], X_TA * points[1], X_TA * points[2]};
  if (!frame_through(p_T[0], p_T[1], p_T[2])) return false;
  stored = p_T;
  return true;
}

void FastrakEmulator::point_of_alignment(Time now) {
  if (!solutions_[0].valid) measure(0, now);
  guided_->push_back(solutions_[0].X_TS * setup_.stations[0].p_SN);
  if (guided_->size() < 3) return;
  const std::array<Vec3, 3> points = {(*guided_)[0], (*guided_)[1], (*guided_)[2]};
  guided_.reset();
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    if (!align(s, points)) {
      refuse("A0", FastrakRefusal::kOutOfRange, 1, 0, 1, now);
      return;
    }
  }
  carry_out(Line("A1"), now);  // shows the new frame
}

void FastrakEmulator::carry_out(const Line& line, Time now) {
  const double unit = setup_.centimetres ? kMetrePerCentimetre : kMetrePerInch;
  constexpr double kWidest7 = 999.99, kWidest8 = 999.999;  // what the read-back's columns hold
  const auto answer = [&](int station, std::span<const double> values, int width, int decimals) {
    reply(encode_reply(station, line.letter, encode_columns(values, width, decimals)), now);
  };
  // Three values, in the wire's unit: sets them, or reads them back when no field follows.
  const auto three = [&](Vec3& stored, double metre, const std::array<double, 3>& limits, int width,
                         int decimals) {
    const int station = static_cast<int>(line.station()) + 1;
    const std::array<double, 3> now_stored = {stored.x() / metre, stored.y() / metre,
                                              stored.z() / metre};
    if (line.blank_from(1)) {
      answer(station, now_stored, width, decimals);
    } else {
      const auto v = line.merged(1, now_stored, limits);
      stored = metre * Vec3(v[0], v[1], v[2]);
    }
  };
  // A box: three largest values, then three smallest.
  const auto box = [&](std::array<Vec3, 2>& stored, double metre,
                       const std::array<double, 6>& limits) {
    const int station = static_cast<int>(line.station()) + 1;
    std::array<double, 6> values{};
    for (std::size_t i = 0; i < 6; ++i) {
      values[i] = stored[i / 3](static_cast<Eigen::Index>(i % 3)) / metre;
    }
    if (line.blank_from(1)) {
      answer(station, values, 8, 3);
      return;
    }
    values = line.merged(1, values, limits);
    for (std::size_t i = 0; i < 3; ++i) {
      if (values[i] < values[i + 3]) throw RefusedField{FastrakRefusal::kOutOfRange, i + 1};
    }
    stored = {metre * Vec3(values[0], values[1], values[2]),
              metre * Vec3(values[3], values[4], values[5])};
  };
  constexpr std::array<double, 3> kAngles = {180.0, 90.0, 180.0};

  switch (line.letter) {
    case 'A': {
      if (line.fields[0] == "0" && line.blank_from(1)) {
        for (FastrakStationSetup& station : setup_.stations) {
          station.p_TA = FastrakStationSetup{}.p_TA;
        }
        guided_.emplace();
        break;
      }
      const std::size_t s = line.station();
      // New points are given in the present frame; there, its own three stand at the factory's.
      const std::array<Vec3, 3> start =
          line.blank_from(1) ? setup_.stations[s].p_TA : FastrakStationSetup{}.p_TA;
      std::array<double, 9> values{}, limits{};
      for (std::size_t i = 0; i < 9; ++i) {
        values[i] = start[i / 3](static_cast<Eigen::Index>(i % 3)) / unit;
        limits[i] = kWidest7;
      }
      if (line.blank_from(1)) {
        answer(static_cast<int>(s) + 1, values, 7, 2);
        break;
      }
      values = line.merged(1, values, limits);
      std::array<Vec3, 3> points;
      for (std::size_t i = 0; i < 3; ++i) {
        points[i] = unit * Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
      }
      if (!align(s, points)) throw RefusedField{FastrakRefusal::kOutOfRange, 1};
      break;
    }
    case 'R': {
      const auto [first, last] = line.stations();
      for (std::size_t s = first; s < last; ++s) {
        setup_.stations[s].p_TA = FastrakStationSetup{}.p_TA;
      }
      break;
    }
    case 'B': {
      const auto [first, last] = line.stations();
      for (std::size_t s = first; s < last; ++s) {
        if (!active(s)) continue;
        if (!solutions_[s].valid) measure(s, now);
        setup_.stations[s].q_boresight = outcome(s).q;
      }
      break;
    }
    case 'b': {
      const auto [first, last] = line.stations();
      for (std::size_t s = first; s < last; ++s) setup_.stations[s].q_boresight.reset();
      break;
    }
    case 'G':
      three(setup_.stations[line.station()].boresight_deg, 1.0, kAngles, 7, 2);
      break;
    case 'H':
      three(setup_.stations[line.station()].zenith, 1.0, {kWidest7, kWidest7, kWidest7}, 7, 2);
      break;
    case 'N':
      three(setup_.stations[line.station()].p_SN, unit, {kWidest8, kWidest8, kWidest8}, 8, 3);
      break;
    case 'r':
      three(setup_.stations[line.station()].mounting_deg, 1.0, kAngles, 8, 3);
      break;
    case 'I': {
      const std::size_t s = line.station();
      if (line.blank_from(1)) {
        const std::array<double, 1> stored = {setup_.stations[s].increment / unit};
        answer(static_cast<int>(s) + 1, stored, 7, 2);
      } else {
        setup_.stations[s].increment = unit * line.number(1, 0.0, kWidest7);
      }
      break;
    }
    case 'V': {
      std::array<double, 6> limits{};
      limits.fill(kWidest8);
      box(setup_.stations[line.station()].position_envelope, unit, limits);
      break;
    }
    case 'Q':
      box(setup_.stations[line.station()].angle_envelope_deg, 1.0, {180, 90, 180, 180, 90, 180});
      break;
    case 'l': {
      const auto [first, last] = line.stations();
      if (line.blank_from(1)) {
        std::array<bool, kFastrakStations> on{};
        for (std::size_t s = 0; s < on.size(); ++s) on[s] = active(s);
        reply(encode_active(static_cast<int>(first) + 1, on), now);
        break;
      }
      const bool on = line.whole(1, 0, 1) == 1;
      for (std::size_t s = first; s < last; ++s) {
        setup_.stations[s].on = on && plugged(s, now);
        if (!setup_.stations[s].on) solutions_[s].valid = false;
      }
      break;
    }
    case 'O': {
      const std::size_t s = line.station();
      std::vector<int>& items = setup_.stations[s].items;
      if (line.blank_from(1)) {
        reply(encode_list(static_cast<int>(s) + 1, items), now);
        break;
      }
      std::vector<int> list;
      for (std::size_t i = 1; i < line.fields.size(); ++i) {
        if (i > kMostItems) throw RefusedField{FastrakRefusal::kBufferLimit, i};
        const bool keeps = line.blank(i) && i <= items.size();
        const int item = keeps ? items[i - 1] : line.whole(i, 0, 99);
        if (!is_fastrak_item(item, options_.early_firmware)) {
          throw RefusedField{FastrakRefusal::kOutOfRange, i};
        }
        list.push_back(item);
      }
      if (fastrak_record_length({list, false, false}) > kLongestRecord) {
        throw RefusedField{FastrakRefusal::kBufferLimit, line.fields.size() - 1};
      }
      items = std::move(list);
      break;
    }
    case 'e': {
      // The station may be left out, and the unit does not look at it.
      const bool alone = line.fields.size() == 1;
      setup_.point_mode = line.whole(alone ? 0 : 1, 0, 1) == 1;
      break;
    }
    case 'o': {
      Port port = port_;
      if (!line.blank(0)) {
        port.baud = 100 * line.whole(0, 24, 1152);
        if (std::find(kBauds.begin(), kBauds.end(), port.baud) == kBauds.end()) {
          throw RefusedField{FastrakRefusal::kOutOfRange, 0};
        }
      }
      if (!line.blank(1)) {
        const std::string_view parity = line.fields[1];
        if (parity != "N" && parity != "O" && parity != "E") {
          throw RefusedField{FastrakRefusal::kOutOfRange, 1};
        }
        port.parity = parity != "N";
      }
      if (!line.blank(2)) port.bits = line.whole(2, 7, 8);
      if (!line.blank(3)) line.whole(3, 0, 1);  // hardware handshake: a wire that is not here
      if (port.bits == 8 && port.parity) throw RefusedField{FastrakRefusal::kOutOfRange, 1};
      port_ = port;
      break;
    }
    case 'T': {
      const int number = line.blank(0) ? error_ : line.whole(0, 0, 122);
      if (!line.blank(1)) {
        line.whole(1, 0, 0);
        error_ = 0;
        break;
      }
      reply(
          encode_reply(0, 'T', blank_or(number, 3) + " " + std::string(fastrak_error_text(number))),
          now);
      break;
    }
    case 'v':
    case 'x': {
      FastrakFilter& stored = line.letter == 'v' ? setup_.attitude_filter : setup_.position_filter;
      const std::array<double, 4> values = {stored.sensitivity, stored.low, stored.high,
                                            stored.factor};
      if (line.blank_from(0)) {
        answer(0, values, 7, 3);
        break;
      }
      if (line.blank_from(1) && line.number(0) >= 2.0) {
        // Macros (p. 77); the numbers are those of the maker's later trackers.
        constexpr std::array<FastrakFilter, 4> kMacros = {{{0.2, 1.0, 0.8, 0.95},
                                                           {0.2, 0.2, 0.8, 0.8},
                                                           {0.2, 0.1, 0.7, 0.8},
                                                           {0.2, 0.05, 0.6, 0.8}}};
        stored = kMacros[static_cast<std::size_t>(line.whole(0, 2, 5)) - 2];
        break;
      }
      const auto v = line.merged(0, values, {1.0, 1.0, 1.0, 1.0});
      for (std::size_t i = 0; i < 4; ++i) {
        if (v[i] < 0.0) throw RefusedField{FastrakRefusal::kOutOfRange, i};
      }
      if (v[1] < 1.0 && !(v[1] > 0.0 && v[1] <= v[2])) {
        throw RefusedField{FastrakRefusal::kOutOfRange, 1};
      }
      stored = {v[0], v[1], v[2], v[3]};
      break;
    }
    case 'X': {
      const std::string_view text = line.text.substr(1);
      if (text.empty()) {
        std::string shown = setup_.identification;
        shown.resize(32, ' ');
        reply(encode_reply(0, 'X', shown), now);
        break;
      }
      if (text.size() > 32) throw RefusedField{FastrakRefusal::kBufferLimit, 0};
      setup_.identification = text;
      break;
    }
    case 'y':
      if (line.blank_from(0)) {
        reply(encode_reply(0, 'y', std::to_string(setup_.sync)), now);
      } else {
        setup_.sync = line.whole(0, 0, 2);
      }
      break;
    default:
      break;
  }
}

void serve(FastrakEmulator& emulator, ByteStream& stream, Time now) {
  std::array<std::uint8_t, 512> heard{};
  while (const std::size_t n = stream.read(heard)) {
    emulator.receive(Bytes(heard).first(n), now);
    if (n < heard.size()) break;
  }
  const Bytes due = emulator.due(now);
  if (!due.empty()) emulator.taken(stream.write(due));
}

}  // namespace headpin::devices
