#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/base/sample.h"
#include "devices/fastrak/codec.h"
#include "devices/fastrak/commands.h"
#include "devices/fastrak/faults.h"
#include "devices/fastrak/geometry.h"
#include "devices/fastrak/hearing.h"
#include "devices/fastrak/motion.h"
#include "devices/fastrak/replies.h"
#include "devices/fastrak/sending.h"
#include "devices/fastrak/solution.h"

namespace headpin::devices {

struct FastrakEmulatorOptions {
  int receivers = 2;                ///< plugged in, from station 1 on
  int baud = 115200;                ///< set at the switches
  bool early_firmware = false;      ///< has the compact output items 18 to 20
  bool tag_2012 = false;            ///< status record with the "F3" tag of 2012
  std::string firmware = "103.00";  ///< 6 characters
  int stylus = 1;                   ///< station whose receiver has the switch; 0: none has
  Vec3 p_SN_stylus = Vec3::Zero();  ///< tip offset in that one's PROM; a stylus has some 2.5 inches
                                    ///< along x, an ordinary receiver none [m]
  double envelope = 2.0;            ///< the factory's: beyond it, along any axis, a position is
                                    ///< flagged [m]
  std::uint64_t seed = 1;           ///< of noise and faults
  FastrakFaults faults;
  Time boot_time{10'000'000};                         ///< without answers after ^Y or power-on
  Time save_time{3'000'000};                          ///< without output during ^K
  std::function<void(const FastrakSent&)> on_record;  ///< called as a record is handed to the line
};

struct FastrakEmulatorStatistics {
  std::int64_t records = 0;        ///< data records handed to the line
  std::int64_t dropped = 0;        ///< solutions dropped whole because line or reader were too slow
  std::int64_t lost = 0;           ///< records lost by the fault `dropout`
  std::int64_t damaged = 0;        ///< records sent with a flipped bit
  std::int64_t garbage_bytes = 0;  ///< random bytes sent between records
  std::int64_t commands = 0;       ///< understood
  std::int64_t streams = 0;  ///< of these, C: continuous output on, again or for the first time
  std::int64_t refused = 0;  ///< answered, in ASCII mode, by an error record
};

/// An emulated Fastrak at its serial line: it answers commands like the real unit.
///
/// A state machine with time as an argument, so it runs in real time, faster or slower. `receive`
/// takes the bytes of the host, `due` returns the bytes that have left by now.
///
/// Our choices, where the manuals do not say anything:
/// - An answer begins one cycle (8.33 ms) after the command, at the line's baud rate, from the
///   state at the command. P reports the newest solution of each active station.
/// - Continuous records keep the station order: if the line cannot take a record in time, the whole
///   record is dropped, and the unit waits until it is that station's turn again.
/// - Refusals are answered in ASCII mode and silent in binary mode. A bare CR is refused, a bare LF
///   ignored; CR, LF or both behind a line or an immediate command end nothing more. An unknown
///   letter is refused at once and does not take the bytes behind it along. Blanks before a command
///   are ignored. Lines beyond 254 bytes are refused whole. Fields behind a command's last one are
///   ignored.
/// - `*` as station means all of them for B, b, R and l. A station without receiver cannot be
///   switched on. Unplugged while running, it reports its last pose with the letter `l`.
/// - W acts on the running set-up, not on the EEPROM and not on the port. Sync modes 0 and 1 run at
///   120 Hz; 2 reports `v`, as there is no CRT. Compensation is a flag without effect.
/// - ^K keeps all but boresight, tip offset and sync mode 1. Commands that come while it saves are
///   carried out afterwards; those that come during the start-up after ^Y are lost.
/// - Increment applies to continuous output only. Alignment, then mounting frame, then boresight;
///   a transmitter mounted at r makes a pose in the room r times the pose it measures.
class FastrakEmulator {
 public:
  /// @param motion  asked at the middle of each measurement, for stations that are plugged in
  /// @throws std::invalid_argument  with other than 1 to 4 receivers or a rate a Fastrak lacks
  FastrakEmulator(FastrakEmulatorOptions options, FastrakMotion motion);
  FastrakEmulator(const FastrakEmulator&) = delete;
  FastrakEmulator& operator=(const FastrakEmulator&) = delete;

  /// Bytes from the host, complete or not, arriving at `now`.
  void receive(Bytes bytes, Time now);

  /// The bytes that have left by `now` and were not taken yet, oldest first. `now` must not
  /// decrease.
  Bytes due(Time now);

  /// Removes the first `count` bytes, which the reader took. If a reader leaves more than a
  /// kilobyte, whole records are dropped.
  void taken(std::size_t count) { sending_.taken(count); }

  /// The time of measurement of the first record of the current continuous output, from which
  /// drivers count cycles.
  Time stream_zero() const { return stream_zero_; }

  /// The time of the next measurement of a station at or after `from`; nothing for a station that
  /// is off.
  std::optional<Time> next_measured(int station, Time from) const;

  /// Switches the unit off and on: the line stops within a byte, the settings are those of the
  /// EEPROM, and the unit neither receives nor sends until it has started.
  void power_cycle(Time now);

  void set_motion(FastrakMotion motion) { motion_ = std::move(motion); }
  /// @throws std::invalid_argument  for a fault of a receiver that the unit does not have
  void set_faults(const FastrakFaults& faults) {
    check_stations(faults, options_.receivers);
    options_.faults = faults;
    status_requests_ = 0;
  }

  Time now() const { return now_; }  ///< time of the last call
  const FastrakSetup& setup() const { return memory_.setup; }
  const FastrakEmulatorStatistics& statistics() const { return statistics_; }
  int baud() const { return memory_.port.baud; }

 private:
  // Time.
  void advance(Time now);
  void run_cycles(Time now);
  void pump(Time now);
  void measure(std::size_t station, Time at);
  bool silent(Time t) const;
  bool plugged(std::size_t station, Time t) const;
  bool pressed(Time t) const;
  void start_up(Time now);
  void look_at_switch(Time now);

  // Output.
  FastrakFormat format_of(std::size_t station) const;
  Pose outcome(std::size_t station) const;
  FastrakRecord record_of(std::size_t station);
  void offer(std::size_t station, Time now);
  void await_first_station() {
    expected_.reset();
    late_ = false;
  }
  void add_record(std::size_t station, FastrakMessage& message);
  void send_point(Time now);
  void reply(const std::string& line, Time now);
  void queue(FastrakMessage message);
  void count_sent(const FastrakMessage& message);
  bool active(std::size_t station) const { return memory_.setup.stations[station].on; }
  std::optional<std::size_t> next_active(std::size_t after) const;

  // Commands.
  void hear_all(Bytes bytes, Time now);
  void act_on(const FastrakHeard& heard, Time now);
  void control(char c, Time now);
  void save(Time now);
  void immediate(char command, Time now);
  void stream();
  FastrakStatus status(Time now) const;
  void run_line(const std::string& line, Time now);
  void refuse(std::string_view command, FastrakRefusal why, std::size_t position, std::size_t field,
              int station, Time now);
  void point_of_alignment(Time now);
  FastrakSetup factory_setup(Time now) const;

  FastrakEmulatorOptions options_;
  FastrakMotion motion_;
  FastrakEmulatorStatistics statistics_;
  FastrakMemory memory_;
  Time commanded_{};  ///< arrival of the current command
  FastrakSetup eeprom_;

  Time now_{};
  std::int64_t cycle_ = 0;          ///< next one to be run
  Time listening_from_{};           ///< start-up: neither receives nor sends before
  Time saved_at_{};                 ///< ^K: nothing measured, and commands wait, before
  std::vector<std::uint8_t> held_;  ///< bytes that arrived while saving
  std::size_t measured_ = kFastrakStations - 1;  ///< station of the last measurement
  std::array<FastrakSolution, kFastrakStations> solutions_;
  std::array<AdaptiveWeight, kFastrakStations> position_weights_, attitude_weights_;
  std::array<std::optional<Vec3>, kFastrakStations> last_output_;  ///< position reported [m]
  int status_requests_ = 0;       ///< since power-on or set_faults()
  bool switch_was_down_ = false;  ///< at the last reading of the stylus switch
  bool switched_off_ = false;     ///< continuous output, by the stylus switch

  Time stream_zero_{};
  std::optional<std::size_t> expected_;  ///< station whose record continuous output sends next
  bool late_ = false;                    ///< the line was not free when that record was due
  std::uint64_t outputs_ = 0;            ///< records made, for the seeds of the faults

  FastrakHearing hearing_;
  FastrakSending sending_;
};

}  // namespace headpin::devices
