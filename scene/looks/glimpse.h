#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scene/looks/looks.h"
#include "scene/play/session.h"

/// One moment of a session as it is seen, apart from whoever draws it.
namespace headpin::scene {

/// All that is needed to draw one moment of a session, so that it can be drawn later or elsewhere.
struct Glimpse {
  Pose X_WD = {};  ///< head display
  std::vector<Pose> X_WB_skittles = {}, X_WB_balls = {};
  bool ellipsoids = false;
  double skittle_centre = 0.0;
  std::optional<Pose> X_WH = {};
  double closed = 0.0;            ///< the hand, see Moving
  std::optional<Pose> X_WC = {};  ///< a camera that sees in the head's stead, and the head itself
};

Glimpse glimpse(const Session& session, const Pose& X_WD);

/// What of it is drawn.
Moving moving(const Glimpse& glimpse);

/// What a session looks like between two of its ticks: bodies and hand are mixed from those of both.
class BetweenTicks {
 public:
  /// Told of every tick, when it is over and has been looked at.
  void keep(const Session& session);

  /// At a time since the tick that was kept, which is the one before the session's last. What was
  /// put elsewhere within the tick, as by a new rack, is seen where it was until the tick is over.
  /// Without a tick that was kept, as at the last one.
  Glimpse glimpse(const Session& session, Time at, const Pose& X_WD) const;

 private:
  std::shared_ptr<const Stage> stage_;
  Time time_{};
  Glimpse seen_;
  std::vector<engine::State> states_;
};

}  // namespace headpin::scene
