#include "scene/watch/alone.h"

#include <utility>

#include "scene/play/game.h"
#include "scene/play/score.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

/// Gives a session the samples of another session.
class Handed : public devices::Source {
 public:
  explicit Handed(const std::vector<devices::Sample>& samples) : samples_(samples) {}
  void poll(Time, std::vector<devices::Sample>& out) override {
    out.insert(out.end(), samples_.begin(), samples_.end());
  }
  bool exhausted() const override { return true; }

 private:
  const std::vector<devices::Sample>& samples_;
};

/// Whether a skittle stands on its spot, by the rules of the game: in no hand and not swept, upright and
/// no further from its spot than `game.off_spot`.
bool is_on_its_spot(const engine::World& world, const Stage& stage, engine::BodyId skittle) {
  return world.bodies[skittle].kind == engine::Kind::free &&
         !has_fallen(world.states[skittle].X_WB) && !is_off_spot(world, stage, skittle);
}

/// Where a skittle of another stage stands: on its base where it stood, or, if it stood on its spot, as
/// far from its new spot as it was from the old one.
Pose moved_skittle(const engine::World& from, const Stage& before, const Stage& stage,
                   engine::BodyId skittle) {
  Pose X_WB = from.states[skittle].X_WB;
  const Pose &old_spot = before.world.states[skittle].X_WB,
             &new_spot = stage.world.states[skittle].X_WB;
  if (X_WB.p == old_spot.p && X_WB.q.coeffs() == old_spot.q.coeffs()) return new_spot;
  // A skittle of another shape may have another centre of mass; its base stays in place.
  X_WB.p += X_WB.q * Vec3(0.0, 0.0, stage.skittle_centre - before.skittle_centre);
  if (is_on_its_spot(from, before, skittle)) {
    X_WB.p.head<2>() += new_spot.p.head<2>() - old_spot.p.head<2>();
  }
  return X_WB;
}

/// The world of another stage: the room is that stage's, its skittles stand on that stage's spots, and all
/// other bodies are where they were.
engine::World moved_into(const engine::World& from, const Stage& before, const Stage& stage) {
  engine::World world = stage.world;
  engine::take_over(world, from);
  take_over_wear(world, stage, from, before);
  for (engine::BodyId body = 0; body < world.bodies.size(); ++body) {
    if (world.bodies[body].kind == engine::Kind::fixed) {
      world.states[body] = stage.world.states[body];
    }
  }
  for (const engine::BodyId skittle : stage.skittles) {
    world.states[skittle].X_WB = moved_skittle(from, before, stage, skittle);
  }
  return world;
}

}  // namespace

bool is_release_of_ball(const Event& event) {
  return event.kind == kind::release && is_of_ball(event);
}

Session on_its_own(Session session, const std::shared_ptr<const Stage>& stage) {
  const bool same = session.stage == stage;
  if (!same && !differences(session.stage->scenario, stage->scenario).empty()) {
    session.world = moved_into(session.world, *session.stage, *stage);
  }
  session.stage = stage;
  session.versions = {};
  session.unbegun = nullptr;
  return session;
}

void Alone::step(const std::vector<devices::Sample>& samples) {
  Handed source(samples);
  scene::advance(session, source);
  for (const Event& event : session.events) {
    result.skittles_down += event.kind == kind::skittle_down;
    if (is_release_of_ball(event) && !result.release_speed) result.release_speed = event.value;
    if (event.kind == kind::first_contact && !result.impact_speed) {
      result.impact_speed = event.value;
    }
    if (event.kind == kind::delivery && !result.felled) {
      result.felled = static_cast<int>(event.value);
    }
  }
  constexpr Time kCounting{1'000'000};  // the rules may count a little later
  const bool counts = session.game.begun && !session.game.over;
  const Time longest =
      microseconds(session.scenario().game.ball_back_s) + (counts ? kCounting : Time{});
  over = result.felled || session.now() - let_go > longest;
}

void Alone::advance(std::vector<devices::Sample> samples) {
  if (over) return;
  for (devices::Sample& sample : samples) {
    if (auto* button = std::get_if<devices::MouseSample>(&sample)) button->trigger = false;
  }
  step(samples);
}

}  // namespace headpin::scene
