#include "scene/looks/looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "render/osmesa_context.h"
#include "scene/looks/eyes.h"
#include "scene/looks/hand_mesh.h"
#include "scene/looks/room_mesh.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {
namespace {

using render::Image;
using render::Labels;
using render::View;

struct Seen {
  Scenario scenario;
  render::Renderer renderer{render::osmesa_context()};
  Stage stage = make_stage(scenario);
  Looks looks{renderer, stage};
  Glimpse glimpse{.X_WB_balls = std::vector<Pose>(1)};
  std::vector<Pose>&skittles = glimpse.X_WB_skittles, &balls = glimpse.X_WB_balls;

  explicit Seen(const Scenario& of = {}) : scenario(of) {
    for (const Vec2& spot : scenario.rack.spots) {
      skittles.push_back({Quat::Identity(),
                          Vec3(spot.x(), scenario.lane.head_pin + spot.y(), stage.skittle_centre)});
    }
    balls[0].p = scenario.ball.home;
    glimpse.skittle_centre = stage.skittle_centre;
  }
  /// A head at the foul line, looking a little down at the skittles.
  std::array<View, 2> views() const {
    return render::eyes({rotation(Vec3(0.5 * std::numbers::pi - 0.15, 0, 0)), Vec3(0, -0.5, 1.65)},
                        {});
  }
  Labels labels(const View& view) { return renderer.labels(draw_list(looks, glimpse), view); }
};

Vec2 project(const View& view, const Vec3& p_W) {
  const Vec3 p = view.X_WE.inverse() * p_W;
  const render::Frustum& f = view.frustum;
  return {view.width * (p.x() / -p.z() - f.left) / (f.right - f.left),
          view.height * (f.top - p.y() / -p.z()) / (f.top - f.bottom)};
}

struct Mask {
  int count = 0;
  Vec2 middle = Vec2::Zero();
  Vec2 lo = Vec2::Constant(1e9), hi = Vec2::Constant(-1e9);
};

Mask mask(const Labels& labels, std::uint32_t id) {
  Mask m;
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      if (labels.id[static_cast<std::size_t>(y * labels.width + x)] != id) continue;
      const Vec2 p(x + 0.5, y + 0.5);
      ++m.count;
      m.middle += p;
      m.lo = m.lo.cwiseMin(p);
      m.hi = m.hi.cwiseMax(p);
    }
  }
  if (m.count > 0) m.middle /= m.count;
  return m;
}

TEST(Looks, ShowEverySkittleThatStandsWhereItStands) {
  Seen seen;
  for (const View& view : seen.views()) {
    const Labels labels = seen.labels(view);
    for (std::size_t i = 0; i < seen.skittles.size(); ++i) {
      const Mask m = mask(labels, kFirstSkittleId + static_cast<std::uint32_t>(i));
      ASSERT_GE(m.count, 8) << i;
      const Vec3 p = seen.skittles[i].p;
      const Vec2 foot = project(view, p - Vec3(0, 0, seen.stage.skittle_centre));
      const Vec2 head = project(view, p + Vec3(0, 0, 0.381 - seen.stage.skittle_centre));
      EXPECT_NEAR(m.lo.y() - 0.5, head.y(), 1.0) << i;  // its head hides behind no other
      EXPECT_LT(m.hi.y() + 0.5, foot.y() + 1.5) << i;
      EXPECT_NEAR(0.5 * (m.lo.x() + m.hi.x()), foot.x(), 1.6) << i;
    }
  }
}

TEST(Looks, ShowNoSkittleThatIsNotThere) {
  Seen seen;
  seen.skittles.resize(3);
  const Labels labels = seen.labels(seen.views()[0]);
  EXPECT_GT(mask(labels, kFirstSkittleId + 2).count, 0);
  EXPECT_EQ(mask(labels, kFirstSkittleId + 3).count, 0);
}

TEST(Looks, ShowALyingSkittleWiderThanTall) {
  Seen seen;
  seen.skittles[0] = {rotation(Vec3(0, 0.5 * std::numbers::pi, 0)), Vec3(0.0, 5.5, 0.0605)};
  const Mask m = mask(seen.labels(seen.views()[0]), kFirstSkittleId);
  const Vec2 size = m.hi - m.lo;
  EXPECT_GT(render::Optics{}.pixel_aspect() * size.x(), 2.0 * size.y());
}

// The room is closed: no look may go past its walls, from anywhere in it.
TEST(Looks, HaveARoomWithoutHoles) {
  Scenario hall;
  hall.room.ahead = 60.0;
  const render::Optics optics{.far = 100.0};
  for (const Scenario& scenario : {Scenario{}, hall}) {
    Seen seen(scenario);
    for (const Vec3& at : {Vec3(0, -1, 1.6), Vec3(-1.8, 3, 1.2), Vec3(1.5, 5, 0.4)}) {
      for (int turn = 0; turn < 8; ++turn) {
        for (const double tilt : {-1.2, -0.6, 0.0, 0.6, 1.2}) {
          const Pose X_WD{rotation(Vec3(0, 0, turn * std::numbers::pi / 4 + 0.01)) *
                              rotation(Vec3(0.5 * std::numbers::pi + tilt, 0, 0)),
                          at};
          const Labels labels = seen.labels(render::eyes(X_WD, optics)[0]);
          EXPECT_EQ(mask(labels, 0).count, 0) << at.transpose() << " " << turn << " " << tilt;
        }
      }
    }
  }
}

TEST(Looks, HaveWallsAndFloorWhereTheRoomEnds) {
  Seen seen;
  const Room& room = seen.scenario.room;
  const double quarter = 0.5 * std::numbers::pi;
  const Vec3 at(0.0, 3.0, 2.0);
  const auto depth = [&](const Vec3& turn, double pitch) {
    const Pose X_WE{rotation(turn) * rotation(Vec3(quarter + pitch, 0, 0)), at};
    const Labels labels = seen.labels({X_WE, {-0.1, 0.1, -0.1, 0.1}, 21, 21});
    return labels.depth[10 * 21 + 10];
  };
  EXPECT_NEAR(depth({0, 0, quarter}, 0.0), 0.5 * room.width, 1e-3);
  EXPECT_NEAR(depth({0, 0, -quarter}, 0.0), 0.5 * room.width, 1e-3);
  EXPECT_NEAR(depth({0, 0, 0}, 0.0), room.ahead - at.y(), 1e-3);
  EXPECT_NEAR(depth({0, 0, 2 * quarter}, 0.0), room.behind + at.y(), 1e-3);
  EXPECT_NEAR(depth({0, 0, 0}, quarter), room.height - at.z(), 1e-3);
  EXPECT_NEAR(depth({0, 0, 0}, -quarter), at.z(), 1e-3);
}

Scenario bundled(const std::string& name) {
  return load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/" + name + ".toml");
}

/// Light of the lamps on the lane's middle, as walls and floors are lit.
double lamp_light(const RoomMeasures& room, double y) {
  double sum = 0.0;
  for (const render::Lamp& lamp : room_lamps(room)) {
    const Vec3 d = lamp.p_W - Vec3(0.0, y, 0.0);
    sum += lamp.power.x() * d.z() / (d.squaredNorm() * d.norm());
  }
  return sum;
}

// Three lamps over a lane of 18 m gave 0.69 of the light at the foul line of the paper's room.
TEST(Looks, LightALongLaneAsTheyDoAShortOne) {
  const RoomMeasures paper = room_measures({});
  const double there = lamp_light(paper, 0.0);
  for (const char* name : {"regulation-ten-pin", "german-ninepins", "english-skittles"}) {
    const RoomMeasures room = room_measures(bundled(name));
    EXPECT_NEAR(lamp_light(room, 0.0) / there, 1.0, 0.1) << name;
    for (double y = 0.0; y < room.head_pin - 3.0; y += 0.1) {  // then its own lamp adds to them
      EXPECT_NEAR(lamp_light(room, y) / there, 1.0, 0.35) << name << " " << y;
    }
  }
  Scenario hall;
  hall.room.ahead = 60.0;  // as bright, with the lamps there are, farther apart
  double sum = 0.0;
  for (double y = 0.0; y < 50.0; y += 0.1) sum += lamp_light(room_measures(hall), y) / 500.0;
  EXPECT_NEAR(sum / there, 1.0, 0.3);
}

/// All the light of a picture.
double light_of(const Image& image) {
  double sum = 0.0;
  for (const std::uint8_t code : image.rgb) sum += render::light_of_codes().at(code);
  return sum / render::kFullLight;
}

/// A few pixels of a view around a point, drawn finer; the whole view as it is.
View around(const View& view, const Vec3& p_W, int finer) {
  if (finer == 1) return view;
  constexpr int kReach = 16;
  const Vec2 at = project(view, p_W);
  const double x = std::floor(at.x()) - kReach, y = std::floor(at.y()) - kReach;
  const render::Frustum& f = view.frustum;
  const double wide = (f.right - f.left) / view.width, high = (f.top - f.bottom) / view.height;
  View part = view;
  part.frustum.left = f.left + x * wide;
  part.frustum.right = part.frustum.left + 2 * kReach * wide;
  part.frustum.top = f.top - y * high;
  part.frustum.bottom = part.frustum.top - 2 * kReach * high;
  part.width = part.height = 2 * kReach * finer;
  return part;
}

/// How far the light that a lone skittle at 18 m adds to the picture differs between the eyes, as a
/// share of it: rms over places a fraction of a pixel apart.
double between_the_eyes_at_18_m(const render::Quality& look, int finer) {
  const Stage stage = make_stage(bundled("regulation-ten-pin"));
  render::Renderer renderer(render::osmesa_context(), look);
  const Looks looks(renderer, stage);
  const Pose skittle{Quat::Identity(), Vec3(0.0, 18.288, stage.skittle_centre)};
  Glimpse glimpse{.skittle_centre = stage.skittle_centre};
  double squares = 0.0;
  constexpr int kPlaces = 24;
  for (int i = 0; i < kPlaces; ++i) {
    const Pose X_WD{rotation(Vec3(0.5 * std::numbers::pi - 0.05, 0, 0)),
                    Vec3(-0.3 + 0.0173 * i, 0.0, 1.65)};
    std::array<double, 2> light{};
    std::size_t eye = 0;
    for (const View& whole : render::eyes(X_WD, {})) {
      const View view = around(whole, skittle.p, finer);
      std::array<Image, 1> with, without;
      glimpse.X_WB_skittles = {skittle};
      renderer.draw(draw_list(looks, glimpse), {&view, 1}, with);
      glimpse.X_WB_skittles.clear();
      renderer.draw(draw_list(looks, glimpse), {&view, 1}, without);
      light.at(eye++) = light_of(with[0]) - light_of(without[0]);
    }
    const double off = 2.0 * (light[0] - light[1]) / (light[0] + light[1]);
    squares += off * off;
  }
  return std::sqrt(squares / kPlaces);
}

// It is 1.6 pixels wide there. Five samples a pixel leave 0.075, one leaves 0.30; what is so small is
// drawn again with up to 65 and leaves 0.024; drawn eight times as fine, highlights and all, 0.008.
TEST(Looks, ShowASkittleAt18MetresAlikeToBothEyes) {
  const render::Quality five{.contact = false, .mirror = false};
  render::Quality one = five;
  one.samples = 1;
  const double standard = between_the_eyes_at_18_m(five, 1);
  EXPECT_LT(standard, 0.03);
  EXPECT_LT(between_the_eyes_at_18_m(one, 8), 0.015);
}

TEST(Looks, ShowTheButtonsWhereTheHandFindsThem) {
  Scenario scenario;
  scenario.version.buttons = true;
  scenario.version.red.button = Vec3(-0.3, 1.0, 1.2);
  scenario.version.blue.button = Vec3(0.3, 1.0, 1.2);
  render::Renderer renderer{render::osmesa_context()};
  const Looks looks{renderer, make_stage(scenario)};
  const auto views =
      render::eyes({rotation(Vec3(0.5 * std::numbers::pi - 0.15, 0, 0)), Vec3(0, -0.5, 1.65)}, {});
  std::array<Image, 2> images;
  renderer.draw(draw_list(looks, {}), views, images);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Labels labels = renderer.labels(draw_list(looks, {}), views[eye]);
    for (const auto& [p, strongest] :
         {std::pair{scenario.version.red.button, 0}, std::pair{scenario.version.blue.button, 2}}) {
      const Vec2 at = project(views[eye], p);
      const auto pixel = static_cast<std::size_t>(static_cast<int>(at.y()) * labels.width +
                                                  static_cast<int>(at.x()));
      EXPECT_EQ(labels.id[pixel], kButtonId);
      const std::uint8_t* rgb = &images[eye].rgb[3 * pixel];
      EXPECT_EQ(std::max_element(rgb, rgb + 3) - rgb, strongest);
    }
  }
  EXPECT_EQ(mask(Seen().labels(views[0]), kButtonId).count, 0);
}

/// How wide a skittle is seen at heights above its base [m], from 1 m before its axis, at the silhouette
/// of a body of revolution: a tangent cone's, so a little less than twice its radius.
std::vector<double> widths_seen(const Scenario& scenario) {
  Seen seen(scenario);
  seen.skittles.resize(1);
  seen.skittles[0].p = Vec3(0.0, 3.0, seen.stage.skittle_centre);
  constexpr int kPixels = 800;
  constexpr double kHalf = 0.2;  // of the picture, at the axis [m]
  const View view{{rotation(Vec3(0.5 * std::numbers::pi, 0, 0)), Vec3(0.0, -7.0, 0.19)},
                  {-0.1 * kHalf, 0.1 * kHalf, -0.1 * kHalf, 0.1 * kHalf},
                  kPixels,
                  kPixels};
  const Labels labels = seen.labels(view);
  std::vector<double> widths;
  for (int y = 0; y < kPixels; ++y) {
    const auto row = labels.id.begin() + std::ptrdiff_t{kPixels} * y;
    const auto count = std::count(row, row + kPixels, kFirstSkittleId);
    widths.push_back(static_cast<double>(count) * 2.0 * kHalf / kPixels);
  }
  return widths;
}

// From 10 m a silhouette is as wide as the widest part at its height, to a pixel of 0.5 mm and the
// tangent's 0.05 mm.
TEST(Looks, ShowTheCollidersWhenAsked) {
  Scenario scenario;
  scenario.skittle.seen = SeenSkittle::collider;
  scenario.skittle.parts = {
      {.shape = PartShape::cylinder, .radius = 0.05, .low = 0.0, .high = 0.1},
      {.shape = PartShape::cone, .radius = 0.06, .low = 0.1, .high = 0.381},
      {.shape = PartShape::ellipsoid, .radius = 0.03, .low = 0.28, .high = 0.381}};
  const auto expected = [](double z) {
    if (z < 0.0 || z > 0.381) return 0.0;
    if (z < 0.1) return 0.1;
    const double up = (2.0 * z - 0.28 - 0.381) / 0.101;
    const double ball = std::abs(up) < 1.0 ? 0.06 * std::sqrt(1.0 - up * up) : 0.0;
    return std::max(0.12 * (0.381 - z) / 0.281, ball);
  };
  const std::vector<double> widths = widths_seen(scenario);
  int compared = 0;
  for (std::size_t y = 0; y < widths.size(); ++y) {
    const double z = 0.19 + 0.2 - 0.4 * (static_cast<double>(y) + 0.5) / 800.0;
    const bool at_a_step = std::abs(z) < 0.002 || std::abs(z - 0.1) < 0.002 || z > 0.36;
    if (at_a_step) continue;
    EXPECT_NEAR(widths[y], expected(z), 0.0025) << z;
    ++compared;
  }
  EXPECT_GT(compared, 600);
}

TEST(Looks, TellNothingOfTheCollidersUnlessAsked) {
  Scenario scenario;
  scenario.collision.shape = SkittleShape::ellipsoid;
  EXPECT_FALSE(glimpse(make_session(scenario), {}).ellipsoids);
  scenario.skittle.seen = SeenSkittle::collider;
  EXPECT_TRUE(glimpse(make_session(scenario), {}).ellipsoids);
  scenario.collision.shape = SkittleShape::parts;
  EXPECT_FALSE(glimpse(make_session(scenario), {}).ellipsoids);
}

// A version whose skittles are ellipsoids, and weighed as such, has their centre higher; they look as
// before.
TEST(Looks, ShowSkittlesOfAnotherVersionWhereTheyStand) {
  Seen seen;
  const View view = seen.views()[0];
  const Mask before = mask(seen.labels(view), kFirstSkittleId);
  Scenario other = seen.scenario;
  other.collision.shape = SkittleShape::ellipsoid;
  other.skittle.ellipsoid_weighed = WeighedEllipsoid::itself;
  const Stage version = make_stage(other);
  ASSERT_GT(version.skittle_centre, seen.stage.skittle_centre + 0.03);
  for (Pose& X_WB : seen.skittles) X_WB.p.z() = version.skittle_centre;
  seen.glimpse.skittle_centre = version.skittle_centre;
  const Mask after = mask(seen.labels(view), kFirstSkittleId);
  EXPECT_EQ(after.count, before.count);
  EXPECT_EQ(after.lo, before.lo);
  EXPECT_EQ(after.hi, before.hi);
  EXPECT_EQ(glimpse(make_session(other), {}).skittle_centre, version.skittle_centre);
}

TEST(Looks, HideWhatTheHandIsInFrontOfInBothEyes) {
  Seen seen;
  seen.balls[0].p = Vec3(0.0, 0.5, 1.45);
  seen.glimpse.X_WH = Pose{rotation(Vec3(0.5 * std::numbers::pi, 0, 0)), Vec3(0.0, 0.1, 1.5)};
  for (const View& view : seen.views()) {
    const Labels labels = seen.labels(view);
    const Vec2 hand = project(view, seen.glimpse.X_WH->p);
    const auto at = static_cast<std::size_t>(static_cast<int>(hand.y()) * labels.width +
                                             static_cast<int>(hand.x()));
    EXPECT_EQ(labels.id[at], kHandId);
    EXPECT_LT(labels.depth[at], 0.65);
    EXPECT_GT(mask(labels, kFirstBallId).count, 50);
  }
}

TEST(Looks, PutTheBallInTheHandThatGripsIt) {
  Seen seen;
  const Pose X_WH{rotation(Vec3(0.5 * std::numbers::pi, 0, 0)), Vec3(0.1, 0.2, 1.4)};
  seen.glimpse.X_WH = X_WH;
  seen.glimpse.closed = 1.0;
  seen.balls[0] = {X_WH.q, X_WH * seen.scenario.hand.grip};
  const Labels labels = seen.labels(seen.views()[0]);
  EXPECT_GT(mask(labels, kFirstBallId).count, 300);
  EXPECT_GT(mask(labels, kHandId).count, 300);
}

const Vec3 kGrip(0.0, -0.03, -0.115);
constexpr double kBall = 0.1085;

// A hand may touch the ball but not fill it, except with three fingers where that has its holes.
TEST(HandMesh, AroundTheBallIsInItAtTheHolesOnly) {
  const auto holes = ball_holes(kGrip, kBall);
  const render::Mesh hand = hand_mesh(kGrip, kBall, 1.0);
  const double degree = std::numbers::pi / 180.0;
  const Quat q_HB = (rotation(Vec3(0, 0, -40 * degree)) * rotation(Vec3(28 * degree, 0, 0)) *
                     rotation(Vec3(0, 0, 180 * degree)))
                        .conjugate();
  std::array<double, 3> deepest{};
  double nearest = 1.0;
  for (const render::Vertex& v : hand.vertices) {
    const Vec3 p = v.p.cast<double>() - kGrip;
    std::array<double, 3> aside{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 axis = q_HB * holes[i];
      aside[i] = (p - p.dot(axis) * axis).norm();
      if (p.dot(axis) > 0.0 && aside[i] < 0.115 * kBall) {
        deepest[i] = std::max(deepest[i], kBall - p.norm());
      }
    }
    if (std::ranges::min(aside) > 0.02) nearest = std::min(nearest, p.norm());
  }
  EXPECT_GT(nearest, kBall - 0.012);  // half a finger sinks in
  EXPECT_LT(nearest, kBall + 0.005);
  for (const double deep : deepest) EXPECT_GT(deep, 0.025);
}

// Whole and closed: what it is made of has the triangles that are allowed, no hole and no inside out.
TEST(HandMesh, HasAtMost1000TrianglesThatLookOutwardAllTheWayFromOpenToClosed) {
  for (int i = 0; i <= 6; ++i) {
    const render::Mesh hand = hand_mesh(kGrip, kBall, i / 6.0);
    EXPECT_LE(hand.indices.size() / 3, 1000u);
    int outward = 0, inward = 0;
    for (std::size_t k = 0; k < hand.indices.size(); k += 3) {
      const auto corner = [&](std::size_t j) -> const render::Vertex& {
        return hand.vertices[hand.indices[k + j]];
      };
      const Eigen::Vector3f n = (corner(1).p - corner(0).p).cross(corner(2).p - corner(0).p);
      const float along = n.dot(corner(0).n + corner(1).n + corner(2).n);
      if (n.norm() < 1e-7F) continue;
      (along > 0.0F ? outward : inward) += 1;
    }
    EXPECT_LT(inward, outward / 15) << i;  // folds where fingers and palm meet
  }
}

/// Volume by the divergence theorem.
double volume(const render::Mesh& mesh) {
  double sum = 0.0;
  const auto corner = [&](std::size_t i) -> Vec3 {
    return mesh.vertices[mesh.indices[i]].p.cast<double>();
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    sum += corner(i).dot(corner(i + 1).cross(corner(i + 2))) / 6.0;
  }
  return sum;
}

// bowling.md: 2.105 litres for the profile of a ten-pin, whose head is a ball; an ellipse from the
// widest place of the head takes 0.3 % less.
TEST(SkittleMesh, HasTheVolumeOfATenPin) {
  const Outline outline = smooth_outline(Scenario().skittle.profile);
  EXPECT_NEAR(volume(skittle_mesh(outline, 0.1474, 100, 100)), 2.105e-3, 0.015e-3);
}

TEST(SkittleMesh, StandsOnItsBaseAndIsAsTallAndWideAsItsProfile) {
  const Scenario scenario;
  const render::Mesh mesh = skittle_mesh(smooth_outline(scenario.skittle.profile), 0.1474, 26, 18);
  Eigen::Vector3f lo = mesh.vertices[0].p, hi = lo;
  for (const render::Vertex& v : mesh.vertices) {
    lo = lo.cwiseMin(v.p);
    hi = hi.cwiseMax(v.p);
  }
  EXPECT_NEAR(lo.z(), -0.1474, 1e-6);
  EXPECT_NEAR(hi.z(), 0.381 - 0.1474, 1e-6);
  EXPECT_NEAR(hi.x(), 0.0605, 0.0003);  // a ring need not lie on the very belly
}

TEST(SkittleMesh, OfAnEllipsoidHasItsVolume) {
  const render::Mesh mesh = skittle_mesh(ellipsoid_outline(0.38, 0.06), 0.19, 80, 80);
  const double expected = 4.0 / 3.0 * std::numbers::pi * 0.06 * 0.06 * 0.19;
  EXPECT_NEAR(volume(mesh), expected, 0.005 * expected);
}

TEST(SmoothOutline, GoesThroughItsPointsAndDoesNotSwingOutBetweenThem) {
  const std::vector<Vec2> profile = Scenario().skittle.profile;
  const Outline outline = smooth_outline(profile);
  for (const Vec2& point : profile) {
    const double nearest = (*std::min_element(outline.begin(), outline.end(),
                                              [&](const Vec2& a, const Vec2& b) {
                                                return (a - point).norm() < (b - point).norm();
                                              }) -
                            point)
                               .norm();
    EXPECT_LT(nearest, 1e-9);
  }
  for (std::size_t i = 1; i < outline.size(); ++i) {
    EXPECT_GE(outline[i].x(), outline[i - 1].x() - 1e-12);
    EXPECT_LE(outline[i].y(), 0.0608);
  }
}

TEST(SmoothOutline, RefusesAProfileThatDoesNotRise) {
  const std::vector<Vec2> back{{0.0, 0.1}, {0.2, 0.1}, {0.1, 0.1}};
  EXPECT_THROW(smooth_outline(back), std::invalid_argument);
  EXPECT_THROW(smooth_outline(std::span(back).first(2)), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::scene
