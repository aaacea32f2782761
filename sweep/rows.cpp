#include "sweep/rows.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "base/random.h"
#include "base/sha256.h"
#include "scene/scenario/keys.h"
#include "study/csv.h"

namespace headpin::sweep {

namespace {

constexpr std::uint64_t kParts = 201, kPlaces = 202;  // purposes of random numbers

/// A permutation of 0 .. n-1 (Fisher and Yates).
std::vector<std::uint32_t> shuffled(std::int64_t n, std::uint64_t seed, std::uint64_t which) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0u);
  Random random(seed, kParts, which);
  for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random.next() % i]);
  return all;
}

double from_0_to_1(const std::string& key, const std::string& value) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  const bool is_number = error == std::errc{} && end == value.data() + value.size();
  if (is_number && number >= 0.0 && number <= 1.0) return number;
  throw std::invalid_argument(
      fmt::format("{} must be a number from 0 to 1, found {}", key,
                  is_number ? value : fmt::format("'{}'", study::shown(value))));
}

/// A string in TOML quotes, because the shape 'true' is not a boolean.
std::string in_quotes(const std::string& key, const std::string& value) {
  if (value.find_first_of("'\n") == std::string::npos) return "'" + value + "'";
  throw std::invalid_argument(
      fmt::format("{} must be a name, found '{}'", key, study::shown(value)));
}

}  // namespace

Rows::Rows(const Design& design, std::vector<std::string> hashes)
    : design_(design), hashes_(std::move(hashes)), size_(row_count(design)) {
  for (const Axis& axis : design.grid) keys_.push_back(axis.key);
  for (const Range& range : design.drawn) {
    if (design.latin_hypercube) {
      part_.push_back(shuffled(design.draws, design.seed, part_.size()));
    }
    keys_.push_back(range.key);
  }
}

std::string Rows::drawn(std::size_t range, std::int64_t draw) const {
  const auto number = static_cast<std::uint64_t>(draw) * 1000u + static_cast<std::uint64_t>(range);
  double place = Random(design_.seed, kPlaces, number).uniform();
  if (design_.latin_hypercube) {
    place =
        (part_[range][static_cast<std::size_t>(draw)] + place) / static_cast<double>(design_.draws);
  }
  const Range& of = design_.drawn[range];
  return fmt::format("{}", of.from + place * (of.to - of.from));
}

Row Rows::at(std::int64_t number) const {
  Row row;
  row.number = number;
  const auto digit = [&](std::int64_t base) {
    const std::int64_t value = number % base;
    number /= base;
    return value;
  };
  row.trial = static_cast<std::size_t>(digit(std::ssize(design_.trials)));
  const std::int64_t draw = digit(design_.draws);
  for (auto axis = design_.grid.rbegin(); axis != design_.grid.rend(); ++axis) {
    row.values.push_back(axis->values[static_cast<std::size_t>(digit(std::ssize(axis->values)))]);
  }
  std::ranges::reverse(row.values);
  for (std::size_t i = 0; i < design_.drawn.size(); ++i) row.values.push_back(drawn(i, draw));
  std::map<std::string, std::string> said;  // in an order that is not the design's
  for (std::size_t i = 0; i < keys_.size(); ++i) said[keys_[i]] = row.values[i];
  std::string text = hashes_[row.trial] + "\n";
  for (const auto& [key, value] : said) text += key + "=" + value + "\n";
  row.key = base::sha256(text).substr(0, 16);
  return row;
}

std::vector<std::string> keys_of_conditions() {
  std::vector<std::string> keys(kOptionKeys.begin(), kOptionKeys.end());
  for (const scene::ScenarioKey& key : scene::scenario_keys()) {
    const bool in_a_list = key.key.find('[') != std::string::npos;
    if (key.kind != "table" && !in_a_list) keys.push_back(key.key);
  }
  return keys;
}

std::vector<std::size_t> order_of(const std::vector<std::string>& keys) {
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(),
                        [&](std::size_t i) { return keys[i] == "hmd.profile"; });
  return order;
}

scene::Condition condition_of(const std::vector<std::string>& keys,
                              const std::vector<std::string>& values) {
  scene::Condition condition;
  for (const std::size_t i : order_of(keys)) {
    const std::string &key = keys[i], &value = values[i];
    if (key == "elasticity") {
      condition.elasticity = from_0_to_1(key, value);
    } else if (key == "friction") {
      condition.friction = from_0_to_1(key, value);
    } else if (key == "shape" || key == "response" || key == "detection") {
      condition.set.push_back("collision." + key + "=" + in_quotes(key, value));
    } else if (key == "iterations") {
      condition.set.push_back("collision.iterations=" + value);
    } else {
      condition.set.push_back(key + "=" + value);
    }
  }
  return condition;
}

std::vector<std::string> columns_of(const Rows& rows) {
  std::vector<std::string> columns = {"key", "trial"};
  columns.insert(columns.end(), rows.keys().begin(), rows.keys().end());
  return columns;
}

std::vector<std::string> cells_of(const Rows& rows, const Row& row) {
  std::vector<std::string> cells = {
      row.key, std::filesystem::path(rows.design().trials[row.trial]).stem().string()};
  cells.insert(cells.end(), row.values.begin(), row.values.end());
  return cells;
}

}  // namespace headpin::sweep
