#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "devices/trial/trial.h"
#include "scene/play/hand.h"

/// How the ball leaves the hand: its velocity and spin at the very time of the trigger, and how they
/// are known.
namespace headpin::scene {

/// Until a sample is there, at most: a Fastrak's at 115200 baud.
inline constexpr Time kSampleLatency{8'000};

/// Up to when samples tell of the hand at a time, where poses are read `rig.delay_s` late: as far as
/// they are there in any case, so that a throw does not depend on when each of them came.
inline Time told_until(Time time, double delay_s) {
  return time + std::max(Time{}, microseconds(delay_s) - kSampleLatency);
}

/// How the velocity of a hand at a time is known.
enum class Known {
  tracked,       ///< samples on both sides
  extrapolated,  ///< by so long from the nearest sample
  impossible     ///< no sample is near enough, or none that a hand could make
};

/// "tracked", "extrapolated", "impossible".
std::string_view name_of(Known known);

struct Motion {
  Twist V_WB;  ///< [m/s], [rad/s]; zero where it is impossible
  Known known = Known::impossible;
  Time extrapolated{};  ///< by so much
  int left_out = 0;     ///< samples that lie off what the others say
};

/// How a point of the hand moves at a time.
///
/// Fits a cubic to the hand's positions and turns before and after that time; what is further away
/// weighs less, and nothing where the window ends, so that the answer goes on smoothly as the time
/// does (docs/release.md says why this fit). The window reaches back by `window.least` and grows to
/// `window.most` where the tracker is noisy. Left out are samples that no hand gets to from those
/// before and after, and one that lies off the fit of all others. Without a sample after the time,
/// the fit is followed for 30 ms past the last one, and the velocity held from then on; a sample
/// older than `window.least` tells nothing.
///
/// @param track  hand poses X_WH, oldest first, as far as they are known
/// @param p_HB   the point in the hand [m]
Motion motion_at(std::span<const Stamped<Pose>> track, Time at, const Vec3& p_HB,
                 const ReleaseWindow& window);

/// How a release was known, as the detail of its event; and back. Nothing for other events, and for
/// those of trials from before it was told.
std::string to_detail(const Motion& motion);
std::optional<Motion> motion_of(const devices::Event& event);

/// "tracked"; "extrapolated by 12 ms, 1 sample left out".
std::string in_words(const Motion& motion);

}  // namespace headpin::scene
