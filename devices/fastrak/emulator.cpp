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
constexpr std::size_t kHeldLimit = 1024;    // bytes of commands waiting for ^K

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
  for (std::size_t s = 0; s < eeprom_.stations.size(); ++s) {
    eeprom_.stations[s].on = s < static_cast<std::size_t>(options_.receivers);  // once plugged in
  }
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
  sending_.drop_unsent(false);
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
  await_first_station();
  sending_.start();
}

void FastrakEmulator::power_cycle(Time now) {
  advance(now);
  sending_.drop_all();
  hearing_ = {};
  status_requests_ = 0;
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
  return sending_.out();
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
  FastrakSolution& solution = solutions_[station];
  const bool pulled_out = !plugged(station, at);
  Time when = at, cycle = tick_time(cycle_, kFastrakCycleRate);
  for (const StationFault& stuck : options_.faults.stuck) {  // its noise stands still as well
    if (stuck.station == number && stuck.when.holds(at)) when = cycle = stuck.when.from;
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
  Random random(options_.seed, kNoise + station, static_cast<std::uint64_t>(cycle.count()));
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
  FastrakPort port = memory_.port;
  if (options_.faults.slow_baud > 0) port.baud = std::min(port.baud, options_.faults.slow_baud);
  sending_.pump(now, {port, [this](Time t) { return silent(t); },
                      [this](const FastrakMessage& message) { count_sent(message); }});
}

void FastrakEmulator::count_sent(const FastrakMessage& message) {
  statistics_.records += static_cast<std::int64_t>(message.records.size());
  statistics_.garbage_bytes += static_cast<std::int64_t>(message.garbage);
  for (const FastrakSent& record : message.records) {
    if (record.damaged) ++statistics_.damaged;
    if (options_.on_record) options_.on_record(record);
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

FastrakFormat FastrakEmulator::format_of(std::size_t station) const {
  return {memory_.setup.stations[station].items, memory_.setup.binary, memory_.setup.centimetres};
}

Pose FastrakEmulator::outcome(std::size_t station) const {
  return pose_reported(memory_.setup.stations[station], solutions_[station].X_TS);
}

FastrakRecord FastrakEmulator::record_of(std::size_t station) {
  const FastrakSolution& solution = solutions_[station];
  std::optional<Vec3>& last = last_output_[station];
  FastrakRecord record =
      devices::record_of(memory_.setup.stations[station], solution, last.value_or(Vec3::Zero()),
                         format_of(station).metre_per_unit());
  record.station = static_cast<int>(station) + 1;
  if (record.error != solution.error) memory_.error = static_cast<unsigned char>(record.error);
  last = outcome(station).p;
  return record;
}

void FastrakEmulator::offer(std::size_t station, Time now) {
  if (!memory_.setup.continuous || switched_off_) return;
  if (!expected_ || !active(*expected_)) expected_ = next_active(kFastrakStations - 1);
  const bool its_turn = station == *expected_;
  if (!its_turn || !sending_.is_free()) {
    late_ |= its_turn;
    if (late_) ++statistics_.dropped;  // otherwise the first turn has not begun
    return;
  }
  late_ = false;
  expected_ = next_active(station);
  const double increment = memory_.setup.stations[station].increment;
  if (increment > 0.0 && last_output_[station] &&
      (outcome(station).p - *last_output_[station]).norm() < increment) {
    return;
  }
  FastrakMessage message;
  message.due = now;
  message.stream = true;
  Random random(options_.seed, kFaults, outputs_);
  if (random.uniform() < options_.faults.dropout) {
    ++outputs_;
    ++statistics_.lost;
    message.lost = true;
    message.bytes.resize(fastrak_record_length(format_of(station)));
  } else {
    add_record(station, message);
  }
  queue(std::move(message));
}

void FastrakEmulator::add_record(std::size_t station, FastrakMessage& message) {
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
  FastrakMessage message;
  message.due = now + kCycle;
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    if (!active(s)) continue;
    if (!solutions_[s].valid) measure(s, now);
    add_record(s, message);
  }
  queue(std::move(message));
}

void FastrakEmulator::reply(const std::string& line, Time now) {
  FastrakMessage message;
  message.due = now + kCycle;
  message.bytes.assign(line.begin(), line.end());
  queue(std::move(message));
}

void FastrakEmulator::queue(FastrakMessage message) {
  const auto records = static_cast<std::int64_t>(message.records.size());
  if (!sending_.add(std::move(message))) statistics_.dropped += records;
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
    act_on(hearing_.hear(memory_.port.bits == 7 ? bytes[i] & 0x7F : bytes[i]), now);
  }
}

void FastrakEmulator::act_on(const FastrakHeard& heard, Time now) {
  switch (heard.kind) {
    case FastrakHeard::Kind::control:
      return control(heard.text[0], now);
    case FastrakHeard::Kind::immediate:
      return immediate(heard.text[0], now);
    case FastrakHeard::Kind::line:
      return run_line(heard.text, now);
    case FastrakHeard::Kind::unknown:
      return refuse(heard.text, FastrakRefusal::unknown_command, 0, 0, 1, now);
    case FastrakHeard::Kind::nothing:
      return;
  }
}

void FastrakEmulator::control(char c, Time now) {
  ++statistics_.commands;
  if (c == kFastrakSave) save(now);
  if (c == kFastrakResume) sending_.resume(now);
  if (c == kFastrakSuspend) sending_.suspend();
  if (c == kFastrakReinitialise) start_up(now);
}

void FastrakEmulator::save(Time now) {
  eeprom_ = memory_.setup;
  for (FastrakStationSetup& station : eeprom_.stations) {
    station.q_boresight.reset();
  }
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    eeprom_.stations[s].p_SN = factory_setup(now).stations[s].p_SN;
  }
  if (eeprom_.sync == 1) eeprom_.sync = 0;
  saved_at_ = now + options_.save_time;
}

void FastrakEmulator::stream() {
  ++statistics_.streams;
  if (!memory_.setup.continuous) await_first_station();
  memory_.setup.continuous = true;
  switched_off_ = false;
  if (const auto station = expected_ ? expected_ : next_active(kFastrakStations - 1)) {
    stream_zero_ = *next_measured(static_cast<int>(*station) + 1, Time{});
  }
}

FastrakStatus FastrakEmulator::status(Time now) const {
  FastrakStatus status;
  status.binary = memory_.setup.binary;
  status.centimetres = memory_.setup.centimetres;
  status.compensation = memory_.setup.compensation;
  status.continuous = memory_.setup.continuous;
  status.error = memory_.error;
  status.firmware = options_.firmware;
  status.identification = memory_.setup.identification;
  if (options_.tag_2012) {
    // The coding of the sensor map is not known. Our choice: one hex digit, bit 0 for station 1.
    int map = 0;
    for (std::size_t s = 0; s < kFastrakStations; ++s) map |= plugged(s, now) ? 1 << s : 0;
    status.tag = std::string("F3") + "0123456789ABCDEF"[map];
  }
  return status;
}

void FastrakEmulator::immediate(char command, Time now) {
  ++statistics_.commands;
  if (switch_setting(command, memory_.setup)) return;
  switch (command) {
    case 'P':
      return send_point(now);
    case 'C':
      return stream();
    case 'c':
      memory_.setup.continuous = false;
      return sending_.drop_unsent(true);
    case 'S':
      if (++status_requests_ > options_.faults.deaf) reply(encode_status(status(now)), now);
      return;
    case 'W':
      memory_.setup = factory_setup(now);
      return sending_.drop_unsent(true);
    default:
      return;
  }
}

void FastrakEmulator::refuse(std::string_view command, FastrakRefusal why, std::size_t position,
                             std::size_t field, int station, Time now) {
  ++statistics_.refused;
  if (!memory_.setup.binary) reply(encode_refusal(command, why, position, field, station), now);
}

void FastrakEmulator::run_line(const std::string& line, Time now) {
  if (line.size() > kFastrakLongestLine) {
    refuse(line, FastrakRefusal::buffer_limit, kFastrakLongestLine, 0, 1, now);
    return;
  }
  commanded_ = now;
  try {
    const std::string answer = carry_out(line, memory_);
    if (!answer.empty()) reply(answer, now);
    ++statistics_.commands;
  } catch (const FastrakRefused& refused) {
    refuse(line, refused.why, refused.position, refused.field, refused.station, now);
  }
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    if (!active(s)) solutions_[s].valid = false;
  }
}

void FastrakEmulator::point_of_alignment(Time now) {
  if (!solutions_[0].valid) measure(0, now);
  memory_.guided->push_back(solutions_[0].X_TS * memory_.setup.stations[0].p_SN);
  if (memory_.guided->size() < 3) return;
  const std::array<Vec3, 3> points = {(*memory_.guided)[0], (*memory_.guided)[1],
                                      (*memory_.guided)[2]};
  memory_.guided.reset();
  for (FastrakStationSetup& station : memory_.setup.stations) {
    if (!align(station, points)) {
      refuse("A0", FastrakRefusal::out_of_range, 1, 0, 1, now);
      return;
    }
  }
  reply(alignment_answer(memory_, 0), now);  // shows the new frame
}

}  // namespace headpin::devices
