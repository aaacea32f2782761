// What a pixel is called, against what the physics has there: rays through pixels' centres, cut with
// the bodies as they collide, at ticks of a whole throw.

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/looks/eyes.h"
#include "scene/play/run.h"
#include "scene/record/log.h"
#include "scene/record/trial.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

/// How far what is seen may be from what collides: the parts keep to the profile within 2 mm, and
/// a skittle of twelve faces around keeps to its circle within r (1 - cos 15 degrees) = 2 mm.
constexpr double kApart = 0.0045;  // [m]
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A body with its id.
struct Solid {
  std::uint32_t id;
  const engine::Compound* shape;
  Pose X_WB;
  double radius;  ///< of a ball about its origin that holds it
};

/// Whether a point is so far inside a shape.
bool is_deep(const engine::Shape& shape, const Vec3& p, double depth) {
  return std::visit(
      [&](const auto& s) {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, engine::HalfSpace>) {
          return false;
        } else {
          return engine::clearance(s, p) >= depth;
        }
      },
      shape);
}

/// How far along a ray it is first inside a body that is `more` thicker on all sides [m].
double way_to(const Solid& solid, const Vec3& p_W, const Vec3& d_W, double more) {
  const Vec3 p = solid.X_WB.inverse() * p_W, d = solid.X_WB.q.inverse() * d_W;
  const double middle = -p.dot(d);
  const double beside = (p + middle * d).norm();
  if (beside > solid.radius + more) return kNever;
  constexpr double kStep = 0.002;
  for (double s = middle - solid.radius - more; s < middle + solid.radius + more; s += kStep) {
    for (const engine::Part& part : solid.shape->parts) {
      const Vec3 q = part.X_BG.inverse() * Vec3(p + s * d);
      if (more > 0.0 ? engine::contains(part.shape, q, more) : is_deep(part.shape, q, -more)) {
        return s;
      }
    }
  }
  return kNever;
}

/// Of every third pixel of every third row.
struct Verdict {
  int wrong = 0;  ///< pixels that are called what cannot be there
  int seen = 0;   ///< pixels of ball and skittles
  std::vector<std::uint32_t> ids;
};

/// @param off  added to where the physics has each body
Verdict judge(const render::Labels& labels, const render::View& view,
              const std::vector<Solid>& solids, const Vec3& off = Vec3::Zero()) {
  Verdict verdict;
  const render::Frustum& f = view.frustum;
  for (int y = 0; y < view.height; y += 3) {
    for (int x = 0; x < view.width; x += 3) {
      const auto pixel = static_cast<std::size_t>(y * view.width + x);
      const std::uint32_t id = labels.id[pixel];
      const Vec3 d_E(f.left + (x + 0.5) / view.width * (f.right - f.left),
                     f.top - (y + 0.5) / view.height * (f.top - f.bottom), -1.0);
      const Vec3 d_W = view.X_WE.q * d_E.normalized();
      const double along = d_E.norm();  // of a ray, a metre of depth
      double nearest = kNever, own = kNever;
      std::uint32_t must_be = 0;
      for (Solid solid : solids) {
        solid.X_WB.p += off;
        const double sure = way_to(solid, view.X_WE.p, d_W, -kApart);
        if (sure < nearest) {
          nearest = sure;
          must_be = solid.id;
        }
        if (solid.id == id) own = way_to(solid, view.X_WE.p, d_W, kApart);
      }
      const bool body = id >= kFirstBallId;
      const double depth = along * static_cast<double>(labels.depth[pixel]);
      if (body) {
        ++verdict.seen;
        if (std::ranges::find(verdict.ids, id) == verdict.ids.end()) verdict.ids.push_back(id);
        // It is there, no nearer than it can be, and nothing surely stands before it.
        verdict.wrong += own == kNever || depth < own - 2.0 * kApart || nearest < own - kApart;
      } else if (must_be != 0) {  // something else is seen: it must be nearer than the body
        verdict.wrong += depth > nearest;
      }
    }
  }
  return verdict;
}

/// The moment of a throw's session as it is seen, and what stands where in it.
void expect_ids_where_bodies_are(const Session& session, Eyes& eyes, const Pose& X_WD,
                                 std::size_t bodies_seen) {
  std::vector<Solid> solids;
  const auto add = [&](const std::vector<engine::BodyId>& bodies, std::uint32_t id) {
    for (const engine::BodyId body : bodies) {
      const engine::Compound& shape = *session.world.bodies[body].shape;
      double radius = 0.0;
      for (const engine::Part& part : shape.parts) {
        radius = std::max(radius, part.X_BG.p.norm() + engine::bounding_radius(part.shape));
      }
      solids.push_back({id++, &shape, session.world.states[body].X_WB, radius});
    }
  };
  add(session.stage->balls, kFirstBallId);
  add(session.stage->skittles, kFirstSkittleId);
  const Glimpse seen = glimpse(session, X_WD);
  const auto labels = see_labels(eyes, seen);
  const auto views = render::eyes(X_WD, eyes.optics);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Verdict verdict = judge(labels[eye], views[eye], solids);
    EXPECT_EQ(verdict.wrong, 0) << "tick " << session.tick << " eye " << eye;
    EXPECT_GE(verdict.ids.size(), bodies_seen) << "tick " << session.tick;
    EXPECT_GT(verdict.seen, 50) << "tick " << session.tick;
    // Two centimetres beside, the same pictures are wrong.
    EXPECT_GT(judge(labels[eye], views[eye], solids, Vec3(0.02, 0.0, 0.0)).wrong, 10);
  }
}

Pose gaze_at(const Vec3& p_WD, const Vec3& target_W) {
  const Vec3 back = (p_WD - target_W).normalized();
  const Vec3 right = Vec3::UnitZ().cross(back).normalized();
  Mat3 R;
  R << right, back.cross(right), back;
  return {Quat(R), p_WD};
}

// The ball on its stand, in the hand, rolling, among the skittles, and what lies when all is over.
TEST(Ids, AreWhereThePhysicsHasBallAndSkittles) {
  const Trial trial = read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  Scenario scenario;  // of today: in the trial's, parts keep less well to the profile
  scenario.rig = scenario_of_trial(trial.header.scenario, "demo.lcmlog").rig;
  Session session = make_session(scenario);
  Eyes eyes = open_eyes(*session.stage);
  devices::ReplaySource source(trial.samples);
  const Vec3 rack(0.0, session.scenario().lane.head_pin + 0.3, 0.2);
  std::size_t looked = 0;
  const std::vector<std::int64_t> ticks =
      kThorough ? std::vector<std::int64_t>{10, 1000, 1200, 1400, 1680}
                : std::vector<std::int64_t>{1000, 1680};
  for (const std::int64_t tick : ticks) {
    while (session.tick < tick) advance(session, source);
    const Vec3 ball = session.world.states[session.stage->balls[0]].X_WB.p;
    const bool among_them = ball.y() > rack.y() - 1.5;
    const Vec3 target = among_them ? rack : ball;
    const Vec3 from =
        among_them ? Vec3(0.3, rack.y() - 2.0, 0.9) : Vec3(ball + Vec3(-0.3, -0.9, 0.5));
    expect_ids_where_bodies_are(session, eyes, gaze_at(from, target), among_them ? 5 : 1);
    ++looked;
  }
  EXPECT_EQ(looked, ticks.size());
}

}  // namespace
}  // namespace headpin::scene
