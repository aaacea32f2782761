// Any text table with a time and poses: its cells by any_table.h, their meaning by table_columns.h.

#include "devices/recordings/table_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "devices/recordings/any_table.h"
#include "devices/recordings/catalogue_csv.h"
#include "devices/recordings/table_columns.h"
#include "devices/recordings/table_order.h"
#include "devices/recordings/table_rotation.h"
#include "devices/recordings/table_time.h"
#include "devices/recordings/table_trigger.h"
#include "devices/recordings/table_units.h"

namespace headpin::devices {
namespace {

bool is_catalogue(const AnyTable& table) {
  const auto has = [&](std::string_view name) {
    return std::ranges::find(table.columns, name, &FoundColumn::name) != table.columns.end();
  };
  return has("delta_time_ms") && has("head_pos_x");
}

/// Whether the angles of a part are in degrees, as a unit in the table says it; none without a unit.
std::optional<bool> said_degrees(const AnyTable& table, const PartColumns& part) {
  for (const auto& column : part.angles) {
    if (!column) continue;
    const std::string unit = unit_of(table.columns[*column]);
    if (unit == "deg" || unit == "degrees") return true;
    if (unit == "rad" || unit == "radians") return false;
  }
  return std::nullopt;
}

/// Whether the angles without a unit are in degrees: one of any part is above a full turn in radians.
/// The angles of one part say too little, as a hand may rest.
bool angles_look_like_degrees(const AnyTable& table, const MotionColumns& columns) {
  for (const PartColumns& part : columns.parts) {
    if (!part.tracked() || said_degrees(table, part)) continue;
    for (const auto& column : part.angles) {
      if (!column) continue;
      const auto is_large = [&](const AnyTable::Row& row) {
        return std::abs(table.number(row.cells[*column]).value_or(0.0)) > 2.0 * std::numbers::pi;
      };
      if (std::ranges::any_of(table.rows, is_large)) return true;
    }
  }
  return false;
}

/// Reads the rows of a table into tracks.
class TableMotion {
 public:
  TableMotion(const AnyTable& table, const MotionOptions& options, std::string_view where)
      : table_(table), options_(options), where_(where), columns_(columns_with(told_columns())) {
    tracks_.notes = table.notes;
    choose_time();
    if (options.rotations == "none") {
      for (PartColumns& part : columns_.parts) part.rotation = RotationKind::none;
    }
    const bool vectors = options.rotations ? *options.rotations == "vector" : table.kind == "Vicon";
    for (PartColumns& part : columns_.parts) {
      if (vectors && part.rotation == RotationKind::angles) part.rotation = RotationKind::vector;
    }
    if (vectors) say_meanings(table, columns_);
  }

  MotionTracks read() {
    require_columns();
    require_told_parts();
    require_told_angles();
    for (const std::string& missing : columns_.missing) tracks_.notes.push_back(missing);
    find_reading();
    look_like_degrees_ = angles_look_like_degrees(table_, columns_);
    note(table_.rows.size() - rows_.size(), "rows have no time: ignored");
    leave_out_strays();
    require_one_recording();
    order_rows();
    for (std::size_t part = 0; part < 3; ++part) {
      if (columns_.parts[part].tracked()) read_part(part);
    }
    tracks_.by_part = true;
    return std::move(tracks_);
  }

  const MotionColumns& columns() const { return columns_; }

 private:
  MotionColumns columns_with(const ToldColumns& told) const {
    return find_columns(table_, told, options_.only_hand_is_left, where_,
                        options_.rotations != "none");
  }

  /// Names of objects are columns of that beginning.
  ToldColumns told_columns() const {
    ToldColumns told = options_.columns;
    for (std::size_t part = 0; part < 3; ++part) {
      const std::string& name = options_.names[part];
      if (!name.empty()) told.push_back({kPartKeys[part], name + "*", options_.names_source});
    }
    return told;
  }

  /// Where the time starts again, as it does in each trial, another column that goes on is the time.
  void choose_time() {
    const bool told =
        options_.reading.time_unit_s ||
        std::ranges::find(options_.columns, "time", &ToldColumn::key) != options_.columns.end();
    if (told || !columns_.time) return;
    const std::size_t first = *columns_.time;
    const std::vector<std::size_t> others = other_times(table_, first);
    const TimedRows usual = others.empty() ? TimedRows{} : rows_timed_by(first);
    if (!restart_in(usual)) return;
    for (const std::size_t other : others) {
      const TimedRows rows = rows_timed_by(other);
      if (rows.size() < usual.size() || restart_in(rows)) continue;
      ToldColumns also = told_columns();
      also.push_back({"time", fmt::format("#{}", other + 1)});
      columns_ = columns_with(also);
      tracks_.notes.push_back(fmt::format("the time '{}' starts again: '{}' is read instead",
                                          table_.columns[first].name, table_.columns[other].name));
      return;
    }
  }

  /// The rows by the times of a column; none if its unit is not known.
  TimedRows rows_timed_by(std::size_t column) const {
    std::vector<std::string> notes;
    try {
      const TableTimes times = read_times(table_, column, {}, where_, notes);
      return timed_rows(times, times.unit_s);
    } catch (const std::invalid_argument&) {
      return {};
    }
  }

  void require_columns() const {
    const bool hand = columns_.parts[1].tracked() || columns_.parts[2].tracked();
    const bool head = columns_.parts[0].tracked() || options_.p_head.has_value();
    if (columns_.time && head && (hand || options_.no_hand)) return;
    // A head that was told need not be found.
    const bool told = columns_.time && options_.p_head && !columns_.parts[0].tracked();
    throw UnclearColumns(
        fmt::format("{}: {}; {}", where_, columns_.missing[told ? 1 : 0], names_in(table_)));
  }

  /// A told component of a head or hand that was not found would be ignored. Of a table with a row for each
  /// object, one may be told of an object that only other recordings have.
  void require_told_parts() {
    for (const ToldColumn& told : options_.columns) {
      const std::size_t dot = told.key.find('.');
      if (dot == std::string::npos) continue;
      const std::string key = told.key.substr(0, dot);
      const auto part =
          static_cast<std::size_t>(std::ranges::find(kPartKeys, key) - kPartKeys.begin());
      if (columns_.parts[part].tracked()) continue;
      if (columns_.object) {
        tell_once(tracks_.notes, fmt::format("no rows are of a {}: what was told of its columns is "
                                             "not used",
                                             kPartNames[part]));
        continue;
      }
      throw WrongColumn(
          told,
          fmt::format("{} = '{}' is of a {} that was not found", told.key, told.column,
                      kPartNames[part]),
          fmt::format("expected {0} = 'NAME*' or all of {0}.x, {0}.y and {0}.z as well", key));
    }
  }

  /// An order or unit of angles that no column has is a mistake.
  void require_told_angles() const {
    const bool order = options_.rotations && *options_.rotations != "none";
    if (options_.rotations == "none" || (!order && !options_.degrees)) return;
    const auto has_angles = [](const PartColumns& part) {
      return part.tracked() &&
             (part.rotation == RotationKind::angles || part.rotation == RotationKind::vector);
    };
    if (std::ranges::any_of(columns_.parts, has_angles)) return;
    throw std::invalid_argument(
        fmt::format("{}: expected angles to read as {}; found other rotations, or none", where_,
                    order               ? *options_.rotations
                    : *options_.degrees ? "deg"
                                        : "rad"));
  }

  void find_reading() {
    Reading& reading = tracks_.reading;
    units_m_ = position_units(table_, columns_, is_catalogue(table_) ? 0.01 : 1.0, reading);
    if (const auto told = options_.reading.unit_m) units_m_.fill(Vec3::Constant(*told));
    if (table_.kind == "Vicon") reading.axes = reading.turning = "RAS";  // z up
    for (const PartColumns& part : columns_.parts) {
      if (!part.tracked() || part.rotation != RotationKind::quaternion) continue;
      const std::string order = order_of(part);
      if (reading.quaternion.empty()) reading.quaternion = order;
      reading.own_orders = reading.own_orders || order != reading.quaternion;
    }
    std::vector<std::string>& notes = tracks_.notes;
    const TableTimes times =
        read_times(table_, *columns_.time, options_.reading.time_unit_s, where_, notes);
    reading_ = with(options_.reading, reading, where_);
    reading_.time_unit_s = times.unit_s;  // a told unit is one of numbers, not of dates
    rows_ = timed_rows(times, reading_.time_unit_s);
    tracks_.reading = reading_;
  }

  /// The rows that have a time, in the order of the file.
  TimedRows timed_rows(const TableTimes& times, double unit_s) const {
    TimedRows rows;
    for (std::size_t i = 0; i < table_.rows.size(); ++i) {
      const double time_s = times.of_row[i].value_or(NAN) * unit_s;
      if (std::abs(time_s) < 1e11) rows.emplace_back(microseconds(time_s), &table_.rows[i]);
    }
    return rows;
  }

  /// Where a second recording begins in a file; samples of both would be mixed.
  struct Restart {
    std::size_t line;
    Time time, before;
  };

  std::optional<Restart> restart_in(const TimedRows& all) const {
    for (std::size_t part = 0; part < 3; ++part) {
      if (!columns_.parts[part].tracked()) continue;
      TimedRows rows = rows_of(part, all);
      std::erase_if(rows,
                    [&](const auto& row) { return !place(*row.second, columns_.parts[part]); });
      if (!starts_again(times_of(rows))) continue;
      drop_repeated(rows);
      if (const auto again = starts_again(times_of(rows)))
        return Restart{rows[*again].second->line, rows[*again].first, rows[*again - 1].first};
    }
    return std::nullopt;
  }

  static std::vector<double> times_of(const TimedRows& rows) {
    std::vector<double> times_s;
    for (const auto& row : rows) times_s.push_back(seconds(row.first));
    return times_s;
  }

  /// Rows that a program wrote once more, cell by cell, are no second recording.
  static void drop_repeated(TimedRows& rows) {
    const auto by_cells = [](const AnyTable::Row* a, const AnyTable::Row* b) {
      return a->cells < b->cells;
    };
    std::set<const AnyTable::Row*, decltype(by_cells)> seen(by_cells);
    std::erase_if(rows, [&](const auto& row) { return !seen.insert(row.second).second; });
  }

  void require_one_recording() const {
    const std::optional<Restart> restart = restart_in(rows_);
    if (!restart) return;
    std::string others;
    for (const std::size_t other : other_times(table_, *columns_.time))
      others += (others.empty() ? "" : ", ") + table_.columns[other].name;
    if (!others.empty()) others = fmt::format("; other columns of a time: {}", others);
    throw std::invalid_argument(fmt::format(
        "{}:{}: the time starts again, at {:.3f} s after {:.3f} s (two recordings in one file, or "
        "a clock that was set back): expected one recording, or its rows in order of time{}",
        where_, restart->line, seconds(restart->time), seconds(restart->before), others));
  }

  void leave_out_strays() {
    const std::vector<double> times_s = times_of(rows_);
    TimedRows kept;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!is_stray(times_s, i)) kept.push_back(rows_[i]);
    }
    note(rows_.size() - kept.size(), "rows have a time far from those around them: ignored");
    rows_ = std::move(kept);
  }

  /// Rows in order of time.
  void order_rows() {
    std::size_t unordered = 0, furthest = 0;
    Time by{};
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      const Time back = rows_[i - 1].first - rows_[i].first;
      if (back > Time{}) ++unordered;
      if (back > by) by = back, furthest = rows_[i].second->line;
    }
    std::ranges::stable_sort(rows_, {}, [](const auto& row) { return row.first; });
    note(unordered, fmt::format("rows are earlier than the row before (the furthest by {:.3f} s, "
                                "at line {}): put in order",
                                seconds(by), furthest));
    // A catalogue's file that begins later was cut out of a longer one.
    constexpr Time kAtStart{1'000'000};
    tracks_.since_start = is_catalogue(table_) && !rows_.empty() && rows_.front().first < kAtStart;
  }

  void note(std::size_t count, std::string_view what) {
    if (count > 0) tracks_.notes.push_back(fmt::format("{} {}", count, what));
  }

  /// The rows of the stream that a column is of.
  static TimedRows rows_with(std::size_t column, const TimedRows& all) {
    TimedRows rows;
    for (const auto& row : all) {
      if (!row.second->cells[column].empty()) rows.push_back(row);
    }
    return rows;
  }

  /// The rows that have a part in them.
  TimedRows rows_of(std::size_t part, const TimedRows& all) const {
    if (table_.of_streams) return rows_with(*columns_.parts[part].position[0], all);
    if (!columns_.object) return all;
    TimedRows rows;
    for (const auto& row : all) {
      if (row.second->cells[*columns_.object] == columns_.objects[part]) rows.push_back(row);
    }
    return rows;
  }

  void read_part(std::size_t part) {
    const PartColumns& its = columns_.parts[part];
    const TimedRows rows = rows_of(part, rows_);
    const std::string order = angle_order();
    const bool degrees =
        options_.degrees.value_or(said_degrees(table_, its).value_or(look_like_degrees_));
    const RotationReader rotation_of(table_, its, degrees, order);
    const Axes axes(reading_.axes, where_), turning(reading_.turning, where_);
    PoseTrack track;
    const std::string quaternion = its.rotation != RotationKind::quaternion
                                       ? ""
                                       : options_.reading.quaternion.value_or(order_of(its));
    std::size_t lost = 0, first_lost = 0, again = 0;
    for (const auto& [time, row] : rows) {
      const auto p = place(*row, its);
      const std::optional<Quat> q = rotation_of(*row, quaternion);
      if (!p || !q) {
        if (lost++ == 0) first_lost = row->line;
        continue;
      }
      const Quat turned = reading_.inverted ? q->conjugate() : *q;
      again += !track.push(
          time, {turning.ours(turned), axes.ours(Vec3(units_m_[part].cwiseProduct(*p)))});
    }
    if (2 * lost > rows.size()) refuse_part(part, lost, rows.size(), first_lost);
    note(again,
         fmt::format("samples of the {} have the time of another one: ignored", kPartNames[part]));
    if (50 * again > rows.size()) {
      tracks_.notes.emplace_back("the clock of the rows is coarse: speeds are less accurate");
    }
    note(lost, fmt::format("samples of the {} have blank cells, no numbers or no rotation (the "
                           "first in line {}): ignored",
                           kPartNames[part], first_lost));
    const bool angles =
        its.rotation == RotationKind::angles || its.rotation == RotationKind::vector;
    if (options_.rotations == "none") {
      tracks_.reading.angles = "none";
    } else if (angles) {
      note_angles(its.rotation == RotationKind::vector ? "vector" : order, degrees ? "deg" : "rad");
    }
    if (its.rotation == RotationKind::angles) {
      tell_once(tracks_.notes, fmt::format("rotations are angles: read as {} in {}", order,
                                           degrees ? "degrees" : "radians"));
    }
    if (its.rotation == RotationKind::none) tracks_.without_rotation.emplace_back(kPartNames[part]);
    if (part > 0 && its.trigger) {
      tracks_.triggers[part - 1] =
          presses(table_, *its.trigger, table_.of_streams ? rows_with(*its.trigger, rows_) : rows,
                  tracks_.notes);
    }
    tracks_.tracks.emplace_back(kPartNames[part], std::move(track));
  }

  /// Where units differ from part to part, the columns say them.
  void note_angles(const std::string& order, std::string_view unit) {
    std::string& angles = tracks_.reading.angles;
    const std::string its = fmt::format("{},{}", order, unit);
    angles = angles.empty() || angles == its ? its : order;
  }

  std::optional<Vec3> place(const AnyTable::Row& row, const PartColumns& its) const {
    Vec3 p;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::optional<double> number = table_.number(row.cells[*its.position[i]]);
      if (!number || std::abs(*number) > 1e9) return std::nullopt;
      p[static_cast<Eigen::Index>(i)] = *number;
    }
    return p;
  }

  [[noreturn]] void refuse_part(std::size_t part, std::size_t lost, std::size_t all,
                                std::size_t line) const {
    throw std::invalid_argument(
        fmt::format("{}:{}: {}: expected numbers, and quaternions of length 1 or matrices that are "
                    "rotations; {} of {} rows have none",
                    where_, line, kPartNames[part], lost, all));
  }

  std::string angle_order() const {
    if (options_.rotations && options_.rotations->size() == 3) return *options_.rotations;
    const std::string motive = table_.fact("rotation type");  // "xyz": about axes that turn
    if (motive.size() == 3) {
      std::string order = motive;
      for (char& c : order) c = static_cast<char>(c - 'a' + 'A');
      std::string sorted = order;
      std::ranges::sort(sorted);
      if (sorted == "XYZ") return order;
    }
    return "YXZ";  // Unity's
  }

  const AnyTable& table_;
  const MotionOptions& options_;
  std::string_view where_;
  MotionColumns columns_;
  TimedRows rows_;
  Reading reading_;
  std::array<Vec3, 3> units_m_ = {Vec3::Ones(), Vec3::Ones(),
                                  Vec3::Ones()};  ///< of each part's x, y, z
  bool look_like_degrees_ = false;                ///< angles without a unit
  MotionTracks tracks_;
};

/// Without a last line that has no end: its last number may be cut.
std::string_view whole_lines(std::string_view text, std::vector<std::string>& notes) {
  const std::size_t end = text.find_last_of("\r\n");
  if (end == std::string_view::npos || end + 1 == text.size()) return text;
  notes.emplace_back(
      "the last line has no end, so its last number may be incomplete; the line is ignored");
  return text.substr(0, end + 1);
}

}  // namespace

MotionTracks parse_motion_table(std::string_view text, std::string_view where,
                                const MotionOptions& options) {
  std::vector<std::string> notes;
  const AnyTable table = read_any_table(whole_lines(text, notes), where);
  MotionTracks tracks = tracks_in(table, where, options);
  tracks.notes.insert(tracks.notes.begin(), notes.begin(), notes.end());
  return tracks;
}

MotionTracks tracks_in(const AnyTable& table, std::string_view where,
                       const MotionOptions& options) {
  return TableMotion(table, options, where).read();
}

TableFindings inspect_table(std::string_view text, std::string_view where,
                            const MotionOptions& options) {
  return findings_in(read_any_table(text, where), where, options);
}

TableFindings findings_in(const AnyTable& table, std::string_view where,
                          const MotionOptions& options) {
  const MotionColumns columns = TableMotion(table, options, where).columns();
  TableFindings findings;
  findings.kind = table.kind;
  findings.of_streams = table.of_streams;
  findings.separator = table.separator;
  findings.decimal_comma = table.decimal_comma;
  findings.rows = table.rows.size();
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const auto filled =
        std::ranges::find_if(table.rows, [&](const auto& row) { return !row.cells[c].empty(); });
    const std::string first = filled == table.rows.end() ? "" : std::string(filled->cells[c]);
    findings.columns.push_back(
        {table.columns[c].name, table.columns[c].unit, columns.meanings[c], first});
  }
  findings.mapping = mapping_of(table, columns);
  findings.missing = columns.missing;
  return findings;
}

}  // namespace headpin::devices
