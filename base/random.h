#pragma once

#include <cstdint>

#include "base/math.h"

namespace headpin {

/// Random numbers by SplitMix64 (Steele, Lea, Flood 2014): the same on every computer. They stay
/// our own code, because the distributions of the standard library differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// Numbers that depend on what they are drawn for and not on the order of drawing.
  Random(std::uint64_t seed, std::uint64_t purpose, std::uint64_t number)
      : state_(seed * 0x9e3779b97f4a7c15u) {
    state_ = next() ^ (purpose * 0xd1b54a32d192ed03u);
    state_ = next() ^ (number * 0xabc98388fb8fac03u);
  }

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }

  /// [0, 1)
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Mean 0, deviation 1, |x| <= 6: the sum of twelve uniform ones.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

  Vec3 uniform3(double low, double high) {
    const double x = uniform(low, high), y = uniform(low, high), z = uniform(low, high);
    return {x, y, z};
  }
  Vec3 normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace headpin
