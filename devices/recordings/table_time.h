#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/any_table.h"

namespace headpin::devices {

/// Times of a table's rows.
struct TableTimes {
  std::vector<std::optional<double>> of_row;  ///< in their unit; none for a cell that is no time
  double unit_s = 1.0;
};

/// The unit of a column: from brackets, a row of units, or the last word of its name; in small letters.
std::string unit_of(const FoundColumn& column);

/// The decimals of a second that whole numbers behind a third colon count, as many as the longest has: 3
/// (milliseconds), 6 or 9. 0 for others, which may count frames: they end long before a second is full.
std::size_t colon_decimals(const std::vector<std::string_view>& times);

/// One time in seconds: a number of units, or a date of ISO 8601.
///
/// @param colon_decimals  of a whole number behind a third colon, where other times say how many it has
std::optional<double> time_of(std::string_view cell, double unit_s);
std::optional<double> time_of(std::string_view cell, double unit_s, std::size_t colon_decimals);

/// Whether a text that says a time is a time of day without its date.
bool is_time_of_day(std::string_view time);

/// A time of day in seconds, on the day on which it is nearest to another time.
double on_nearest_day(double time_s, double other_s);

/// The column of the time, by its name; of several, the first one that advances as a time does. The time
/// since the row before does not.
std::optional<std::size_t> find_time(const AnyTable& table);

/// The other columns that are a time by their names and advance as one; the best name first. Numbers of frames
/// are none.
std::vector<std::size_t> other_times(const AnyTable& table, std::size_t column);

/// Reads the column of the time: numbers, or dates of ISO 8601, or times of day. Whole milliseconds may stand
/// behind a third colon: "12:00:01:7".
///
/// The unit is the told one, or the header's, or else the one of s, ms, us, ns and 100 ns in which rows
/// are 2.5 to 50 ms apart, with a note. Frames are counted at the rate that the table says.
///
/// @throws std::invalid_argument  when no unit fits, or no cell is a time
TableTimes read_times(const AnyTable& table, std::size_t column, std::optional<double> told_unit_s,
                      std::string_view where, std::vector<std::string>& notes);

}  // namespace headpin::devices
