#include "scene/looks/looks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/base/sample.h"
#include "scene/looks/hand_mesh.h"
#include "scene/looks/room_mesh.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/stage/seen_mesh.h"

namespace headpin::scene {

namespace {

using render::DrawItem;
using render::DrawList;
using render::Occluder;

/// Resolution of a skittle's mesh.
struct Detail {
  int rings, sides;
};
constexpr Detail kNear{26, 18}, kFar{14, 18}, kFaint{9, 8};

constexpr int kHands = 7;  // number of hand meshes, from open to closed

/// Three balls on the axis that approximate a body of revolution, for occlusion.
std::vector<Occluder> occluders_of(const Outline& outline, double origin) {
  std::vector<Occluder> balls;
  const double height = outline.back().x();
  for (const double share : {0.08, 0.3, 0.88}) {
    const auto at = std::find_if(outline.begin(), outline.end(),
                                 [&](const Vec2& p) { return p.x() >= share * height; });
    balls.push_back({Vec3(0.0, 0.0, at->x() - origin), at->y()});
  }
  return balls;
}

/// A head in a helmet, in the frame of its display: x right, y up, looking along -z.
render::Mesh head_mesh() {
  const Pose upright{rotation(Vec3(-0.5 * std::numbers::pi, 0.0, 0.0)), Vec3(0.0, 0.0, 0.09)};
  render::Mesh head;
  head.gloss = 0.2;
  append(head,
         render::ellipsoid(0.09, 0.125, 24, 16,
                           [](double z) { return render::srgb(z < 0.0 ? 0xc89878 : 0x303236); }),
         upright);
  append(head, render::box(Vec3(0.17, 0.09, 0.10), render::srgb(0x1b1c20)),
         {Quat::Identity(), Vec3(0.0, 0.0, -0.02)});
  return head;
}

/// The mesh of a skittle that covers a few pixels: lit at its vertices, and scaled to the mean
/// width of a round one.
render::Mesh far_skittle_mesh(const Outline& outline, double origin, Detail detail) {
  render::Mesh mesh = skittle_mesh(outline, origin, detail.rings, detail.sides);
  mesh.fine_light = false;
  const double half = std::numbers::pi / detail.sides;
  const auto wider = static_cast<float>(half / std::sin(half));
  for (render::Vertex& v : mesh.vertices) v.p.head<2>() *= wider;
  return mesh;
}

BodyMeshes skittle_meshes(const MeshKeeper& keeper, const Outline& outline, double origin) {
  return {keeper.add(skittle_mesh(outline, origin, kNear.rings, kNear.sides)),
          keeper.add(far_skittle_mesh(outline, origin, kFar)),
          keeper.add(far_skittle_mesh(outline, origin, kFaint))};
}

TurnedPart turned_part(const SkittlePart& part) {
  const double low = part.low, high = part.high, r = part.radius;
  if (part.shape == PartShape::cylinder) return {low, high, [r](double) { return r; }};
  if (part.shape == PartShape::cone) {
    return {low, high, [=](double z) { return r * (high - z) / (high - low); }};
  }
  return {low, high, [=](double z) {
            const double up = (2.0 * z - low - high) / (high - low);
            return r * std::sqrt(std::max(0.0, 1.0 - up * up));
          }};
}

render::Mesh faces_of(const SkittlePart& part, double origin) {
  const Vec3 white = render::srgb(0xf4f1e6);
  render::Mesh mesh;
  for (const std::vector<std::uint32_t>& face : part.faces) {
    const auto corner = [&](std::size_t i) {
      return Vec3(part.corners[face[i]] - Vec3(0.0, 0.0, origin));
    };
    Vec3 area = Vec3::Zero();  // of all corners: the first three may be in line
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      area += (corner(i) - corner(0)).cross(corner(i + 1) - corner(0));
    }
    const Vec3 n = area.normalized();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::size_t i = 0; i < face.size(); ++i) {
      mesh.vertices.push_back({corner(i).cast<float>(), n.cast<float>(), white.cast<float>()});
    }
    for (std::uint32_t i = 1; i + 1 < face.size(); ++i) {
      mesh.indices.insert(mesh.indices.end(), {first, first + i, first + i + 1});
    }
  }
  return mesh;
}

/// The meshes of a skittle's collision shape: its parts.
BodyMeshes collider_meshes(const MeshKeeper& keeper, const Skittle& skittle, double origin) {
  std::vector<TurnedPart> turned;
  render::Mesh solid;
  solid.gloss = 0.5;
  for (const SkittlePart& part : skittle.parts) {
    if (part.shape == PartShape::polyhedron) {
      append(solid, faces_of(part, origin));
    } else {
      turned.push_back(turned_part(part));
    }
  }
  render::Mesh far = solid;
  if (!turned.empty()) {
    const Outline outline = outline_of_parts(turned);
    append(solid, edged_skittle_mesh(outline, origin, 0.0003, 32));
    append(far, edged_skittle_mesh(outline, origin, 0.002, 12));
  }
  return {keeper.add(solid), keeper.add(far)};
}

render::Mesh moved(const render::Mesh& mesh, const Pose& X_GP) {
  render::Mesh all;
  all.gloss = mesh.gloss;
  append(all, mesh, X_GP);
  return all;
}

/// Whether the hand that is drawn is a left one. Who played a trial of rules 1 to 9 with the left hand saw a
/// right one, and so does who looks at it.
bool shows_left_hand(const Scenario& scenario) {
  return scenario.rig.hand_station == devices::kLeftHandStation && scenario.collision.rules >= 10;
}

void append_occluders(DrawList& list, const std::vector<Occluder>& of_body, const Pose& X_WB) {
  for (const Occluder& ball : of_body) list.occluders.push_back({X_WB * ball.p_W, ball.radius});
}

}  // namespace

Looks::Looks(const MeshKeeper& keeper, const Stage& stage)
    : ball_radius(stage.scenario.ball.radius), centres(drawn_centres(stage)) {
  const Scenario& scenario = stage.scenario;
  add_skittle(keeper, stage);
  if (const auto own = seen_mesh(scenario.ball.mesh, render::srgb(0x123a8c), 0.9)) {
    ball = {keeper.add(*own)};
  } else {
    const auto holes = ball_holes(scenario.hand.grip, ball_radius, shows_left_hand(scenario));
    ball = {keeper.add(ball_mesh(ball_radius, holes)),
            keeper.add(ball_mesh(ball_radius, holes, 20, 12)),
            keeper.add(ball_mesh(ball_radius, {}, 14, 8))};
  }
  if (scenario.ball.rings) oil_ring = keeper.add(oil_ring_mesh());
  add_hands(keeper, scenario);
  head = keeper.add(head_mesh());
  add_room(keeper, scenario);

  for (const engine::BodyId one : stage.balls) {
    const Vec3 home = stage.world.states[one].X_WB.p;
    const double rim = home.z() - 0.78 * ball_radius;  // the ball lies in the stand's ring
    DrawItem stand;
    stand.mesh = keeper.add(stand_mesh(rim, ball_radius));
    stand.X_WG.p = Vec3(home.x(), home.y(), 0.0);
    stand.id = kStandId;
    stand.casts_shadow = true;
    stand.mirrored = true;
    room.items.push_back(stand);
    room.occluders.push_back({Vec3(home.x(), home.y(), 0.06), 0.13});
  }

  if (scenario.version.buttons) add_buttons(keeper, scenario.version);
  if (scenario.game.show_score) add_board(keeper, stage.room);
}

void Looks::add_skittle(const MeshKeeper& keeper, const Stage& stage) {
  const Skittle& skittle = stage.scenario.skittle;
  const Outline outline = smooth_outline(skittle.profile);
  double widest = 0.0;
  for (const SkittlePart& part : skittle.parts) widest = std::max(widest, part.radius);
  const double height = skittle.height;
  const Outline ellipsoid = ellipsoid_outline(height, widest);
  if (skittle.seen == SeenSkittle::collider) {
    true_skittle = collider_meshes(keeper, skittle, stage.skittle_centre);
  } else if (const auto own = seen_mesh(skittle.mesh, render::srgb(0xf4f1e6), 0.5)) {
    true_skittle = {
        keeper.add(moved(*own, {Quat::Identity(), Vec3(0.0, 0.0, -stage.skittle_centre)}))};
  } else {
    true_skittle = skittle_meshes(keeper, outline, stage.skittle_centre);
  }
  ellipsoid_skittle = skittle_meshes(keeper, ellipsoid, 0.5 * height);
  true_occluders = occluders_of(outline, stage.skittle_centre);
  ellipsoid_occluders = occluders_of(ellipsoid, 0.5 * height);
}

void Looks::add_hands(const MeshKeeper& keeper, const Scenario& scenario) {
  const Hand& hand = scenario.hand;
  // The hand's own frame has y up and looks along -z; a file stands upright in the world.
  if (const auto own = seen_mesh(hand.mesh, render::srgb(0xd9a27e), 0.12)) {
    hands = {
        keeper.add(moved(*own, {rotation(Vec3(-0.5 * std::numbers::pi, 0.0, 0.0)), Vec3::Zero()}))};
    return;
  }
  for (int i = 0; i < kHands; ++i) {
    const double closed = static_cast<double>(i) / (kHands - 1);
    hands.push_back(
        keeper.add(hand_mesh(hand.grip, ball_radius, closed, shows_left_hand(scenario))));
  }
}

std::size_t hand_at(double closed, std::size_t hands) {
  return static_cast<std::size_t>(std::lround(closed * static_cast<double>(hands - 1)));
}

namespace {}  // namespace

/// Adds the objects that never move, and the light.
void Looks::add_room(const MeshKeeper& keeper, const Scenario& scenario) {
  const RoomMeasures measures = room_measures(scenario);
  const RoomMeshes meshes = room_meshes(measures);
  const auto still = [&](const render::Mesh& mesh, bool mirrored) {
    DrawItem item;
    item.mesh = keeper.add(mesh);
    item.id = kRoomId;
    item.mirrored = mirrored;
    room.items.push_back(item);
  };
  still(meshes.lane, false);
  if (!meshes.oil.indices.empty()) still(meshes.oil, false);
  still(meshes.approach, false);
  still(meshes.beside, false);
  still(meshes.front, true);
  const std::optional<render::Mesh> own = seen_mesh(scenario.room.mesh, Vec3::Constant(0.5), 0.0);
  still(own ? *own : meshes.walls, false);
  if (own) room_reach = render::reach_of(*own);

  room.lamps = room_lamps(measures);
  room.sky = room_ambient().sky;
  room.ground = room_ambient().ground;
  room.background = Vec3(0.16, 0.15, 0.13);
  room.patches = floor_patches(measures);
  const double wall = 0.5 * measures.width;
  room.shadow = {Vec3(0.22, -0.30, 1.0).normalized(),
                 Vec3(-wall, -measures.behind, -measures.gutter_depth),
                 Vec3(wall, measures.ahead, measures.height), 0.38};
}

void Looks::add_buttons(const MeshKeeper& keeper, const Versions& versions) {
  const double r = versions.radius;
  const auto add = [&](const render::Mesh& mesh, const Vec3& p_WG) {
    DrawItem item;
    item.mesh = keeper.add(mesh);
    item.X_WG.p = p_WG;
    item.id = kButtonId;
    item.casts_shadow = true;
    item.mirrored = true;
    room.items.push_back(item);
  };
  for (const auto& [p, colour] :
       {std::pair{versions.red.button, 0xb3202au}, std::pair{versions.blue.button, 0x2046b3u}}) {
    const auto inside = [r](const Vec3& q) { return q.norm() - r; };
    const Vec3 corner = Vec3::Constant(1.2 * r);
    add(render::surface_of(inside, -corner, corner, 0.2 * r, render::srgb(colour)), p);
    add(stand_mesh(p.z() - 0.78 * r, r), Vec3(p.x(), p.y(), 0.0));
  }
}

void Looks::add_board(const MeshKeeper& keeper, const RoomMeasures& measures) {
  board = BoardLooks{board_measures(measures), {}};
  for (const char character : board_characters()) {
    board->meshes[character] = keeper.add(character_mesh(character, board->measures.dot));
  }
  DrawItem item;
  item.mesh = keeper.add(board_mesh(board->measures));
  item.id = kBoardId;
  item.mirrored = true;
  room.items.push_back(item);
}

std::vector<BoardCharacter> BoardLooks::characters(std::span<const std::string> text) const {
  std::vector<BoardCharacter> all;
  for (std::size_t row = 0; row < text.size(); ++row) {
    for (std::size_t column = 0; column < text[row].size(); ++column) {
      const auto mesh = meshes.find(text[row][column]);
      if (mesh != meshes.end()) all.push_back({mesh->second, measures.cell(row, column)});
    }
  }
  return all;
}

namespace {

void append_board(DrawList& list, const Looks& looks, const Glimpse& g) {
  if (!looks.board) return;
  for (const BoardCharacter& character : looks.board->characters(g.board)) {
    DrawItem item;
    item.mesh = character.mesh;
    item.X_WG.p = character.p_WG;
    item.id = kBoardId;
    item.mirrored = true;
    list.items.push_back(item);
  }
}

/// The rings of oil on a ball.
void append_rings(DrawList& list, const Looks& looks, const Glimpse& g) {
  if (!looks.oil_ring || g.ringed >= g.X_WB_balls.size()) return;
  const Pose& X_WB = g.X_WB_balls[g.ringed];
  for (const Pose& X_BG : g.X_BG_rings) {
    const double across = ring_radius(looks.ball_radius, X_BG);
    DrawItem item;
    item.mesh = *looks.oil_ring;
    item.X_WG = X_WB * X_BG;
    item.scale = Vec3(across, across, 1.0);
    item.id = kFirstBallId + static_cast<std::uint32_t>(g.ringed);
    item.mirrored = true;
    list.items.push_back(item);
  }
}

}  // namespace

DrawnCentres drawn_centres(const Scenario& scenario, double centre) {
  DrawnCentres centres{.true_skittle = centre};
  if (scenario.collision.rules >= 13) centres.ellipsoid = 0.5 * scenario.skittle.height;
  return centres;
}

DrawnCentres drawn_centres(const Stage& stage) {
  return drawn_centres(stage.scenario, stage.skittle_centre);
}

SkittleLook skittle_look(bool ellipsoid, double centre, const DrawnCentres& drawn) {
  const double mesh = ellipsoid ? drawn.ellipsoid.value_or(centre) : drawn.true_skittle;
  return {ellipsoid, mesh - centre};
}

SkittleLook skittle_look(const Stage& stage, const DrawnCentres& drawn) {
  return skittle_look(shows_ellipsoids(stage.scenario), stage.skittle_centre, drawn);
}

DrawList draw_list(const Looks& looks, const Glimpse& g) {
  DrawList list = looks.room;
  const auto add = [&](const BodyMeshes& meshes, const Pose& X_WG, std::uint32_t id) {
    DrawItem item;
    item.mesh = meshes.mesh;
    item.far_mesh = meshes.far_mesh;
    item.faint_mesh = meshes.faint_mesh;
    item.X_WG = X_WG;
    item.id = id;
    item.casts_shadow = true;
    item.mirrored = true;
    list.items.push_back(item);
  };
  std::uint32_t skittle = kFirstSkittleId, ball = kFirstBallId;
  const double raised = skittle_look(g.ellipsoids, g.skittle_centre, looks.centres).raised;
  for (Pose X_WB : g.X_WB_skittles) {
    if (raised != 0.0) X_WB.p = X_WB * Vec3(0.0, 0.0, raised);
    add(g.ellipsoids ? looks.ellipsoid_skittle : looks.true_skittle, X_WB, skittle++);
    append_occluders(list, g.ellipsoids ? looks.ellipsoid_occluders : looks.true_occluders, X_WB);
  }
  for (const Pose& X_WB : g.X_WB_balls) {
    add(looks.ball, X_WB, ball++);
    list.occluders.push_back({X_WB.p, looks.ball_radius});
  }
  append_rings(list, looks, g);
  append_board(list, looks, g);
  if (g.X_WH) {
    add({looks.hands[hand_at(g.closed, looks.hands.size())]}, *g.X_WH, kHandId);
    list.occluders.push_back({g.X_WH->p, 0.05});
  }
  if (g.X_WC) add({looks.head}, g.X_WD, kHeadId);
  return list;
}

std::map<std::uint32_t, std::string> object_names(const Stage& stage) {
  std::map<std::uint32_t, std::string> names = {{kRoomId, "room"},   {kHandId, "hand"},
                                                {kStandId, "stand"}, {kButtonId, "button"},
                                                {kHeadId, "head"},   {kBoardId, "score board"}};
  const auto add = [&](const std::vector<engine::BodyId>& bodies, std::uint32_t id) {
    for (const engine::BodyId body : bodies) names[id++] = stage.world.bodies[body].name;
  };
  add(stage.balls, kFirstBallId);
  add(stage.skittles, kFirstSkittleId);
  return names;
}

}  // namespace headpin::scene
