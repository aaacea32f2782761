#include "scene/people/sights.h"

#include <algorithm>

namespace headpin::scene {

std::optional<Vec3> worth_aiming_at(const Session& session) {
  std::vector<Vec3> standing;
  for (const engine::BodyId skittle : session.stage->skittles) {
    if (session.game.swept[skittle] || session.game.down[skittle]) continue;
    standing.push_back(session.world.states[skittle].X_WB.p);
  }
  std::optional<Vec3> best;
  long most = 0;
  for (const Vec3& p : standing) {
    constexpr double kBeside = 0.35;
    const long beside =
        std::ranges::count_if(standing, [&](const Vec3& q) { return (q - p).norm() < kBeside; });
    const bool nearer = best && p.y() < best->y();
    if (!best || (nearer && 2 * beside >= most) || beside > 2 * most) {
      best = p;
      most = beside;
    }
  }
  return best;
}

std::optional<Vec3> liveliest_skittle(const Session& session) {
  constexpr double kLively = 0.3;
  std::optional<Vec3> found;
  double fastest = kLively;
  for (const engine::BodyId skittle : session.stage->skittles) {
    if (session.world.bodies[skittle].kind != engine::Kind::free) continue;
    const double speed = session.world.states[skittle].v_WB.norm();
    if (speed <= fastest) continue;
    fastest = speed;
    found = session.world.states[skittle].X_WB.p;
  }
  return found;
}

Vec3 rack_middle(const Session& session) {
  Vec3 sum = Vec3::Zero();
  for (const engine::BodyId skittle : session.stage->skittles) {
    sum += session.stage->world.states[skittle].X_WB.p;
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, session.stage->skittles.size()));
}

}  // namespace headpin::scene
