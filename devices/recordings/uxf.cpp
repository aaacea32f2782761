#include "devices/recordings/uxf.h"

#include <array>
#include <numbers>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/text_table.h"

namespace headpin::devices {

PoseTrack parse_uxf(std::string_view text, std::string_view where, std::vector<std::string>& notes,
                    bool turns) {
  constexpr std::array kColumns = {"time", "pos_x", "pos_y", "pos_z", "rot_x", "rot_y", "rot_z"};
  const std::size_t whole = text.rfind('\n') + 1;  // 0 without one
  if (whole > 0 && whole < text.size()) {
    text = text.substr(0, whole);
    notes.push_back(fmt::format(
        "{}: the last line has no end, so its last number may be incomplete; the line is ignored",
        where));
  }
  TextTable table(text, where, ',');
  table.read_names();
  std::array<std::size_t, kColumns.size()> at{};
  const std::size_t needed = turns ? kColumns.size() : 4;
  for (std::size_t i = 0; i < needed; ++i) {
    at[i] = table.column(kColumns[i]);
    if (at[i] == table.names().size()) {
      table.fail(fmt::format("expected the columns {} of a UXF tracker, {} is missing",
                             fmt::join(std::span(kColumns).first(needed), ", "), kColumns[i]));
    }
  }
  const auto turn = [](const Vec3& axis, double degrees) {
    return rotation(std::numbers::pi / 180.0 * degrees * axis);
  };
  PoseTrack track;
  std::size_t again = 0;
  while (table.next()) {
    const auto value = [&](std::size_t i) { return table.number(at[i]); };
    const double time = value(0);
    table.require_time("time", time);
    for (std::size_t i = 4; i < needed; ++i) {
      if (std::abs(value(i)) > 1e6) table.fail(fmt::format("{}: expected degrees", kColumns[i]));
    }
    // The reversal of z reverses rotations about x and y.
    const Quat q = !turns ? Quat::Identity()
                          : Quat(turn(Vec3::UnitY(), -value(5)) * turn(Vec3::UnitX(), -value(4)) *
                                 turn(Vec3::UnitZ(), value(6)));
    if (track.push(microseconds(time), {q.normalized(), Vec3(value(1), value(2), -value(3))})) {
      continue;
    }
    if (microseconds(time) < track.samples().back().time) {
      table.fail(fmt::format("time: time must advance, found {:.6g} s after {:.6g} s", time,
                             seconds(track.samples().back().time)));
    }
    ++again;
  }
  if (again > 0) {
    notes.push_back(
        fmt::format("{}: {} samples are at the time of the one before: left out", where, again));
  }
  return track;
}

}  // namespace headpin::devices
