#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/eyes.h"
#include "render/image.h"
#include "render/matrices.h"
#include "render/sample_grid.h"

/// Objects of a few pixels are drawn again with more samples. Otherwise the brightness of a skittle
/// 18 m away would differ by 7 % between the eyes, depending on the place of the samples.
namespace headpin::render {

inline constexpr double kSmall = 16.0;  // pixels across: smaller objects are drawn again

/// A rectangle of pixels of a view, from its lower left corner.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

inline PixelRect whole(const View& view) {
  return {0, 0, view.width, view.height};
}

/// The part of a view that a box covers, with a margin of one pixel. Nothing if the box is partly
/// behind the eye.
inline std::optional<Eigen::AlignedBox2d> pixels_of(const Eigen::AlignedBox3d& box,
                                                    const Mat4& box_to_clip, const View& view) {
  Eigen::AlignedBox2d pixels;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    const Eigen::Vector4d q = box_to_clip * p.homogeneous();
    if (q.w() < view.frustum.near) return std::nullopt;
    const Vec2 at = 0.5 * (q.head<2>() / q.w() + Vec2::Ones());
    pixels.extend(at.cwiseProduct(Vec2(view.width, view.height)));
  }
  pixels.min() -= Vec2::Ones();
  pixels.max() += Vec2::Ones();
  return pixels;
}

/// The pixels of a view that a box covers, if any.
inline std::optional<PixelRect> part_of(const View& view, const Eigen::AlignedBox2d& pixels) {
  if (pixels.isEmpty()) return std::nullopt;
  const auto inside = [](double at, int most) {
    return static_cast<int>(std::clamp<double>(at, 0.0, most));
  };
  const int x = inside(std::floor(pixels.min().x()), view.width),
            y = inside(std::floor(pixels.min().y()), view.height);
  const PixelRect part{x, y, inside(std::ceil(pixels.max().x()), view.width) - x,
                       inside(std::ceil(pixels.max().y()), view.height) - y};
  if (part.width == 0 || part.height == 0) return std::nullopt;
  return part;
}

/// The view of the same eye for a part.
inline View view_of(const View& whole, const PixelRect& part) {
  View view = whole;
  const Frustum& f = whole.frustum;
  const double x = (f.right - f.left) / whole.width, y = (f.top - f.bottom) / whole.height;
  view.frustum.left = f.left + part.x * x;
  view.frustum.right = f.left + (part.x + part.width) * x;
  view.frustum.bottom = f.bottom + part.y * y;
  view.frustum.top = f.bottom + (part.y + part.height) * y;
  view.width = part.width;
  view.height = part.height;
  return view;
}

/// Copies the picture of a part to its place.
inline void paste(const Image& fine, const PixelRect& part, Image& whole_view) {
  const auto row = static_cast<std::ptrdiff_t>(3) * part.width;
  const int above = whole_view.height - part.y - part.height;  // rows of pictures are from the top
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(
        fine.rgb.begin() + row * y, row,
        whole_view.rgb.begin() + std::ptrdiff_t{3} * ((above + y) * whole_view.width + part.x));
  }
}

/// The finest grid whose samples are at most a quarter of those of the whole view and whose sides
/// OpenGL can draw into, if it is finer than the view's.
///
/// @param largest  width and height of a grid at most [samples]
inline std::optional<SampleGrid> finer_grid(const SampleGrid& grid, const View& view,
                                            const PixelRect& part, int largest) {
  const double most = 0.25 * grid.a_pixel() * view.width * view.height;
  for (SampleGrid finer{8}; finer.n > grid.n; --finer.n) {
    const int longer =
        std::max(finer.width(part.width, part.height), finer.height(part.width, part.height));
    const double samples = static_cast<double>(finer.a_pixel()) * part.width * part.height;
    if (samples <= most && longer <= largest) return finer;
  }
  return std::nullopt;
}

}  // namespace headpin::render
