#include "devices/fastrak/emulator.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace headpin::devices {
namespace {

constexpr Time kCycle{8333};                // 1 / kFastrakCycleRate
constexpr Time kSolutionReady{5500};        // after the start of the field (p. E-2)
constexpr Time kMidSampling{5500 - 3750};   // effective latency 3.75 ms (p. E-4)
constexpr std::int64_t kSwitchCycles = 40;  // between readings of the stylus switch
constexpr std::size_t kOutboxLimit = 1024;  // bytes that a reader may leave
constexpr Time kPiece{50'000};              // no line fills the outbox in this time
constexpr std::size_t kQueueLimit = 8192;   // bytes of answers waiting for the line

// Purposes of random numbers.
constexpr std::uint64_t kNoise = 0, kFaults = 16;

}  // namespace

FastrakEmulator::FastrakEmulator(FastrakEmulatorOptions options, FastrakMotion motion)
    : options_(std::move(options)), motion_(std::move(motion)) {
  if (options_.receivers < 1 || options_.receivers > kFastrakStations) {
    throw std::invalid_argument("receivers: expected 1 to 4, found " +
                                std::to_string(options_.receivers));
  }
  if (options_.stylus < 0 || options_.stylus > kFastrakStations) {
    throw std::invalid_argument("stylus: expected a station from 1 to 4, or 0 for none, found " +
                                std::to_string(options_.stylus));
  }
  if (std::find(kFastrakBauds.begin(), kFastrakBauds.end(), options_.baud) == kFastrakBauds.end()) {
    throw std::invalid_argument(
        "baud: expected one of 2400 4800 9600 19200 38400 57600 115200, "
        "found " +
        std::to_string(options_.baud));
  }
  memory_.early_firmware = options_.early_firmware;
  memory_.plugged = [this](std::size_t s) { return plugged(s, commanded_); };
  memory_.attitude = [this](std::size_t s) {
    if (!solutions_[s].valid) measure(s, commanded_);
    return outcome(s).q;
  };
  eeprom_ = factory_setup(Time{0});
  start_up(Time{0});
  listening_from_ = Time{0};  // the unit is already on and ready
}

FastrakSetup FastrakEmulator::factory_setup(Time now) const {
  FastrakSetup setup;
  if (options_.stylus > 0) {
    setup.stations[static_cast<std::size_t>(options_.stylus - 1)].p_SN = options_.p_SN_stylus;
  }
  const Vec3 corner = Vec3::Constant(options_.envelope);
  for (std::size_t s = 0; s < setup.stations.size(); ++s) {
    setup.stations[s].on = plugged(s, now);
    setup.stations[s].position_envelope = {corner, -corner};
  }
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

bool FastrakEmulator::pressed(Time t) const {
  return options_.stylus > 0 && plugged(static_cast<std::size_t>(options_.stylus - 1), t) &&
         motion_(options_.stylus, t).pressed;
}

void FastrakEmulator::start_up(Time now) {
  memory_.setup = eeprom_;
  for (std::size_t s = 0; s < memory_.setup.stations.size(); ++s) {
    memory_.setup.stations[s].on = memory_.setup.stations[s].on && plugged(s, now);
  }
  memory_.port = {options_.baud, 8, false};
  drop_unsent();
  listening_from_ = now + options_.boot_time;
  saved_at_ = Time{0};
  held_.clear();
  solutions_ = {};
  position_weights_ = {};
  attitude_weights_ = {};
  last_output_ = {};
  memory_.error = 0;
  switch_was_down_ = switched_off_ = false;
  memory_.guided.reset();
  expected_.reset();
  suspended_ = false;
  line_.clear();
  swallow_ = Swallow::nothing;
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
    const Time start = tick_time(cycle_, kFastrakCycleRate);
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

std::optional<Time> FastrakEmulator::next_measured(int station, Time from) const {
  const auto wanted = static_cast<std::size_t>(station - 1);
  if (station < 1 || wanted >= kFastrakStations || !active(wanted)) return std::nullopt;
  std::int64_t cycle = cycle_;
  for (std::size_t s = *next_active(measured_);; s = *next_active(s), ++cycle) {
    const Time at = tick_time(cycle, kFastrakCycleRate) + kMidSampling;
    if (s == wanted && at >= from) return at;
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
  const FastrakStationSetup& setup = memory_.setup.stations[station];

  solution.error = pulled_out ? 'l' : truth.error;
  solution.pressed = pressed(at);  // the unit has one switch; any station's record may carry it
  solution.measured = at;
  if (pulled_out && solution.valid) {
    memory_.error = static_cast<unsigned char>(solution.error);
    return;
  }

  Pose X_TS = distort(truth.X_TS, options_.faults.metal);
  const double range = X_TS.p.norm();
  if (range > kFastrakRange && solution.error == ' ') solution.error = 'k';
  if (memory_.setup.sync == 2 && solution.error == ' ') solution.error = 'v';
  const FastrakNoise noise = noise_at(range);
  Random random(options_.seed, kNoise + station,
                static_cast<std::uint64_t>(tick_time(cycle_, kFastrakCycleRate).count()));
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
    if (memory_.setup.position_filter.enabled()) {
      const double inches = (X_TS.p - last.p).norm() / kMetrePerInch;
      const double a = position_weights_[station].next(memory_.setup.position_filter, inches);
      X_TS.p = a * X_TS.p + (1.0 - a) * last.p;
    }
    if (memory_.setup.attitude_filter.enabled()) {
      const double degrees =
          rotation_vector(last.q.conjugate() * X_TS.q).norm() * 180.0 / std::numbers::pi;
      const double a = attitude_weights_[station].next(memory_.setup.attitude_filter, degrees);
      X_TS.q = interpolate({last.q, Vec3::Zero()}, {X_TS.q, Vec3::Zero()}, a).q;
    }
  }
  solution.X_TS = X_TS;
  solution.valid = true;
  if (solution.error != ' ') memory_.error = static_cast<unsigned char>(solution.error);
}

void FastrakEmulator::look_at_switch(Time now) {
  const bool down = pressed(now);
  const bool pressed_now = down && !switch_was_down_;
  switch_was_down_ = down;
  if (!memory_.setup.point_mode) return;
  if (memory_.setup.continuous) {
    if (pressed_now) switched_off_ = !switched_off_;
  } else if (down) {
    send_point(now);
  }
}

void FastrakEmulator::pump(Time now) {
  const std::int64_t now_ns = now.count() * 1000;
  const int baud = options_.faults.slow_baud > 0
                       ? std::min(memory_.port.baud, options_.faults.slow_baud)
                       : memory_.port.baud;
  const int bits =
      1 + memory_.port.bits + (memory_.port.parity ? 1 : 0) + 1;  // start, data, parity, stop
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
    outbox_.push_back(memory_.port.bits == 7 ? byte & 0x7F : byte);
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
  // The last byte needs no more waiting; the next record may be written after it.
  return queue_.empty() ||
         (queue_.size() == 1 && queue_.front().sent + 1 >= queue_.front().bytes.size());
}

FastrakFormat FastrakEmulator::format_of(std::size_t station) const {
  return {memory_.setup.stations[station].items, memory_.setup.binary, memory_.setup.centimetres};
}

Pose FastrakEmulator::outcome(std::size_t station) const {
  const FastrakStationSetup& setup = memory_.setup.stations[station];
  Pose X = solutions_[station].X_TS;
  X.p = X * setup.p_SN;
  X = frame_through(setup.p_TA[0], setup.p_TA[1], setup.p_TA[2]).value().inverse() * X;
  X = Pose{from_angles_deg(setup.mounting_deg), Vec3::Zero()} * X;
  return X;
}

FastrakRecord FastrakEmulator::record_of(std::size_t station) {
  const FastrakStationSetup& setup = memory_.setup.stations[station];
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
    if (record.error != ' ') memory_.error = static_cast<unsigned char>(record.error);
  }
  last_output_[station] = X.p;
  return record;
}

void FastrakEmulator::offer(std::size_t station, Time now) {
  if (!memory_.setup.continuous || switched_off_) return;
  if (!expected_ || !active(*expected_)) expected_ = next_active(kFastrakStations - 1);
  if (station != *expected_ || !line_free()) {
    ++statistics_.dropped;
    return;
  }
  expected_ = next_active(station);
  const double increment = memory_.setup.stations[station].increment;
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
  if (memory_.guided) {
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

Time begin_of(const TrackerSample& first, const FastrakEmulator& emulator, Time now) {
  const Time three_cycles = tick_time(3, kFastrakCycleRate);
  const Time wanted = now + first.device_time;
  const std::optional<Time> next = emulator.next_measured(first.station, wanted);
  for (std::optional<Time> at = next; at && *at <= wanted + 4 * three_cycles;
       at = emulator.next_measured(first.station, *at + Time{1})) {
    const Time begin = *at - first.device_time;
    if ((begin - emulator.stream_zero()) % three_cycles == Time{0}) return begin;
  }
  return next.value_or(wanted) - first.device_time;
}

void serve(FastrakEmulator& emulator, ByteStream& stream, Time now) {
  // After a delay of the server, the bytes that would have left by now are passed on in pieces.
  // They may be more than the outbox can hold, although no reader was late.
  for (Time then = emulator.now() + kPiece; then < now; then += kPiece) {
    emulator.taken(stream.write(emulator.due(then)));
  }
  std::array<std::uint8_t, 512> heard{};
  while (const std::size_t n = stream.read(heard)) {
    emulator.receive(Bytes(heard).first(n), now);
    if (n < heard.size()) break;
  }
  const Bytes due = emulator.due(now);
  if (!due.empty()) emulator.taken(stream.write(due));
}

}  // namespace headpin::devices
