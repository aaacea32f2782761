#include "sweep/shared_start.h"

#include <algorithm>
#include <utility>

#include "scene/play/run.h"

namespace headpin::sweep {
namespace {

/// Whether a key matters only where bodies touch.
bool acts_at_touches(const std::string& key) {
  return key == "elasticity" || key == "friction" || key == "response" ||
         key == "collision.response" || key.starts_with("material.");
}

/// Gives a session the materials and the response of a stage that differs in nothing else.
void change_stage(scene::Session& session, std::shared_ptr<const scene::Stage> stage) {
  engine::World& world = session.world;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const engine::Kind kind = world.bodies[i].kind;  // the hand may hold a ball
    world.bodies[i] = stage->world.bodies[i];
    world.bodies[i].kind = kind;
  }
  world.parameters = stage->world.parameters;
  engine::set_response(world, *stage->world.response);
  session.stage = std::move(stage);
}

}  // namespace

bool is_touched(const scene::Session& session) {
  const engine::Statistics& last = session.world.statistics;
  return last.contacts > 0 || last.impacts > 0 || !session.world.events.empty();
}

std::string text_of_others(std::size_t trial, const std::vector<std::string>& keys,
                           const std::vector<std::string>& values) {
  std::string text = std::to_string(trial);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (!acts_at_touches(keys[k])) text += "\n" + values[k];
  }
  return text;
}

SharedStart::Start& SharedStart::start_of(const std::string& text) {
  constexpr std::size_t kMost = 16;  // of other values, which may change from row to row
  const auto known = std::ranges::find(starts_, text, &Start::text);
  Start start{.text = text, .first_touch = {}, .run = {}};
  if (known != starts_.end()) {
    start = std::move(*known);
    starts_.erase(known);
  } else if (starts_.size() == kMost) {
    starts_.pop_front();
  }
  return starts_.emplace_back(std::move(start));
}

Run SharedStart::run_of(const std::string& text, const Begin& begin,
                        const std::function<void()>& check) {
  Start& start = start_of(text);
  Run run = begin();
  const bool versions = run.session.versions[0] != nullptr;  // each has a stage of its own
  if (!start.first_touch || versions) return run;
  if (!start.run) {
    Run first = run;
    while (first.session.tick + 1 < *start.first_touch) {
      check();
      scene::advance(first.session, first.source);
      first.sum.tick(first.session);
    }
    first.session.player.velocities = std::make_shared<scene::HandVelocities>();
    start.run = std::move(first);
  }
  std::shared_ptr<const scene::Stage> stage = run.session.stage;
  run = *start.run;
  change_stage(run.session, std::move(stage));
  return run;
}

void SharedStart::learn(std::optional<std::int64_t> first_touch) {
  std::optional<std::int64_t>& known = starts_.back().first_touch;
  if (!known) known = first_touch;
}

}  // namespace headpin::sweep
