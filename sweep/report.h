#pragma once

#include <cstdint>
#include <string>

#include "sweep/averages.h"

namespace headpin::sweep {

/// Most points that a page has: it is 120 MB long then, which browsers just open.
inline constexpr std::int64_t kMostPoints = 100'000;

/// The page of a sweep: why rows failed, and for each result a map over two axes of the grid, slices of it, and a
/// table; for each combination of the other axes.
///
/// @param x, y    axes of the grid
/// @param folder  of the sweep, for the command of a point
std::string html_report(const Rows& rows, const Averages& averages, std::size_t x, std::size_t y,
                        const std::string& folder);

/// `headpin replay` of a row.
std::string command_of(const Rows& rows, const Row& row, const std::string& folder);

}  // namespace headpin::sweep
