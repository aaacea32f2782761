#pragma once

#include <cstdint>

#include "scene/sound/modes.h"

/// The noise of a ball that rolls: its lane is not quite even.
namespace headpin::scene {

/// The force between a rolling ball and the lane, without its mean.
///
/// The surface is uneven by 1.27 micrometres (USBC allows so much for a ball: 50 microinches); the
/// force is that times the stiffness of Hertz's contact. What is finer than the contact is not felt.
/// The unevenness is a fixed function of the distance rolled, the same in every trial.
class RollingNoise {
 public:
  /// @param load  weight of the ball [N]
  RollingNoise(const ContactSurface& ball, const ContactSurface& lane, double load);

  /// The force after some more way [N].
  double after(double way);

 private:
  double grain_;     ///< width of the contact [m]
  double strength_;  ///< largest force [N]
  std::uint64_t grains_ = 0;
  double rest_ = 0.0;  ///< of the way, in grains
  double from_ = 0.0, to_ = 0.0;
};

}  // namespace headpin::scene
