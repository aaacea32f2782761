#include "devices/fastrak/readings.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/fastrak/codec.h"
#include "devices/fastrak/geometry.h"
#include "devices/fastrak/replies.h"
#include "devices/fastrak/setup.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

/// A receiver as one record shows it.
struct Reading {
  Vec3 p = Vec3::Zero();  ///< p_TS [m]
  Mat3 R = Mat3::Zero();  ///< R_TS, as it came: of a faulty unit it may be no rotation
};

/// Readings of all stations from one command P; empty if the set is not complete.
std::vector<Reading> read_all(FastrakLine& line, int stations, const FastrakFormat& format,
                              FastrakDemands& demands) {
  const std::size_t length = fastrak_record_length(format);
  const auto set = static_cast<std::size_t>(stations) * length;
  const std::string heard = line.ask("P", 1s + time_of(set, line), set);
  std::vector<Reading> readings;
  for (std::size_t at = 0; at + length <= heard.size(); at += length) {
    const std::string_view bytes = std::string_view(heard).substr(at, length);
    const auto record = decode_record(
        Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), format);
    if (!record || record->station != static_cast<int>(readings.size()) + 1) break;
    const Pose X_TS = pose_of(*record, format);
    const bool matrix = attitude_of(format.items) == FastrakAttitude::matrix;
    readings.push_back({X_TS.p, matrix ? record->attitude : X_TS.q.toRotationMatrix()});
  }
  const bool whole = readings.size() == static_cast<std::size_t>(stations);
  demand(line, demands, fmt::format("a set of {} bytes, {} for each station", set, length), whole,
         heard);
  return whole ? readings : std::vector<Reading>();
}

/// The largest distance between the tips of two frames' axes: for small turns their angle [rad].
double turn(const Mat3& a, const Mat3& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// How far a receiver went and turned from one reading to another.
struct Way {
  double far = 0.0;     ///< [m]
  double turned = 0.0;  ///< as turn()
};

Way way(const Reading& from, const Reading& to) {
  return {(to.p - from.p).norm(), turn(from.R, to.R)};
}

/// Whether this motion near `p_TS` could hide what a wrong form does: inches for centimetres put a receiver off
/// by 0.6 of its distance, and wrong axes turn it by a right angle.
bool hides_faults(const Way& motion, const Vec3& p_TS) {
  constexpr double kFar = 0.05, kShare = 0.5;  // m, and of the distance
  constexpr double kTurned = 1.0;              // as turn()
  return motion.far > kFar + kShare * p_TS.norm() || motion.turned > kTurned;
}

/// What differs between a reading and those before and after it by more than noise and this motion;
/// empty if nothing does.
std::string difference(const Reading& before, const Reading& read, const Reading& after,
                       const Way& motion) {
  constexpr double kRounding = 0.002, kShare = 0.02;  // m, and of the distance: noise
  constexpr double kTurn = 0.03, kDeviations = 10.0;  // rad, and of the unit's noise there
  const Vec3 p = 0.5 * (before.p + after.p);
  if ((read.p - p).norm() > kRounding + kShare * p.norm() + motion.far) {
    return fmt::format("{:.3f}, {:.3f}, {:.3f} m, and {:.3f}, {:.3f}, {:.3f} m", read.p.x(),
                       read.p.y(), read.p.z(), p.x(), p.y(), p.z());
  }
  const Mat3 R = Quat(before.R).slerp(0.5, Quat(after.R)).toRotationMatrix();
  const double noise = kDeviations * noise_at(p.norm()).rotation;
  if (turn(read.R, R) <= kTurn + noise + motion.turned) return "";
  const auto axes = [](const Mat3& axes_TS) {
    const auto axis = [&](int i) {
      return fmt::format("({:.3f}, {:.3f}, {:.3f})", axes_TS(0, i), axes_TS(1, i), axes_TS(2, i));
    };
    return fmt::format("{} {} {}", axis(0), axis(1), axis(2));
  };
  return fmt::format("axes {}, and axes {}", axes(read.R), axes(R));
}

/// Readings in one form, and those before and after it in the factory's form.
struct Compared {
  std::string sent;  ///< what the unit was told before
  std::string_view form;
  std::vector<Reading> before, read, after;

  bool whole() const {
    return !read.empty() && before.size() == read.size() && read.size() == after.size();
  }
};

/// The third longest way of a station from one reading in the factory's form to the next one: a
/// single wrong reading ends one way and begins another one, and shows no motion.
Way usual_way(const std::vector<Compared>& all, std::size_t station) {
  constexpr std::size_t kThird = 2;
  std::vector<double> far, turned;
  for (const Compared& one : all) {
    if (!one.whole()) continue;
    const Way gone = way(one.before[station], one.after[station]);
    far.push_back(gone.far);
    turned.push_back(gone.turned);
  }
  if (far.size() <= kThird) return {};
  std::ranges::sort(far, std::greater());
  std::ranges::sort(turned, std::greater());
  return {far[kThird], turned[kThird]};
}

/// Requires that the readings in a form agree with those before and after them.
///
/// Of a receiver that made most of a turn in between, those two may be close together. The other
/// ways show such a receiver, and what its motion may explain is no fault of the unit.
void same_pose(const Compared& one, const std::vector<Compared>& all, FastrakDemands& demands) {
  if (!one.whole()) return;  // already reported
  std::string wrong;
  bool moves = false;
  for (std::size_t i = 0; i < one.read.size() && wrong.empty(); ++i) {
    const auto found = [&](const Way& motion) {
      return difference(one.before[i], one.read[i], one.after[i], motion);
    };
    const Way gone = way(one.before[i], one.after[i]);
    const std::string differs = found(gone);
    if (differs.empty()) {
      moves = moves || hides_faults(gone, 0.5 * (one.before[i].p + one.after[i].p));
      continue;
    }
    const Way usual = usual_way(all, i);
    if (found({2.0 * usual.far, 2.0 * usual.turned}).empty()) {
      moves = true;
    } else {
      wrong = fmt::format("station {}: {} in that form", i + 1, differs);
    }
  }
  demands.push_back({shown_bytes(one.sent),
                     fmt::format("{} the pose that it is in ASCII, inches and angles", one.form),
                     wrong.empty(), wrong, moves && wrong.empty()});
}

/// A form of records beside the factory's: the commands into it and back, '#' for each station.
struct Form {
  std::string_view name, into, back;
  FastrakFormat format;
};

const std::array<Form, 7> kForms = {{
    {"in centimetres", "u", "U", {{2, 4, 1}, false, true}},
    {"in binary", "f", "F", {{2, 4, 1}, true, false}},
    {"as a quaternion", "O#,2,11,1\r", "O#,2,4,1\r", {{2, 11, 1}, false, false}},
    {"as a binary quaternion", "fO#,2,11,1\r", "FO#,2,4,1\r", {{2, 11, 1}, true, false}},
    {"as direction cosines", "O#,2,5,6,7,1\r", "O#,2,4,1\r", {{2, 5, 6, 7, 1}, false, false}},
    {"with extended precision", "O#,52,54,1\r", "O#,2,4,1\r", {{52, 54, 1}, false, false}},
    {"as an extended quaternion", "O#,52,61,1\r", "O#,2,4,1\r", {{52, 61, 1}, false, false}},
}};

}  // namespace

int examine_readings(FastrakLine& line, FastrakDemands& demands) {
  const std::string heard = line.ask("S", 1s, kFastrakStatusLength + 1);
  demand(line, demands, "a status record of 55 bytes", decode_status(heard).has_value(), heard);
  const std::string on = line.ask("l1\r", 1s, 9);
  const auto active = decode_active(on);
  demand(line, demands, "the stations that are on, in 9 bytes", active.has_value(), on);
  if (!active) return 0;
  // Clients count receivers from station 1.
  const auto stations = static_cast<int>(std::ranges::find(*active, false) - active->begin());
  if (stations == 0) return 0;
  const auto set = [&](std::string_view command) {
    const bool each = command.find('#') != std::string_view::npos;
    tell_each(line, demands, each ? stations : 1, command, 50ms);
  };
  set("U");
  std::vector<Reading> before = read_all(line, stations, {}, demands);
  std::vector<Compared> all;
  for (const Form& form : kForms) {
    set(form.into);
    Compared one{line.sent(), form.name, std::move(before), {}, {}};
    one.read = read_all(line, stations, form.format, demands);
    set(form.back);
    one.after = before = read_all(line, stations, {}, demands);
    all.push_back(std::move(one));
  }
  for (const Compared& one : all) same_pose(one, all, demands);
  return stations;
}

}  // namespace headpin::devices
