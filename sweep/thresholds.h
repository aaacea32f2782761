#pragma once

#include <array>
#include <string_view>

namespace headpin::sweep {

/// A published threshold of visual perception.
struct Threshold {
  std::string_view name;
  double value;
  std::string_view unit;
  std::string_view quantity;  ///< what was distinguished, and how
  std::string_view source;
  std::string_view read_in;  ///< abstract, or a book that cites it
};

/// A detail that the eye resolves.
inline constexpr Threshold kDetail{"detail",
                                   1.0,
                                   "arcmin",
                                   "smallest detail that is resolved, 0.5 to 1 arcmin",
                                   "textbooks of vision, for high contrast and good light",
                                   "handbook chapter"};
/// A difference of speed, as a share.
inline constexpr Threshold kSpeed{
    "speed",
    0.07,
    "",
    "Weber fraction of the speed of moving dots from 4 to 64 deg/s, 84 % correct",
    "De Bruyn and Orban 1988, Vision Research 28, 1323",
    "abstract"};
/// A difference between the times at which a body is struck.
inline constexpr Threshold kContact{
    "contact",
    46.0,
    "ms",
    "pause at a contact from which on fewer people see that one thing launches another",
    "Michotte 1946, The Perception of Causality",
    "a later paper that cites it"};
/// A difference of a coefficient of restitution, as a share.
inline constexpr Threshold kBounce{
    "bounce",
    0.10,
    "",
    "difference of the coefficient of restitution of a bouncing ball, as a share",
    "Yoshizawa, Yamada and Kawahara, European Conference on Visual Perception",
    "abstract"};

inline constexpr std::array kThresholds{kDetail, kSpeed, kContact, kBounce};
/// Speeds for which kSpeed was measured [deg/s].
inline constexpr double kSlowest = 4.0, kFastest = 64.0;

}  // namespace headpin::sweep
