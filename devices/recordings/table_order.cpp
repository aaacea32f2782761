#include "devices/recordings/table_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

namespace headpin::devices {
namespace {

/// How far rows have come before row `i`: the third largest time of the last twenty since `begin`, so that two
/// stray ones do not count.
double front(std::span<const double> times_s, std::size_t begin, std::size_t i) {
  constexpr std::size_t kRows = 20;
  const std::size_t from = std::max(begin, i - std::min(i, kRows));
  std::array<double, 3> largest{};
  largest.fill(-std::numeric_limits<double>::infinity());
  std::ranges::partial_sort_copy(times_s.subspan(from, i - from), largest, std::ranges::greater{});
  return largest.back();
}

double lower_quartile(std::vector<double> steps) {
  if (steps.empty()) return 0.0;
  const auto quarter = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 4);
  std::ranges::nth_element(steps, quarter);
  return *quarter;
}

/// The steps in time from a row to the one below it, where no row is missing.
class OrdinarySteps {
 public:
  explicit OrdinarySteps(std::span<const double> times_s) : times_s_(times_s) {}

  /// Takes the steps between the rows above a row. The first ones say how long a step may be.
  void take_rows(std::size_t row) {
    if (next_ == 1) longest_s_ = longest_step(row);
    for (; next_ < row; ++next_) {
      const double from = times_s_[next_ - 1], to = times_s_[next_];
      if (to >= from && to - from <= kMost * usual_step(next_)) add(from, to);
    }
  }

  /// Whether a time falls into one of them.
  bool hold(double time_s) const {
    const auto behind = spans_.upper_bound(time_s);
    return behind != spans_.begin() && std::prev(behind)->second >= time_s;
  }

 private:
  void add(double from, double to) {
    auto behind = spans_.upper_bound(to);
    while (behind != spans_.begin() && std::prev(behind)->second >= from) {
      const auto joined = std::prev(behind);
      from = std::min(from, joined->first), to = std::max(to, joined->second);
      behind = spans_.erase(joined);
    }
    spans_.emplace_hint(behind, from, to);
  }

  /// As long as a usual step may be: longer in a slow recording, but not where few rows or a disorder look slow.
  /// Rows of one time count as one.
  double longest_step(std::size_t rows) const {
    constexpr double kLongest_s = 0.1;
    std::vector<double> ahead;
    std::size_t back = 0;
    for (std::size_t i = 1; i < rows; ++i) {
      const double step = times_s_[i] - times_s_[i - 1];
      if (step > 0.0) ahead.push_back(step);
      if (step < 0.0) ++back;
    }
    const std::size_t times = ahead.size() + back + 1;
    if (times < kTimes ? back > 0 || !are_whole(ahead, rows) : 10 * back > times) return kLongest_s;
    return std::max(kLongest_s, kMost * lower_quartile(ahead));
  }

  /// Whether a few times may be a slow recording of their own: their steps are even, and the twenty times below
  /// them are in order. Rows in turns begin again sooner.
  bool are_whole(const std::vector<double>& steps, std::size_t rows) const {
    constexpr std::size_t kFewest = 6;
    return steps.size() + 1 >= kFewest && in_order(rows) >= kTimes &&
           std::ranges::max(steps) <= kMost * lower_quartile(steps);
  }

  /// How many times are in order from a row on.
  std::size_t in_order(std::size_t row) const {
    if (row == times_s_.size()) return 0;
    std::size_t times = 1;
    for (std::size_t i = row + 1; i < times_s_.size() && times_s_[i] >= times_s_[i - 1]; ++i) {
      if (times_s_[i] > times_s_[i - 1]) ++times;
    }
    return times;
  }

  /// The lower quartile of the last twenty steps, as many others may lack a row; 0 where it is too long.
  double usual_step(std::size_t row) const {
    std::vector<double> steps;
    for (std::size_t i = row - std::min(row, kTimes) + 1; i <= row; ++i) {
      const double step = times_s_[i] - times_s_[i - 1];
      if (step != 0.0) steps.push_back(step);
    }
    drop_bursts(steps, row);
    for (double& step : steps) step = std::abs(step);
    const double usual = lower_quartile(steps);
    return usual > longest_s_ ? 0.0 : usual;
  }

  /// Leaves the steps from one burst of rows to the next, where rows come in bursts. A few gaps make none, and
  /// neither does a disorder.
  void drop_bursts(std::vector<double>& steps, std::size_t row) const {
    constexpr double kLongestInside_s = 0.0025, kMostInside = 0.1;  // of the steps between bursts
    std::ranges::sort(steps);
    if (steps.size() < 2 || steps[1] < 0.0) return;
    const double between = steps[steps.size() - 2];
    const double inside = std::min(kLongestInside_s, kMostInside * between);
    if (repeat(inside, row))
      std::erase_if(steps, [&](double step) { return step >= 0.0 && step < inside; });
  }

  /// Whether steps as long as those between bursts come again and again above a row.
  bool repeat(double long_s, std::size_t row) const {
    constexpr std::size_t kOfLast = 60, kLeast = 5, kMostRows = 8;  // of a burst
    const std::size_t among = std::min(row, kOfLast);
    std::size_t found = 0;
    for (std::size_t i = row - among + 1; i <= row; ++i) {
      if (times_s_[i] - times_s_[i - 1] >= long_s) ++found;
    }
    return found >= kLeast && kMostRows * found >= among;
  }

  static constexpr std::size_t kTimes = 20;
  static constexpr double kMost = 1.5;  // of the usual step
  std::span<const double> times_s_;
  std::size_t next_ = 1;
  double longest_s_ = 0.0;
  std::map<double, double>
      spans_;  // joined steps, apart from each other: their ends by their beginnings
};

}  // namespace

bool is_stray(std::span<const double> times_s, std::size_t row) {
  constexpr double kFar_s = 0.5, kLongest_s = 0.2;
  if (row < 2 || row + 2 >= times_s.size()) return false;
  const double above = times_s[row - 1], below = times_s[row + 1];
  const double off = std::min(std::abs(times_s[row] - above), std::abs(times_s[row] - below));
  const double step = std::max(above - times_s[row - 2], times_s[row + 2] - below);
  const double hole = below - above;
  return off > kFar_s && step > 0.0 && hole > 1.5 * step && hole < kLongest_s;
}

std::optional<std::size_t> starts_again(std::span<const double> times_s) {
  constexpr double kStepBack_s = 0.5;
  constexpr int kSeveral = 5;
  OrdinarySteps above(times_s);
  std::size_t begin = 0;  // of the rows that go on since the last step back
  int among = 0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    if (times_s[i] < front(times_s, begin, i) - kStepBack_s) {
      begin = i;
      among = 0;
      above.take_rows(begin);
    }
    if (begin > 0 && above.hold(times_s[i]) && ++among == kSeveral) return begin;
  }
  return std::nullopt;
}

}  // namespace headpin::devices
