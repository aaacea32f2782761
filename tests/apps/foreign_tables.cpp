#include "tests/apps/foreign_tables.h"

#include <cmath>
#include <numbers>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

double number_of(const ForeignTable& table, const Pose& pose, const std::string& what) {
  const Vec3 p = table.R_positions * pose.p / table.unit_m;
  const Mat3 R = table.R_rotations * pose.q.toRotationMatrix() * table.R_rotations.transpose();
  const Quat q(R);
  const auto axis = static_cast<Eigen::Index>(what.back() - 'x');
  if (what.size() == 1) return p[axis];
  switch (what[0]) {
    case 'q':
      return what[1] == 'w' ? q.w() : q.vec()[axis];
    case 'i':
      return what[1] == 'w' ? q.w() : -q.vec()[axis];  // inverted
    case 'm':
      return what[2] == '3' ? p[what[1] - '0'] : R(what[1] - '0', what[2] - '0');
    case 'v': {
      const Eigen::AngleAxisd turn(q);
      return kDegrees * turn.angle() * turn.axis()[axis];
    }
    default:
      break;
  }
  const Vec3 angles(std::asin(-R(1, 2)), std::atan2(R(0, 2), R(2, 2)),
                    std::atan2(R(1, 0), R(1, 1)));
  return kDegrees * angles[axis];
}

std::vector<std::string> pose_cells(const std::string& part,
                                    const std::vector<std::string>& cells) {
  std::vector<std::string> all;
  for (const std::string& cell : cells) all.push_back(part + "." + cell);
  return all;
}

std::vector<std::string> joined(std::initializer_list<std::vector<std::string>> lists) {
  std::vector<std::string> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<std::string> named(const std::string& pattern, const std::vector<std::string>& cells) {
  std::vector<std::string> all;
  for (const std::string& cell : cells) all.push_back(fmt::format(fmt::runtime(pattern), cell));
  return all;
}

const std::vector<std::string> kPlace = {"x", "y", "z"};
const std::vector<std::string> kXyzw = {"x", "y", "z", "qx", "qy", "qz", "qw"};
const std::vector<std::string> kWxyz = {"x", "y", "z", "qw", "qx", "qy", "qz"};
const std::vector<std::string> kUnity = {"x", "y", "z", "ex", "ey", "ez"};
const std::vector<std::string> kHelical = {"vx", "vy", "vz", "x", "y", "z"};

std::vector<std::string> both(const std::vector<std::string>& cells) {
  return joined({{"t"}, pose_cells("head", cells), pose_cells("right", cells)});
}

std::string seconds_text(Time t) {
  return fmt::format("{:.6f}", 1e-6 * static_cast<double>(t.count()));
}

Mat3 rows(const Vec3& x, const Vec3& y, const Vec3& z) {
  Mat3 R;
  R << x.transpose(), y.transpose(), z.transpose();
  return R;
}

const Vec3 kRight = Vec3::UnitX(), kUp = Vec3::UnitY(), kAhead = -Vec3::UnitZ();

ForeignTable plain(const std::string& name, const std::vector<std::string>& cells,
                   const std::string& head = "HMD_{}", const std::string& hand = "ctrl_right_{}") {
  ForeignTable table;
  table.name = name;
  table.columns = both(cells);
  table.header = joined({{"t"}, named(head, cells), named(hand, cells)});
  table.time = seconds_text;
  return table;
}

/// OptiTrack Motive's: five lines above the names.
ForeignTable motive() {
  ForeignTable table = plain("motive", kXyzw);
  table.unit_m = 0.001;
  const std::vector<std::string> rotation_first = {"qx", "qy", "qz", "qw", "x", "y", "z"};
  table.columns = joined({{"=7", "t"},
                          pose_cells("head", rotation_first),
                          {"=0.0004"},
                          pose_cells("right", rotation_first),
                          {"="},
                          pose_cells("head", kPlace)});
  table.before =
      "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,72.000000,Rotation "
      "Type,Quaternion,Length Units,"
      "Millimeters,Coordinate Space,Global\n\n"
      ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
      "Body,"
      "Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,"
      "Rigid Body Marker,Rigid Body Marker,Rigid Body Marker\n"
      ",Name,Helmet,Helmet,Helmet,Helmet,Helmet,Helmet,Helmet,Helmet,RightHand,RightHand,RightHand,"
      "RightHand,RightHand,"
      "RightHand,RightHand,RightHand,Helmet:Marker1,Helmet:Marker1,Helmet:Marker1\n"
      ",ID,\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"2\",\"2\",\"2\",\"2\",\"2\",\"2\","
      "\"2\",\"2\",\"3\",\"3\",\"3\"\n"
      ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Error Per "
      "Marker,Rotation,Rotation,Rotation,"
      "Rotation,Position,Position,Position,Error Per Marker,Position,Position,Position\n";
  table.header = {"Frame", "Time (Seconds)",
                  "X",     "Y",
                  "Z",     "W",
                  "X",     "Y",
                  "Z",     "",
                  "X",     "Y",
                  "Z",     "W",
                  "X",     "Y",
                  "Z",     "",
                  "X",     "Y",
                  "Z"};
  return table;
}

/// Vicon Tracker's: the rate and the objects above the names, rotation vectors, z up.
ForeignTable vicon() {
  ForeignTable table = plain("vicon", kHelical);
  table.unit_m = 0.001;
  table.R_positions = table.R_rotations = rows(kRight, kAhead, kUp);
  table.columns =
      joined({{"frame", "=0"}, pose_cells("head", kHelical), pose_cells("right", kHelical)});
  table.before = "Objects\n72\n,,Head:Head,,,,,,Right:Right,,,,,\n";
  table.header = {"Frame", "Sub Frame",
                  "RX",    "RY",
                  "RZ",    "TX",
                  "TY",    "TZ",
                  "RX",    "RY",
                  "RZ",    "TX",
                  "TY",    "TZ\n,,deg,deg,deg,mm,mm,mm,deg,deg,deg,mm,mm,mm"};
  return table;
}

/// OpenVR's 3x4 matrices.
ForeignTable steamvr() {
  std::vector<std::string> matrix;
  for (const char row : {'0', '1', '2'}) {
    for (const char column : {'0', '1', '2', '3'}) matrix.push_back({'m', row, column});
  }
  return plain("steamvr_matrices", matrix, "hmd_{}", "controller_right_{}");
}

ForeignTable changed(ForeignTable table, const std::string& name,
                     const std::function<void(ForeignTable&)>& change) {
  table.name = name;
  change(table);
  return table;
}

/// Cells, lines and times as other programs write them.
std::vector<ForeignTable> written_otherwise() {
  const ForeignTable base = plain("plain", kXyzw);
  const auto epoch = [](Time t) {
    return fmt::format("{}", 1'790'000'000'000'000'000 + 1000 * t.count());
  };
  const auto iso = [](Time t) {
    return fmt::format("2026-11-25T09:59:{:09.6f}Z", 52.0 + 1e-6 * static_cast<double>(t.count()));
  };
  return {
      base,
      plain("w_first", kWxyz),
      changed(base, "semicolons_and_decimal_commas",
              [](ForeignTable& t) {
                t.separator = ";", t.decimal_comma = true;
                t.time = [](Time time) {
                  std::string s = seconds_text(time);
                  s[s.find('.')] = ',';
                  return s;
                };
              }),
      changed(base, "tabs_mark_and_line_ends",
              [](ForeignTable& t) {
                t.separator = "\t", t.before = "\xef\xbb\xbf", t.line_end = "\r\n";
              }),
      changed(base, "quoted", [](ForeignTable& t) { t.quoted = true; }),
      changed(base, "numpy",
              [](ForeignTable& t) {
                t.separator = " ", t.before = "# by a script\n# ", t.time = [](Time time) {
                  return fmt::format("{:.18e}", 1e-6 * static_cast<double>(time.count()));
                };
              }),
      changed(base, "milliseconds",
              [](ForeignTable& t) {
                t.header[0] = "time_ms", t.time = [](Time time) {
                  return fmt::format("{:.3f}", 1e-3 * static_cast<double>(time.count()));
                };
              }),
      changed(base, "nanoseconds_since_1970",
              [&](ForeignTable& t) { t.header[0] = "timestamp", t.time = epoch; }),
      changed(base, "dates", [&](ForeignTable& t) { t.header[0] = "timestamp", t.time = iso; }),
      changed(base, "frames",
              [](ForeignTable& t) {
                t.header[0] = "frame", t.columns[0] = "frame", t.options = "--time-unit 72Hz";
              }),
  };
}

/// Other units, axes and rotations.
std::vector<ForeignTable> measured_otherwise() {
  const ForeignTable base = plain("plain", kXyzw);
  const Mat3 unity = rows(kRight, kUp, kAhead), z_up = rows(kAhead, -kRight, kUp);
  return {
      changed(base, "millimetres_in_brackets",
              [](ForeignTable& t) {
                t.unit_m = 0.001;
                for (const std::size_t i : {1u, 2u, 3u, 8u, 9u, 10u}) t.header[i] += " [mm]";
              }),
      changed(base, "centimetres_unsaid",
              [](ForeignTable& t) { t.unit_m = 0.01, t.options = "--units cm"; }),
      changed(base, "feet", [](ForeignTable& t) { t.unit_m = 0.3048, t.options = "--units ft"; }),
      changed(plain("", kUnity, "Head{}", "RightHand{}"), "unity",
              [&](ForeignTable& t) {
                t.R_positions = t.R_rotations = unity, t.options = "--axes RSA";
                t.header = {"t",
                            "HeadPosX",
                            "HeadPosY",
                            "HeadPosZ",
                            "HeadRotX",
                            "HeadRotY",
                            "HeadRotZ",
                            "RightHandPosX",
                            "RightHandPosY",
                            "RightHandPosZ",
                            "RightHandRotX",
                            "RightHandRotY",
                            "RightHandRotZ"};
              }),
      changed(base, "unity_quaternions",
              [&](ForeignTable& t) {
                t.R_positions = t.R_rotations = unity, t.options = "--axes RSA";
              }),
      changed(
          base, "ros_z_up",
          [&](ForeignTable& t) { t.R_positions = t.R_rotations = z_up, t.options = "--axes ALS"; }),
      changed(base, "positions_alone_mirrored",
              [&](ForeignTable& t) { t.R_positions = unity, t.options = "--axes RSA,RSP"; }),
      changed(base, "wrongly_named_quaternion",
              [](ForeignTable& t) {
                t.columns = both(kWxyz),
                t.options = "--rotations wxyz";  // the names say x, y, z, w
              }),
      changed(base, "inverted_rotations",
              [](ForeignTable& t) {
                t.columns = both({"x", "y", "z", "ix", "iy", "iz", "iw"}),
                t.options = "--rotations inverse";
              }),
      changed(base, "two_orders_of_quaternions",
              [](ForeignTable& t) {
                t.columns = joined({{"t"}, pose_cells("head", kXyzw), pose_cells("right", kWxyz)});
                t.header = joined({{"t"}, named("HMD_{}", kXyzw), named("ctrl_right_{}", kWxyz)});
              }),
  };
}

/// Other columns and headers.
std::vector<ForeignTable> arranged_otherwise() {
  const ForeignTable base = plain("plain", kXyzw);
  return {
      changed(base, "openxr",
              [](ForeignTable& t) {
                t.header = {"time"};
                for (const std::string part : {"view", "/user/hand/right/input/grip/pose"}) {
                  for (const char* cell :
                       {"position.x", "position.y", "position.z", "orientation.x", "orientation.y",
                        "orientation.z", "orientation.w"}) {
                    t.header.push_back(part + "." + cell);
                  }
                }
              }),
      changed(base, "names_that_say_nothing",
              [](ForeignTable& t) {
                t.header = joined({{"t"}, named("A_{}", kXyzw), named("B_{}", kXyzw)});
                t.options = "--columns 'head=A_*, right=B_*'";
              }),
      changed(base, "no_header",
              [](ForeignTable& t) {
                t.header.clear();
                t.options =
                    "--columns "
                    "'time=#1,head.x=#2,head.y=#3,head.z=#4,head.qx=#5,head.qy=#6,head.qz=#7,head."
                    "qw=#8,"
                    "right.x=#9,right.y=#10,right.z=#11,right.qx=#12,right.qy=#13,right.qz=#14,"
                    "right.qw=#15'";
              }),
      changed(base, "a_trigger",
              [](ForeignTable& t) {
                t.columns.push_back("right.trigger"), t.header.push_back("ctrl_right_trigger");
              }),
      changed(base, "a_row_for_each_object",
              [](ForeignTable& t) {
                t.header = joined({{"time", "device"}, kXyzw});
              }),
      motive(),
      vicon(),
      steamvr(),
  };
}

}  // namespace

std::string foreign_cell(const ForeignTable& table, const devices::MotionRecording& r,
                         std::size_t i, const std::string& what, Time pressed, Time released) {
  if (what.starts_with('=')) return what.substr(1);
  if (what == "t") return table.time(r.times[i]);
  if (what == "frame") return std::to_string(i + 1);
  if (what == "right.trigger") return r.times[i] >= pressed && r.times[i] < released ? "1" : "0";
  const bool head = what.starts_with("head.");
  const Pose& pose = head ? r.head[i] : r.right_hand[i];
  std::string text = fmt::format("{:.9f}", number_of(table, pose, what.substr(what.find('.') + 1)));
  if (table.decimal_comma) text[text.find('.')] = ',';
  return text;
}

std::string foreign_text(const ForeignTable& table, const devices::MotionRecording& r, Time pressed,
                         Time released) {
  std::string text = table.before;
  const auto line = [&](const std::vector<std::string>& cells) {
    text += fmt::format("{}{}", fmt::join(cells, table.separator), table.line_end);
  };
  std::vector<std::string> header = table.header;
  for (std::string& name : header) {
    if (table.quoted) name = '"' + name + '"';
  }
  if (!header.empty()) line(header);
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    if (table.name == "a_row_for_each_object") {
      for (const std::string part : {"head", "right"}) {
        std::vector<std::string> cells = {table.time(r.times[i]),
                                          part == "head" ? "HMD" : "Controller (right)"};
        for (const std::string& what : kXyzw)
          cells.push_back(foreign_cell(table, r, i, part + "." + what, pressed, released));
        line(cells);
      }
      continue;
    }
    std::vector<std::string> cells;
    for (const std::string& what : table.columns)
      cells.push_back(foreign_cell(table, r, i, what, pressed, released));
    line(cells);
  }
  return text;
}

std::vector<ForeignTable> foreign_tables() {
  std::vector<ForeignTable> all = written_otherwise();
  for (const auto& more : {measured_otherwise(), arranged_otherwise()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace headpin
