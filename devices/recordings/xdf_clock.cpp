#include "devices/recordings/xdf_clock.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

namespace headpin::devices {
namespace {

constexpr double kHuber = 1e-4;  // s: offsets that lie farther from the line count less

struct OffsetLine {
  double centre = 0.0, offset = 0.0, slope = 0.0;
  double at(double time) const { return offset + slope * (time - centre); }
};

/// The line with the least weighted squares.
OffsetLine weighted_line(std::span<const XdfClockOffset> points, std::span<const double> weights) {
  double sum = 0.0, time = 0.0, value = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += weights[i];
    time += weights[i] * points[i].time;
    value += weights[i] * points[i].value;
  }
  OffsetLine line{time / sum, value / sum, 0.0};
  double square = 0.0, product = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double t = points[i].time - line.centre;
    square += weights[i] * t * t;
    product += weights[i] * t * (points[i].value - line.offset);
  }
  if (square > 0.0) line.slope = product / square;
  return line;
}

/// The line with the least Huber loss, by least squares with new weights until they stay.
OffsetLine robust_line(std::span<const XdfClockOffset> points) {
  std::vector<double> weights(points.size(), 1.0);
  OffsetLine line = weighted_line(points, weights);
  for (int round = 0; round < 100; ++round) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double off = std::abs(points[i].value - line.at(points[i].time));
      weights[i] = off > kHuber ? kHuber / off : 1.0;
    }
    const OffsetLine next = weighted_line(points, weights);
    const double moved = std::abs(next.at(points.front().time) - line.at(points.front().time)) +
                         std::abs(next.at(points.back().time) - line.at(points.back().time));
    line = next;
    if (!(moved > 1e-9)) break;
  }
  return line;
}

double median(std::vector<double> numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::ranges::nth_element(numbers, middle);
  if (numbers.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(numbers.begin(), middle));
}

/// Whether numbers are above the usual by so many seconds, and by so many median deviations.
std::vector<bool> far_above(const std::vector<double>& numbers, double seconds, double deviations) {
  const double usual = median(numbers);
  std::vector<double> off;
  for (const double number : numbers) off.push_back(std::abs(number - usual));
  const double spread = median(off) + std::numeric_limits<double>::epsilon();
  std::vector<bool> far;
  for (const double number : numbers) {
    far.push_back(number - usual > seconds && (number - usual) / spread > deviations);
  }
  return far;
}

/// Numbers of the offsets after which the clock was reset, with the thresholds of pyxdf: both the time
/// and the offset jump.
std::vector<std::size_t> resets(std::span<const XdfClockOffset> offsets) {
  if (offsets.size() < 2) return {};
  std::vector<double> steps, changes;
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    steps.push_back(offsets[i].time - offsets[i - 1].time);
    changes.push_back(std::abs(offsets[i].value - offsets[i - 1].value));
  }
  const std::vector<bool> late = far_above(steps, 5.0, 5.0), moved = far_above(changes, 1.0, 10.0);
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if ((steps[i] < 0.0 || late[i]) && moved[i]) all.push_back(i);
  }
  return all;
}

/// The first sample after a reset: behind the largest jump of the times between the two offsets.
std::size_t first_after(std::span<const double> times, std::size_t begin, std::size_t end) {
  std::size_t first = std::min(end, times.size());
  double largest = 0.0;
  for (std::size_t i = std::max<std::size_t>(begin, 1); i < std::min(end + 1, times.size()); ++i) {
    const double jump = std::abs(times[i] - times[i - 1]);
    if (jump > largest) largest = jump, first = i;
  }
  return first;
}

}  // namespace

std::vector<double> synchronised(std::span<const double> times,
                                 std::span<const XdfClockOffset> measured,
                                 std::vector<std::string>& notes) {
  std::vector<double> out(times.begin(), times.end());
  std::vector<XdfClockOffset> finite;
  std::ranges::copy_if(measured, std::back_inserter(finite), [](const XdfClockOffset& one) {
    return std::abs(one.time) < 1e11 && std::abs(one.value) < 1e11;
  });
  if (finite.empty()) return out;
  const std::span<const XdfClockOffset> offsets = finite;
  std::size_t from = 0, sample = 0;
  const auto apply = [&](std::size_t to, std::size_t end) {
    const OffsetLine line = robust_line(offsets.subspan(from, to - from));
    for (; sample < end; ++sample) out[sample] += line.at(times[sample]);
    from = to;
  };
  for (const std::size_t last : resets(offsets)) {
    const std::size_t end = first_after(times, offsets[last].after, offsets[last + 1].after);
    notes.push_back(fmt::format("its clock was reset after {:.3f} s", offsets[last].time));
    apply(last + 1, std::max(end, sample));
  }
  apply(offsets.size(), times.size());
  return out;
}

}  // namespace headpin::devices
