#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/resample.h"
#include "devices/source.h"
#include "devices/trial.h"
#include "engine/world.h"
#include "scene/scenario.h"

/// The flow of one tick: samples in, hand and head moved, the world stepped, what happened out.
namespace headpin::scene {

/// Where the player is, as far as the samples tell.
struct Player {
  devices::PoseTrack head;                    ///< X_WD: display, x right, y up, looking along -z
  devices::PoseTrack hand;                    ///< X_WH
  std::optional<Time> head_arrival;           ///< when its newest sample was known
  std::vector<devices::MouseSample> buttons;  ///< not yet acted upon, oldest first
  bool trigger = false;
  bool grips = false;
  Quat q_HB = Quat::Identity();  ///< the carried ball in the hand
};

/// What a session comes to.
struct Score {
  std::vector<bool> down;               ///< of each skittle
  std::optional<double> release_speed;  ///< of the ball as it first left the hand [m/s]
  std::optional<double> impact_speed;   ///< of the ball just before its first skittle [m/s]

  int skittles_down() const;
};

struct Session {
  Scenario scenario;
  engine::World world;
  engine::BodyId ball = 0;           ///< its number among the world's bodies
  engine::BodyId first_skittle = 0;  ///< of scenario.rack.spots.size(), in the order of the spots
  Player player;
  Score score;
  engine::Statistics statistics;  ///< of all steps so far

  // What the last tick took in and gave out.
  std::vector<devices::Sample> samples;
  std::vector<devices::Event> events;

  Time now() const;
};

Session make_session(const Scenario& scenario);

/// Names of the world's bodies, in their order: "lane", "ball", "skittle 1" ...
std::vector<std::string> body_names(const Session& session);

/// One tick: everything the source knows by then, then one step of the world.
///
/// The samples taken in and the events stand in the session until the next tick.
/// @throws std::runtime_error  naming tick and body when the state turns non-finite
void advance(Session& session, devices::Source& source);

/// The world after the last tick, for the log.
void tick_state(const Session& session, devices::TickState& out);

/// Head and hand now: read between the samples `rig.delay_s` ago, held after the last one.
std::optional<Pose> head_pose(const Session& session);  ///< X_WD
std::optional<Pose> hand_pose(const Session& session);  ///< X_WH

}  // namespace headpin::scene
