#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/fastrak/codec.h"
#include "devices/fastrak/geometry.h"
#include "devices/fastrak/replies.h"

/// The settings of a Fastrak, and the line commands that set and read them, independent of time and
/// line.
namespace headpin::devices {

/// Settings of a station, with factory values.
struct FastrakStationSetup {
  bool on = true;
  std::vector<int> items = {2, 4, 1};
  std::array<Vec3, 3> p_TA = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)};  ///< alignment [m]
  std::optional<Quat> q_boresight;    ///< orientation at the command B
  Vec3 boresight_deg = Vec3::Zero();  ///< angles it reads as
  Vec3 zenith = Vec3::UnitX();        ///< 0,0,0: follows the receiver
  double increment = 0.0;             ///< [m]
  Vec3 p_SN = Vec3::Zero();           ///< tip offset [m]
  Vec3 mounting_deg = Vec3::Zero();   ///< of the transmitter
  std::array<Vec3, 2> position_envelope = {Vec3(2, 2, 2), Vec3(-2, -2, -2)};  ///< [m]
  std::array<Vec3, 2> angle_envelope_deg = {Vec3(180, 90, 180), Vec3(-180, -90, -180)};
};

/// Settings of the unit, with factory values.
struct FastrakSetup {
  std::array<FastrakStationSetup, kFastrakStations> stations;
  bool binary = false;
  bool centimetres = false;
  bool compensation = false;
  bool continuous = false;
  bool point_mode = true;  ///< stylus switch acts like the command P (command e)
  int sync = 0;
  FastrakFilter position_filter, attitude_filter;
  std::string identification = "OutputCompensat CPG2030-003-10";
};

/// Settings of its port.
struct FastrakPort {
  int baud = 115200;
  int bits = 8;
  bool parity = false;
};

/// Everything that line commands read and write.
struct FastrakMemory {
  FastrakSetup setup;
  FastrakPort port;
  int error = 0;                              ///< last built-in-test number
  bool early_firmware = false;                ///< has the compact output items 18 to 20
  std::optional<std::vector<Vec3>> guided;    ///< points of a guided alignment so far, from A0 on
  std::function<bool(std::size_t)> plugged;   ///< whether a station (0 to 3) has a receiver now
  std::function<Quat(std::size_t)> attitude;  ///< its newest orientation, without boresight
};

/// The place and the reason of an error in a line.
struct FastrakRefused {
  FastrakRefusal why;
  std::size_t field;     ///< from 0 after the letter
  std::size_t position;  ///< of that field in the line
  int station;           ///< 1 to 4
};

/// Whether a command with this letter ends with its line.
bool is_fastrak_line_command(char letter);

/// Makes the setting of an immediate command: F, f, U, u, D or d.
/// @return  false for another letter
bool switch_setting(char letter, FastrakSetup& setup);

/// Executes a line, which has no line end.
///
/// @param line  begins with the letter of a line command
/// @return  the answer, if it has one
/// @throws FastrakRefused  if the unit would refuse it; nothing is changed then
std::string carry_out(std::string_view line, FastrakMemory& memory);

/// Puts a station's alignment frame through three points of its present one.
/// @return  false when they are in a line
bool align(FastrakStationSetup& station, const std::array<Vec3, 3>& points);

/// The answer of the command A for a station.
std::string alignment_answer(const FastrakMemory& memory, std::size_t station);

}  // namespace headpin::devices
