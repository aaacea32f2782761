#include "study/measures.h"

#include <algorithm>

#include "scene/record/events.h"

namespace headpin::study {

namespace {

/// Adds the distance from the previous place, if there is one.
void go_on(std::optional<Vec3>& before, const std::optional<Pose>& now, double& path) {
  if (now && before) path += (now->p - *before).norm();
  before = now ? std::optional(now->p) : std::nullopt;
}

}  // namespace

void Measurer::add_paths(const scene::Session& session, VersionMeasures& version) {
  const std::int64_t every = std::max<std::int64_t>(1, session.scenario().rates.physics_hz / 10);
  if (session.tick % every != 0) return;
  go_on(head_W_, scene::head_pose(session), version.head_path_m);
  go_on(hand_W_, scene::hand_pose(session), version.hand_path_m);
}

void Measurer::tick(const scene::Session& session) {
  for (const scene::Event& event : session.events) {
    score_.add(event, session.scenario());
    if (event.kind == scene::kind::version) {
      version_ = event.detail.text();
      if (std::ranges::find(so_far_.order, version_) == so_far_.order.end()) {
        so_far_.order.push_back(version_);
      }
      head_W_.reset();
      hand_W_.reset();
    }
    if (version_.empty()) continue;
    VersionMeasures& version = so_far_.versions[version_];
    version.approaches += event.kind == scene::kind::flies_at_player;
    const auto* passed = event.detail.get_if<scene::PassedPlayer>();
    version.evaded += passed && passed->moved;
  }
  if (version_.empty()) return;
  VersionMeasures& version = so_far_.versions[version_];
  ++version.ticks;
  add_paths(session, version);
}

SessionMeasures Measurer::measures(const scene::Session& session) const {
  SessionMeasures all = so_far_;
  for (const scene::Sheet& game : score_.games) {
    if (!all.versions.contains(game.version)) continue;
    VersionMeasures& version = all.versions[game.version];
    ++version.games;
    version.games_over += game.over;
    for (const auto& frame : game.frames) {
      for (const int felled : frame) version.skittles += felled;
    }
  }
  for (const scene::ThrowRow& one : score_.throws) {
    if (!all.versions.contains(one.version)) continue;
    VersionMeasures& version = all.versions[one.version];
    ++version.throws;
    version.fouls += one.foul.value_or(false);
    version.release_speed_sum += one.speed;
  }
  all.throws = score_.throws;
  all.unsolved_islands = session.statistics.unsolved;
  all.state_hash = scene::in_hex(session.state_hash);
  all.game_hash = scene::in_hex(session.game_hash.value());
  all.duration_s = nearest_seconds(session.now());
  return all;
}

}  // namespace headpin::study
