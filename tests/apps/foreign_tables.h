#pragma once

#include <functional>
#include <string>
#include <vector>

#include "devices/recordings/motion_recording.h"

/// Tables as other programs write them, of one recorded throw. Shares no code with the reader.
namespace headpin {

/// How a table is written.
struct ForeignTable {
  std::string name;
  /// Options of `import` that the table needs.
  std::string options = {};
  std::string separator = ",";
  bool decimal_comma = false;
  /// Rows of our x (right), y (up), z (back) that make theirs; of positions and rotations.
  Mat3 R_positions = Mat3::Identity(), R_rotations = Mat3::Identity();
  double unit_m = 1.0;
  std::string line_end = "\n";
  std::string before = {};               ///< lines above the header
  std::vector<std::string> columns;      ///< of a row: see cell()
  std::vector<std::string> header = {};  ///< names in the header; none: no header
  bool quoted = false;
  std::function<std::string(Time)> time = {};  ///< how a time is written
};

/// One cell: "t"; "head.x", "right.qw"; "head.ex" (Unity's angles [degrees]); "head.vx" (a rotation vector
/// [degrees]); "head.m01"; "right.trigger" (0 or 1 between two times); "=TEXT" is the text itself.
std::string foreign_cell(const ForeignTable& table, const devices::MotionRecording& r,
                         std::size_t i, const std::string& what, Time pressed, Time released);

std::string foreign_text(const ForeignTable& table, const devices::MotionRecording& r, Time pressed,
                         Time released);

/// All tables that are tried.
std::vector<ForeignTable> foreign_tables();

}  // namespace headpin
