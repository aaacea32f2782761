#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "devices/base/source.h"
#include "scene/people/figure.h"
#include "scene/people/person.h"
#include "scene/scenario/scenario.h"

/// The body of a virtual participant, as a tracker and a 3D mouse measure it.
namespace headpin::scene {

/// An angle that follows a target without overshoot, as a head follows the eyes.
struct Following {
  double angle = 0.0, speed = 0.0;  ///< [rad], [rad/s]
  void step(double target, double dt);
};

/// Involuntary small movements: three sines for each of three axes.
class Trembles {
 public:
  Trembles(Random& random, double amplitude, double low_hz, double high_hz);
  Vec3 at(double time) const;

 private:
  std::array<Vec3, 3> amplitude_, rate_, phase_;
};

class ParticipantBody {
 public:
  ParticipantBody(const Person& person, const Rig& rig, const Posture& posture);

  Build build;
  Figure figure;

  /// Turns the head towards a point of the tracked space; once a tick of `dt` seconds.
  void look_at(const Vec3& p_PQ, double now, double dt);

  /// X_PD and X_PH, with tremor and sway.
  Pose head(double time) const;
  Pose hand(double time) const;

  // Buttons, from a time on. Times of later calls are later.
  void thumbs(Time time, int forward);  ///< 1 forward, -1 backward, 0 none
  void trigger(Time time, bool down);

  /// The samples of both devices that have arrived by `now`, oldest first: 120 measurements per
  /// second of head and hand in turn, with a Fastrak's noise for their distance and the latency of
  /// its line.
  void sense(Time now, std::vector<devices::Sample>& out);

 private:
  void measure(std::int64_t cycle, Time time);

  Rig rig_;
  Trembles sway_, hand_shift_, hand_turn_;
  Random noise_;
  Following turn_, pitch_;
  double looked_ = 0.0;  ///< time at which the head was last turned
  devices::MouseSample mouse_;
  std::int64_t cycle_ = 0;
  std::vector<devices::Sample> waiting_;  ///< not arrived yet
};

}  // namespace headpin::scene
