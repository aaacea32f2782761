#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/stage/condition.h"
#include "sweep/design.h"

namespace headpin::sweep {

/// One replay: a trial and the condition that it is simulated under.
struct Row {
  std::int64_t number = 0;          ///< from 0
  std::size_t trial = 0;            ///< of the design
  std::vector<std::string> values;  ///< of Rows::keys(), in that order
  std::string key;  ///< 16 hex digits, a hash of the inputs: the trial's bytes, keys and values
};

/// The rows of a design, each computed on request.
class Rows {
 public:
  /// @param hashes  SHA-256 of each trial's file
  Rows(const Design& design, std::vector<std::string> hashes);

  std::int64_t size() const { return size_; }
  /// Rows of one condition and all its trials follow each other.
  /// @param number  from 0 to size() - 1
  Row at(std::int64_t number) const;

  /// Keys that the design sets: those of the grid, then those that are drawn.
  const std::vector<std::string>& keys() const { return keys_; }
  const Design& design() const { return design_; }

 private:
  std::string drawn(std::size_t range, std::int64_t draw) const;

  Design design_;
  std::vector<std::string> hashes_;
  std::vector<std::string> keys_;
  std::vector<std::vector<std::uint32_t>> part_;  ///< of each range: which part each draw is in
  std::int64_t size_ = 0;
};

/// The keys of a design that are the names of options; others are keys of a scenario.
inline constexpr auto kOptionKeys = std::to_array<std::string_view>(
    {"elasticity", "friction", "shape", "response", "detection", "iterations"});

/// The keys that condition_of() knows.
std::vector<std::string> keys_of_conditions();

/// The numbers of these keys in the order in which they are set: hmd.profile, which sets other keys too, goes first.
std::vector<std::size_t> order_of(const std::vector<std::string>& keys);

/// The condition of a row.
///
/// @throws std::invalid_argument  for a value that is none of its key
scene::Condition condition_of(const std::vector<std::string>& keys,
                              const std::vector<std::string>& values);

/// The first columns of every table: key, trial and values. Their names, and their cells for a row.
std::vector<std::string> columns_of(const Rows& rows);
std::vector<std::string> cells_of(const Rows& rows, const Row& row);

}  // namespace headpin::sweep
