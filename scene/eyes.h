#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "render/eyes.h"
#include "scene/looks.h"
#include "scene/session.h"

/// The participant's eyes: what a session looks like to whoever is in it.
namespace headpin::scene {

struct Eyes {
  render::Renderer renderer;
  Looks looks;
  render::Optics optics;
  render::Quality look;
};

/// Eyes that draw as the stage's scenario wants it, or in another look.
/// @throws std::runtime_error  when nothing can be drawn on this machine; says why
Eyes open_eyes(const Stage& stage);
/// @param gl  as render::open_context
Eyes open_eyes(const Stage& stage, const render::Quality& look, std::string_view gl = {});

/// All that is needed to draw one moment of a session, so that it can be drawn later or elsewhere.
struct Glimpse {
  Pose X_WD = {};  ///< head display
  std::vector<Pose> X_WB_skittles = {}, X_WB_balls = {};
  bool ellipsoids = false;
  double skittle_centre = 0.0;
  std::optional<Pose> X_WH = {};
  bool grips = false;
  std::optional<Pose> X_WC = {};  ///< a camera that sees in the head's stead, and the head itself
};

/// Cameras for people who want to see who throws: behind and beside, and straight above the room,
/// the lane to the right, all of it in the picture.
Pose third_person_camera(const Scenario& scenario);
Pose top_camera(const Scenario& scenario);

Glimpse glimpse(const Session& session, const Pose& X_WD);

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

/// Draws both eyes, left first.
///
/// @return  the views drawn, X_WE of each eye in them
std::array<render::View, 2> see(Eyes& eyes, const Glimpse& glimpse,
                                std::array<render::Image, 2>& out);

/// What the same pixels' centres see, and how far it is: truth for segmentation and depth.
std::array<render::Labels, 2> see_labels(Eyes& eyes, const Glimpse& glimpse);

}  // namespace headpin::scene
