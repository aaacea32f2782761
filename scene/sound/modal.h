#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Modes of vibration, and a recurrence that makes their samples.
namespace headpin::scene {

inline constexpr std::int64_t kSoundRate = 48'000;  ///< samples a second

/// One mode of a body that rings.
struct Mode {
  double frequency = 0.0;  ///< [Hz]
  double decay = 0.0;      ///< the amplitude falls to 1/e in 1/decay seconds [1/s]
  double pressure = 0.0;   ///< amplitude at a distance of 1 m after an impulse of 1 N s [Pa]
};

/// The samples of one mode.
///
/// n samples after a strike the sound is A exp(-decay n / rate) sin(2 pi frequency n / rate). The
/// recurrence of a damped sine gives these values without a function call for each sample; strikes
/// add up.
class Resonator {
 public:
  explicit Resonator(const Mode& mode);

  /// @param amplitude  A [Pa]
  void strike(double amplitude) {
    last_ += amplitude * last_of_one_;
    before_ += amplitude * before_of_one_;
  }

  double next() {
    const double now = by_last_ * last_ + by_before_ * before_;
    before_ = last_;
    last_ = now;
    return now;
  }

  /// The same after a blow.
  /// @param impulse  [N s]
  double next(double impulse) {
    const double now = by_last_ * last_ + (by_before_ * before_ + by_impulse_ * impulse);
    before_ = last_;
    last_ = now;
    return now;
  }

  /// Whether nothing of it is heard any more: it is then silent until the next strike.
  bool fade();

 private:
  double by_last_, by_before_, by_impulse_;
  double last_of_one_, before_of_one_;  ///< samples before a strike with A = 1, as if it rang
  double last_ = 0.0, before_ = 0.0;    ///< the newest sample and the one before
};

/// Adds the next samples of resonators to a sum.
void ring(std::span<Resonator* const> resonators, std::span<double> sum);

/// The same, with a blow before each sample.
/// @param impulses  of the blows [N s], as many as samples
void ring(std::span<Resonator* const> resonators, std::span<const double> impulses,
          std::span<double> sum);

}  // namespace headpin::scene
