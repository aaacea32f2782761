#include "scene/looks/room_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <tuple>

namespace headpin::scene {

namespace {

using render::Lamp;
using render::Mesh;
using render::Patch;
using render::Ring;
using render::srgb;
using render::Surface;

constexpr double kCell = 0.25;  // distance of points with computed light on walls [m]
constexpr double kLap = 2e-5;   // of the room's length: panels reach under their neighbours by it
constexpr double kStraight = 0.015;  // of the light: less than an 8-bit step of it is seen

/// A number in -1..1 that looks random and is always the same.
double speckle(int a, int b) {
  auto h =
      static_cast<std::uint32_t>(a) * 0x9e3779b1u ^ static_cast<std::uint32_t>(b) * 0x85ebca77u;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return static_cast<double>(h ^ h >> 15) / 2147483647.5 - 1.0;
}

/// Puts light on surfaces as it makes them.
class Builder {
 public:
  explicit Builder(const RoomMeasures& room) : room_(room), lamps_(room_lamps(room)) {}

  /// Light that falls on a point of a wall with normal n, darker towards corners.
  Vec3 light(const Vec3& p, const Vec3& n) const {
    const auto [sky, ground] = room_ambient();
    double open = 1.0;
    const double to_walls[] = {0.5 * room_.width - std::abs(p.x()), room_.ahead - p.y(),
                               p.y() + room_.behind, p.z(), room_.height - p.z()};
    const int axes[] = {0, 1, 1, 2, 2};
    for (int i = 0; i < 5; ++i) {
      if (std::abs(n[axes[i]]) < 0.5)
        open *= 1.0 - 0.32 * std::exp(-std::max(to_walls[i], 0.0) / 0.3);
    }
    Vec3 sum = open * (ground + (0.5 + 0.5 * n.z()) * (sky - ground));
    for (const Lamp& lamp : lamps_) {
      const Vec3 d = lamp.p_W - p;
      sum += std::max(n.dot(d), 0.0) / (d.squaredNorm() * d.norm()) * lamp.power;
    }
    return sum;
  }

  /// A rectangle with corner `a` and sides u, v, seen from where u x v points. It has vertices
  /// where the change of the light bends; between vertices the light is linear. The rectangle is a
  /// little larger, because an edge that its neighbour divides in another way would have pinholes.
  void panel(Mesh& mesh, const Vec3& a, const Vec3& u, const Vec3& v, const Vec3& albedo,
             double cell = kCell) const {
    lapped_panel(mesh, a, u, v, albedo, cell, kLap * (room_.behind + room_.ahead));
  }

  void lapped_panel(Mesh& mesh, Vec3 a, Vec3 u, Vec3 v, const Vec3& albedo, double cell,
                    double lap) const {
    const Vec3 n = u.cross(v).normalized();
    const Vec3 along_u = lap * u.normalized(), along_v = lap * v.normalized();
    a -= along_u + along_v;
    u += 2.0 * along_u;
    v += 2.0 * along_v;
    const std::vector<double> across = bends(a, u, v, n, cell), up = bends(a, v, u, n, cell);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double t : up) {
      for (const double s : across) add_vertex(mesh, a + s * u + t * v, n, albedo);
    }
    const auto row = static_cast<std::uint32_t>(across.size());
    for (std::uint32_t j = 0; j + 1 < static_cast<std::uint32_t>(up.size()); ++j) {
      for (std::uint32_t i = 0; i + 1 < row; ++i) {
        const std::uint32_t k = first + j * row + i;
        for (const std::uint32_t c : {k, k + 1, k + row + 1, k, k + row + 1, k + row}) {
          mesh.indices.push_back(c);
        }
      }
    }
  }

  /// Boards along y from lo to hi, made of planks of about a metre that differ in colour.
  ///
  /// @param put  put(corner, width, end, albedo) adds a plank
  template <typename F>
  void boards(const Vec2& lo, const Vec2& hi, int count, const Vec3& albedo, double contrast,
              int seed, F&& put) const {
    const double width = (hi.x() - lo.x()) / count;
    for (int board = 0; board < count; ++board) {
      const double x = lo.x() + width * board;
      double y = lo.y();
      for (int plank = 0; y < hi.y(); ++plank) {
        const double length = plank == 0 ? 0.75 + 0.55 * speckle(board, seed)
                                         : 1.3 + 0.3 * speckle(board + 64 * plank, seed);
        const double end = hi.y() - y - length < 0.2 ? hi.y() : y + length;
        const double shade = 1.0 + contrast * speckle(board + 64 * plank, seed + 1);
        const double warm = 1.0 + 0.3 * contrast * speckle(board + 64 * plank, seed + 2);
        put(Vec2(x, y), width, end, shade * albedo.cwiseProduct(Vec3(warm, 1.0, 1.0 / warm)));
        y = end;
      }
    }
  }

  void plank(Mesh& mesh, const Vec2& corner, double width, double end, const Vec3& albedo) const {
    panel(mesh, {corner.x(), corner.y(), 0.0}, {width, 0.0, 0.0}, {0.0, end - corner.y(), 0.0},
          albedo, 0.5);
  }

  /// A flat shape on the lane: a fan of corners around the first, seen from above.
  void mark(Mesh& mesh, const std::vector<Vec2>& corners, const Vec3& albedo) const {
    constexpr double kAbove = 0.0005;  // nearer than the boards by many steps of the depth buffer
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec2& c : corners) {
      add_vertex(mesh, {c.x(), c.y(), kAbove}, Vec3::UnitZ(), albedo);
    }
    for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) {
      for (const std::uint32_t c : {first, first + i, first + i + 1}) mesh.indices.push_back(c);
    }
  }

  void dot(Mesh& mesh, const Vec2& at, double radius, const Vec3& albedo) const {
    std::vector<Vec2> corners;
    for (int i = 0; i < 12; ++i) {
      const SinCos turn = sin_cos(std::numbers::pi * i / 6);
      corners.push_back(at + radius * Vec2(turn.cos, turn.sin));
    }
    mark(mesh, corners, albedo);
  }

  /// A box between two corners, without its bottom. Its sides are a little higher than its top, and
  /// its top is not enlarged: otherwise it would show as a line in front of objects that stand on
  /// it.
  void block(Mesh& mesh, const Vec3& lo, const Vec3& hi, const Vec3& albedo,
             const Vec3& top) const {
    const Vec3 s = hi - lo, x(s.x(), 0, 0), y(0, s.y(), 0), z(0, 0, s.z());
    panel(mesh, lo, x, z, albedo);
    panel(mesh, lo + x, y, z, albedo);
    panel(mesh, lo + x + y, -x, z, albedo);
    panel(mesh, lo + y, -y, z, albedo);
    lapped_panel(mesh, lo + z, x, y, top, kCell, 0.0);
  }

 private:
  void add_vertex(Mesh& mesh, const Vec3& p, const Vec3& n, const Vec3& albedo) const {
    const Vec3 colour = albedo.cwiseProduct(light(p, n)).cwiseMin(1.0);
    mesh.vertices.push_back({p.cast<float>(), n.cast<float>(), colour.cast<float>()});
  }

  /// The places along u, from 0 to 1, where a panel needs vertices. Between them, light is linear
  /// to within kStraight, for every place along v.
  std::vector<double> bends(const Vec3& a, const Vec3& u, const Vec3& v, const Vec3& n,
                            double cell) const {
    const int count = std::max(1, static_cast<int>(std::ceil(u.norm() / cell)));
    const int rows = std::max(1, static_cast<int>(std::ceil(v.norm() / cell)));
    const auto share = [&](int i) { return static_cast<double>(i) / count; };
    std::vector<std::vector<Vec3>> light_at;  // [place][row]
    for (int i = 0; i <= count; ++i) {
      light_at.emplace_back();
      for (int j = 0; j <= rows; ++j) {
        light_at.back().push_back(light(a + share(i) * u + v * j / rows, n));
      }
    }
    const auto straight = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from + 1; i < to; ++i) {
        const double part = static_cast<double>(i - from) / static_cast<double>(to - from);
        for (std::size_t j = 0; j < light_at[i].size(); ++j) {
          const Vec3 between = (1.0 - part) * light_at[from][j] + part * light_at[to][j];
          if ((light_at[i][j] - between).norm() > kStraight * light_at[i][j].norm()) return false;
        }
      }
      return true;
    };
    std::vector<double> places{0.0};
    for (std::size_t from = 0; from < static_cast<std::size_t>(count);) {
      std::size_t to = from + 1;
      while (to < static_cast<std::size_t>(count) && straight(from, to + 1)) ++to;
      places.push_back(share(static_cast<int>(to)));
      from = to;
    }
    return places;
  }

  const RoomMeasures& room_;
  std::vector<Lamp> lamps_;
};

const Vec3 kWainscot = srgb(0x8a5a34), kApproach = srgb(0xcfa06a), kLane = srgb(0xe3bd83),
           kCarpet = srgb(0x3d4a63);

/// The word HEADPIN; each letter has seven rows of five squares.
constexpr std::array<std::array<int, 7>, 7> kName{{{0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11},
                                                   {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f},
                                                   {0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11},
                                                   {0x1e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1e},
                                                   {0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10},
                                                   {0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e},
                                                   {0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11}}};

constexpr int kGutterFaces = 6;

/// Corner `i` of the right gutter's section: (x from the lane's middle, z).
Vec2 gutter_point(const RoomMeasures& room, int i) {
  if (room.gutter_depth > 0.0) {  // the collision shape: a slope, the bottom, a slope
    const double x = i < 2 ? 0.5 * room.lane_width + i * room.gutter_slope()
                           : room.gutter_edge() - (3 - i) * room.gutter_slope();
    return {x, i == 1 || i == 2 ? -room.gutter_depth : 0.0};
  }
  const SinCos turn = sin_cos(std::numbers::pi * i / kGutterFaces);
  const double half = 0.5 * room.gutter_width;
  return {0.5 * room.lane_width + half - half * turn.cos, 0.0};
}

int gutter_faces(const RoomMeasures& room) {
  if (room.gutter_width == 0.0) return 0;
  return room.gutter_depth > 0.0 ? 3 : kGutterFaces;
}

Mesh approach_mesh(const RoomMeasures& room, const Builder& build) {
  Mesh mesh;
  mesh.surface = Surface::floor;
  const double w = 0.5 * room.width;
  build.boards({-w, -room.behind}, {w, -0.03}, 60, kApproach, 0.10, 1,
               [&](const Vec2& corner, double width, double end, const Vec3& albedo) {
                 build.plank(mesh, corner, width, end, albedo);
               });
  build.panel(mesh, {-w, -0.03, 0}, {room.width, 0, 0}, {0, 0.03, 0}, srgb(0x1c1a1a));  // foul line
  for (const double y : {-0.12, -1.8}) {
    for (int i = -3; i <= 3; ++i) {
      build.dot(mesh, {room.lane_width * i / 8, y}, 0.016, srgb(0x40260f));
    }
  }
  return mesh;
}

Mesh beside_mesh(const RoomMeasures& room, const Builder& build) {
  Mesh mesh;
  mesh.surface = Surface::floor;
  const double w = 0.5 * room.width, edge = room.gutter_edge();
  const Vec3 along(0, room.ahead, 0);
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < gutter_faces(room); ++i) {
      Vec2 a = gutter_point(room, i), b = gutter_point(room, i + 1);
      if (side < 0.0) std::swap(a, b);
      const Vec3 from(side * a.x(), 0, a.y()), to(side * b.x(), 0, b.y());
      // A flat gutter is also shaded like a channel.
      const double across = (i + 0.5) / gutter_faces(room);
      const double shade = 1.0 - 0.55 * sin_cos(std::numbers::pi * across).sin;
      build.panel(mesh, from, to - from, along, shade * srgb(0x6b6f74), 0.5);
    }
    if (room.gutter_depth > 0.0) {  // its near end, under the foul line
      const double outer = side > 0.0 ? edge : -0.5 * room.lane_width;
      build.panel(mesh, {outer, 0, -room.gutter_depth}, {-room.gutter_width, 0, 0},
                  {0, 0, room.gutter_depth}, srgb(0x2b2d30));
    }
    // A strip of wood along the outer edge.
    const double strip = 0.06, inner = side > 0.0 ? edge : -edge - strip;
    build.panel(mesh, {inner, 0, 0}, {strip, 0, 0}, along, srgb(0xb98248), 0.5);
    const double carpet = side > 0.0 ? edge + strip : -w;
    build.panel(mesh, {carpet, 0, 0}, {w - edge - strip, 0, 0}, along, kCarpet);
  }
  build.panel(mesh, {-0.5 * room.lane_width, room.deck_end, 0}, {room.lane_width, 0, 0},
              {0, room.ahead - room.deck_end, 0}, srgb(0x26282c));
  return mesh;
}

/// A plank of the lane in pieces along it: each with oil or without.
///
/// @param put  put(from, to, oil): the area of the oil, or none
template <typename F>
void each_piece(const RoomMeasures& room, double x, double from, double to, F&& put) {
  while (from < to) {
    const OiledArea* oil = nullptr;
    double end = to;
    for (const OiledArea& area : room.oil) {
      if (x < area.low.x() || x >= area.high.x() || area.high.y() <= from) continue;
      if (area.low.y() <= from) {
        oil = &area;
        end = std::min(to, area.high.y());
        break;
      }
      end = std::min(end, area.low.y());
    }
    put(from, end, oil);
    from = end;
  }
}

/// The wood under oil: darker and colder, the more slippery it is.
Vec3 oiled(const Vec3& albedo, const OiledArea& oil, double dry) {
  const double share = std::clamp(1.0 - oil.friction / std::max(dry, 1e-9), 0.0, 1.0);
  return albedo.cwiseProduct(Vec3(1.0 - 0.34 * share, 1.0 - 0.24 * share, 1.0 - 0.06 * share));
}

/// The lane, and its oil as a mesh of its own.
std::pair<Mesh, Mesh> lane_meshes(const RoomMeasures& room, const Builder& build) {
  Mesh mesh, oil;
  mesh.surface = oil.surface = Surface::floor;
  mesh.gloss = 0.05;
  oil.gloss = 0.22;
  const double w = 0.5 * room.lane_width, board = room.lane_width / kBoards;
  build.boards({-w, 0.0}, {w, room.deck_end}, kBoards, kLane, 0.11, 7,
               [&](const Vec2& corner, double width, double end, const Vec3& albedo) {
                 each_piece(room, corner.x() + 0.5 * width, corner.y(), end,
                            [&](double from, double to, const OiledArea* area) {
                              build.plank(area ? oil : mesh, {corner.x(), from}, width, to,
                                          area ? oiled(albedo, *area, room.dry) : albedo);
                            });
               });
  const Vec3 dark = srgb(0x4a2a12);
  // Seven arrows, five boards apart, the middle one farthest, and ten dots nearer to the player. On
  // a shorter lane, distances are scaled (USBC: arrows 12 to 16 ft from the foul line, of 60 ft).
  const double share = std::max(room.head_pin / 18.288, 0.45);
  for (int i = -3; i <= 3; ++i) {
    const double x = 5 * board * i;
    const double y = share * (4.72 - 0.27 * std::abs(i));
    build.mark(mesh, {{x - 0.016, y}, {x + 0.016, y}, {x, y + 0.15}}, dark);
  }
  for (const int i : {-17, -15, -12, -9, -6, 6, 9, 12, 15, 17}) {
    build.dot(mesh, {board * i, share * 2.2}, 0.0095, dark);
  }
  for (const Vec2& spot : room.spots) {
    build.dot(mesh, {spot.x(), room.head_pin + spot.y()}, 0.0286, srgb(0xa98a60));
  }
  return {mesh, oil};
}

Mesh wall_mesh(const RoomMeasures& room, const Builder& build) {
  Mesh mesh;
  mesh.surface = Surface::baked;
  const double w = 0.5 * room.width, length = room.behind + room.ahead;
  const Vec3 rail = srgb(0xc79a66), cream = srgb(0xefe4cb);
  const double dado = 0.9, cap = 0.06;
  // Each wall starts at its lower left corner, seen from inside the room.
  const std::array<std::pair<Vec3, Vec3>, 3> walls{
      std::pair{Vec3(-w, -room.behind, 0), Vec3(0, length, 0)},
      std::pair{Vec3(w, room.ahead, 0), Vec3(0, -length, 0)},
      std::pair{Vec3(w, -room.behind, 0), Vec3(-room.width, 0, 0)}};
  for (const auto& [corner, along] : walls) {
    const Vec3 up = Vec3::UnitZ();
    const int slats = static_cast<int>(along.norm() / 0.15);
    for (int i = 0; i < slats; ++i) {
      build.panel(mesh, corner + along * i / slats, along / slats, dado * up,
                  kWainscot * (1.0 + 0.10 * speckle(i, 11)), 0.45);
    }
    build.panel(mesh, corner + dado * up, along, cap * up, rail);
    // Stripes in the lower part of the view: their motion shows the player's own speed.
    const std::array<std::pair<double, Vec3>, 5> stripes{
        std::pair{dado + cap, cream}, std::pair{1.32, srgb(0xc9502f)}, std::pair{1.38, cream},
        std::pair{1.42, srgb(0x2d5f9a)}, std::pair{1.48, cream}};
    for (std::size_t i = 0; i < stripes.size(); ++i) {
      const double end = i + 1 < stripes.size() ? stripes[i + 1].first : room.height;
      build.panel(mesh, corner + stripes[i].first * up, along, (end - stripes[i].first) * up,
                  stripes[i].second);
    }
  }
  const Vec3 white = srgb(0xf0ece2);
  build.panel(mesh, {-w, -room.behind, room.height}, {0, length, 0}, {room.width, 0, 0}, white);

  for (const Lamp& lamp : room_lamps(room)) {
    if (lamp.p_W.z() < room.height - 0.2) continue;  // hidden behind the masking panel
    const Vec3 half(0.6, 0.14, 0.0), low = lamp.p_W - half;
    const double z = room.height - 0.012;
    render::append_face(mesh, {low.x(), low.y(), z}, {low.x(), low.y() + 0.28, z},
                        {low.x() + 1.2, low.y() + 0.28, z}, {low.x() + 1.2, low.y(), z},
                        Vec3(1.0, 0.97, 0.88));
  }
  return mesh;
}

/// Bands across the masking panel, and the name above them.
void paint_panel(Mesh& mesh, const Builder& build, const Block& panel) {
  const double width = panel.high_W.x() - panel.low_W.x();
  const double y = panel.low_W.y(), low = panel.low_W.z();
  const std::array<std::uint32_t, 3> bands{0xd9482b, 0xe9a23b, 0xf2e3b6};
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double z = low + 0.06 + 0.05 * static_cast<double>(i);
    build.panel(mesh, {-0.5 * width, y - 0.004, z}, {width, 0, 0}, {0, 0, 0.05}, srgb(bands[i]));
  }
  // The name above them, in squares.
  const double square = 0.9 * width / (6 * kName.size()), top = low + 0.55;
  for (std::size_t letter = 0; letter < kName.size(); ++letter) {
    for (int row = 0; row < 7; ++row) {
      const int squares = kName[letter][static_cast<std::size_t>(row)];
      for (int column = 0, run = 0; column < 5; column += run + 1) {
        for (run = 0; column + run < 5 && (squares >> (4 - column - run) & 1) != 0;) ++run;
        if (run == 0) continue;
        const double x =
            -0.45 * width + square * (6.0 * static_cast<double>(letter) + 0.5 + column);
        build.panel(mesh, {x, y - 0.004, top - square * (row + 1)}, {run * square, 0, 0},
                    {0, 0, square}, srgb(0xf2e3b6));
      }
    }
  }
}

/// The wall behind the skittles, and the objects in front of it.
Mesh front_mesh(const RoomMeasures& room, const Builder& build) {
  Mesh mesh;
  mesh.surface = Surface::baked;
  const double w = 0.5 * room.width;
  const Vec3 blue = srgb(0x2d5f9a), navy = srgb(0x16233f), black = srgb(0x14161b);
  const Vec3 left(-w, room.ahead, 0.0);
  const double low = room.masking_low;
  const double beside =
      w - room.gutter_edge() - 0.1;  // of the wall, left and right of the kick-backs
  // u x v points to the player.
  build.panel(mesh, left, {beside, 0, 0}, {0, 0, low}, kWainscot);
  build.panel(mesh, left + Vec3(beside, 0, 0), {room.width - 2.0 * beside, 0, 0}, {0, 0, low},
              black);
  build.panel(mesh, left + Vec3(room.width - beside, 0, 0), {beside, 0, 0}, {0, 0, low}, kWainscot);
  build.panel(mesh, left + Vec3(0, 0, low), {room.width, 0, 0}, {0, 0, room.height - low}, blue);
  for (const Block& block : front_blocks(room)) {
    const bool hangs = block.low_W.z() > 0.0;
    build.block(mesh, block.low_W, block.high_W, navy, hangs ? navy : srgb(0xc79a66));
    if (hangs) paint_panel(mesh, build, block);
  }
  return mesh;
}

}  // namespace

std::vector<Lamp> room_lamps(const RoomMeasures& room) {
  const Vec3 warm(1.0, 0.94, 0.84);
  const double z = room.height - 0.12;
  // Three lamps in the paper's room of 10.6 m, and the same light per metre in any other room.
  // Their number is limited; lamps that are farther apart are stronger.
  constexpr double kApart = 3.18, kPower = 2.3, kInset = 0.16 / 0.3;
  constexpr int kMost = static_cast<int>(render::DrawList::kLamps) - 1;
  const double lit = 0.9 * (room.behind + room.ahead);
  const int count = std::clamp(static_cast<int>(std::lround(lit / kApart)), 1, kMost);
  const double apart = lit / count;
  std::vector<Lamp> lamps;
  for (int i = 0; i < count; ++i) {
    const double y = -room.behind + (i + kInset) * apart;
    lamps.push_back({{0.0, y, z}, kPower * apart / kApart * warm});
  }
  // The last lamp is behind the masking panel if there is one, otherwise on the ceiling.
  const double last = room.masking_panel ? room.masking_low + 0.1 : z;
  lamps.push_back({{0.0, room.portal() + 0.25, last}, (room.masking_panel ? 0.42 : 1.2) * warm});
  return lamps;
}

Ambient room_ambient() {
  return {Vec3(0.31, 0.315, 0.33), Vec3(0.24, 0.20, 0.155)};
}

RoomMeshes room_meshes(const RoomMeasures& room) {
  const Builder build(room);
  auto [lane, oil] = lane_meshes(room, build);
  return {std::move(lane),          std::move(oil),         approach_mesh(room, build),
          beside_mesh(room, build), wall_mesh(room, build), front_mesh(room, build)};
}

std::vector<Patch> floor_patches(const RoomMeasures& room) {
  const double w = 0.5 * room.width, edge = room.gutter_edge(), lane = 0.5 * room.lane_width;
  const Vec3 along(0, room.ahead, 0);
  std::vector<Patch> patches{{{-w, -room.behind, 0}, {room.width, 0, 0}, {0, room.behind, 0}},
                             {{-lane, 0, 0}, {room.lane_width, 0, 0}, along},
                             {{-w, 0, 0}, {w - edge, 0, 0}, along},
                             {{edge, 0, 0}, {w - edge, 0, 0}, along}};
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < gutter_faces(room); ++i) {
      Vec2 a = gutter_point(room, i), b = gutter_point(room, i + 1);
      if (side < 0.0) std::swap(a, b);
      const Vec3 from(side * a.x(), 0, a.y()), to(side * b.x(), 0, b.y());
      patches.push_back({from, to - from, along});
    }
  }
  return patches;
}

Mesh stand_mesh(double height, double ball_radius) {
  const Vec3 metal = srgb(0x8d9299), wood = srgb(0x7a4a28), rim = srgb(0x23262b);
  const double cup = 0.62 * ball_radius;
  const std::array<Ring, 12> rings{Ring{0.0, 0.15, {1, 0}, wood},
                                   Ring{0.025, 0.15, {1, 0}, wood},
                                   Ring{0.025, 0.15, {0, 1}, wood},
                                   Ring{0.03, 0.028, {0.3, 1}, wood},
                                   Ring{0.03, 0.028, {1, 0.1}, metal},
                                   Ring{height - 0.08, 0.024, {1, 0}, metal},
                                   Ring{height - 0.03, cup, {0.7, -0.7}, metal},
                                   Ring{height, cup, {1, 0}, rim},
                                   Ring{height, cup, {0, 1}, rim},
                                   Ring{height, cup - 0.012, {0, 1}, rim},
                                   Ring{height, cup - 0.012, {-1, 0.3}, rim},
                                   Ring{height - 0.03, 0.0, {0, 1}, rim}};
  Mesh mesh = render::turned(rings, 20);
  mesh.gloss = 0.4;
  return mesh;
}

}  // namespace headpin::scene
