#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "render/osmesa_context.h"
#include "render/renderer.h"

/// Small scenes to draw, and what is read off their pictures.
namespace headpin::render::test {

inline const Quality kPlain{.samples = 2, .contact = false, .shadow = false, .mirror = false};

/// Head upright at a height, looking along +y.
inline Pose looking_ahead(const Vec3& p_W) {
  return {rotation(Vec3(std::numbers::pi / 2, 0, 0)), p_W};
}

inline Mesh glowing(Mesh mesh) {
  mesh.surface = Surface::baked;
  return mesh;
}

inline Mesh glowing_ball(double radius, const Vec3& colour) {
  return glowing(ellipsoid(radius, radius, 48, 32, [&](double) { return colour; }));
}

inline Renderer plain_renderer() {
  return Renderer(osmesa_context(), kPlain);
}

inline Image picture(Renderer& renderer, const DrawList& list, const View& view) {
  Image image;
  renderer.draw(list, {&view, 1}, {&image, 1});
  return image;
}

inline int pixel(const Image& image, int x, int y, int c = 0) {
  return image.rgb[static_cast<std::size_t>(3 * (y * image.width + x) + c)];
}

inline double light(int code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Middle of a white thing on black, weighted by its light [pixels].
inline Vec2 centroid(const Image& image) {
  Vec2 sum = Vec2::Zero();
  double weight = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double w = light(pixel(image, x, y));
      sum += w * Vec2(x + 0.5, y + 0.5);
      weight += w;
    }
  }
  return sum / weight;
}

/// Middle of the ellipse that a ball is projected to: extremes of the tangents to it.
inline Vec2 projected_middle(const View& view, const Vec3& p_W, double r) {
  const Vec3 p = view.X_WE.inverse() * p_W;
  const auto middle = [&](double across, double depth) {
    // Tangent lines from the eye in the plane (across, depth).
    const double far = depth * depth - r * r;
    return across * depth / far;
  };
  const Frustum& f = view.frustum;
  return {view.width * (middle(p.x(), -p.z()) - f.left) / (f.right - f.left),
          view.height * (f.top - middle(p.y(), -p.z())) / (f.top - f.bottom)};
}

struct BallScene {
  Renderer renderer = plain_renderer();
  DrawList list;
  double radius = 0.05;

  BallScene() {
    DrawItem item;
    item.mesh = renderer.add(glowing_ball(radius, Vec3::Ones()));
    item.id = 7;
    list.items.push_back(item);
  }
  void put(const Vec3& p_W) { list.items[0].X_WG.p = p_W; }
};

/// A lamp-lit ball over a polished floor: every pass has something to do.
struct LitScene {
  Renderer renderer;
  DrawList list;

  /// @param faces  of the floor, along and across; of one it is one part (mesh_parts.h)
  explicit LitScene(Quality quality = {}, double gloss = 0.2, int faces = 1)
      : renderer(osmesa_context(), quality) {
    Mesh floor;
    floor.surface = Surface::floor;
    floor.gloss = gloss;
    for (int i = 0; i < faces; ++i) {
      for (int j = 0; j < faces; ++j) {
        const auto corner = [&](int across, int along) {
          return Vec3(-2.0 + 4.0 * across / faces, -1.0 + 7.0 * along / faces, 0.0);
        };
        append_face(floor, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1),
                    Vec3::Constant(0.4));
      }
    }
    DrawItem item;
    item.mesh = renderer.add(floor);
    item.id = 1;
    list.items.push_back(item);
    item.mesh = renderer.add(ellipsoid(0.1, 0.1, 32, 20, [](double) { return Vec3::Ones(); }));
    item.id = 2;
    item.casts_shadow = true;
    item.mirrored = true;
    list.items.push_back(item);
    list.lamps = {{{0, 2, 2.5}, Vec3::Constant(2.0)}};
    list.patches = {{{-2, -1, 0}, {4, 0, 0}, {0, 7, 0}}};
    list.shadow = {Vec3(0.5, 0.0, 1.0).normalized(), {-2, -1, 0}, {2, 6, 1}, 0.5};
    put({0.0, 2.0, 0.1});
  }
  void put(const Vec3& p_W) {
    list.items[1].X_WG.p = p_W;
    list.occluders = {{p_W, 0.1}};
  }
  std::array<Image, 2> pair() {
    std::array<Image, 2> images;
    const Pose X_WD{rotation(Vec3(std::numbers::pi / 2 - 0.5, 0, 0)), Vec3(0, 0, 1.2)};
    renderer.draw(list, eyes(X_WD, {}), images);
    return images;
  }
};

}  // namespace headpin::render::test
