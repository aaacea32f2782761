#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace headpin::devices {

/// Whether a row has a wrong time: it is more than half a second from those above and below it, between which one
/// row is missing. A row that is late is missing elsewhere.
bool is_stray(std::span<const double> times_s, std::size_t row);

/// The first row, in the order of the file, of a second recording: it is more than half a second before those
/// above it, and five or more rows from it on lie where rows above already follow each other without a gap.
///
/// Below 10 Hz, the rows above it have at least twenty times, or at least six with even steps and twenty in order below
/// them: fewer may be rows in disorder.
///
/// Rows in another order are none: sorted by text, blocks that changed places, rows that are late or have a
/// wrong time.
std::optional<std::size_t> starts_again(std::span<const double> times_s);

}  // namespace headpin::devices
