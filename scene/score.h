#pragma once

#include <optional>
#include <span>

#include "devices/trial.h"

namespace headpin::scene {

/// What the events of a session come to. A function of the events, and the only one: whoever shows
/// a result reads it from here.
struct Score {
  std::int64_t skittles_down = 0;
  std::int64_t touches = 0;             ///< pairs of bodies that met, one of them a skittle
  std::optional<double> release_speed;  ///< of the first ball as it left the hand [m/s]
  std::optional<double> impact_speed;   ///< of a ball just before the first skittle [m/s]

  void add(const devices::Event& event);
};

Score score(std::span<const devices::Event> events);

}  // namespace headpin::scene
