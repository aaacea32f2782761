#include "scene/watch/alone.h"

#include <utility>

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

/// The world of another stage, with all bodies at their present places.
engine::World moved_into(const engine::World& from, const Stage& before, const Stage& stage) {
  engine::World world = stage.world;
  engine::take_over(world, from);
  take_over_wear(world, stage, from, before);
  // A skittle of another shape may have another centre of mass; its base stays in place.
  const Vec3 higher(0.0, 0.0, stage.skittle_centre - before.skittle_centre);
  for (const engine::BodyId skittle : stage.skittles) {
    Pose& X_WB = world.states[skittle].X_WB;
    X_WB.p += X_WB.q * higher;
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
