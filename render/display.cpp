#include "render/display.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace headpin::render {

namespace {

/// The old pixels that a new pixel covers along one side, with their parts.
struct Cover {
  int first = 0;
  std::vector<double> shares;  ///< of it, summing to 1
};

std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> all(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double low = i * step, high = std::min<double>(from, (i + 1) * step);
    Cover& cover = all[static_cast<std::size_t>(i)];
    cover.first = std::min(from - 1, static_cast<int>(low));
    for (int j = cover.first; j < from && j < high; ++j) {
      const double share = std::min(high, j + 1.0) - std::max<double>(low, j);
      if (share > 1e-9)
        cover.shares.push_back(share / step);
      else if (cover.shares.empty())
        ++cover.first;
    }
  }
  return all;
}

Lens lens_of(const View& view, const Optics& optics) {
  return {optics, std::max(std::abs(view.frustum.left), std::abs(view.frustum.right))};
}

/// The display's edges in units of the lens.
Frustum edges_of(const Lens& lens, const Frustum& f) {
  return {
      lens.edge(f.left), lens.edge(f.right), lens.edge(f.bottom), lens.edge(f.top), f.near, f.far};
}

View relayed_view(View view, const Optics& optics) {
  if (optics.relay_width > 0) view.width = optics.relay_width;
  if (optics.relay_height > 0) view.height = optics.relay_height;
  return view;
}

/// The perspective view of all that the lens shows, at the resolution of its middle.
View behind_lens(const View& shown, const Optics& optics) {
  if (!has_lens(optics)) return shown;
  const Lens lens = lens_of(shown, optics);
  const Frustum s = edges_of(lens, shown.frustum);
  View drawn = shown;
  Frustum& f = drawn.frustum;
  for (const double x : {s.left, s.right}) {
    for (const double y : {s.bottom, s.top}) {
      const Vec2 corner = lens.direction({x, y});
      f.left = std::min(f.left, corner.x());
      f.right = std::max(f.right, corner.x());
      f.bottom = std::min(f.bottom, corner.y());
      f.top = std::max(f.top, corner.y());
    }
  }
  const double finest = lens.factor(0.0);
  drawn.width =
      static_cast<int>(std::ceil(shown.width * (f.right - f.left) / (finest * (s.right - s.left))));
  drawn.height = static_cast<int>(
      std::ceil(shown.height * (f.top - f.bottom) / (finest * (s.top - s.bottom))));
  return drawn;
}

/// Calls put(pixel, x, y) for each pixel of a view; x, y is its place in the drawn view [pixels].
template <typename Put>
void look_through(const View& shown, const View& drawn, const Optics& optics, const Put& put) {
  const Lens lens = lens_of(shown, optics);
  const Frustum s = edges_of(lens, shown.frustum);
  const Frustum& f = drawn.frustum;
  for (int j = 0; j < shown.height; ++j) {
    for (int i = 0; i < shown.width; ++i) {
      const Vec2 t = lens.direction({s.left + (s.right - s.left) * (i + 0.5) / shown.width,
                                     s.top - (s.top - s.bottom) * (j + 0.5) / shown.height});
      put(static_cast<std::size_t>(j) * static_cast<std::size_t>(shown.width) +
              static_cast<std::size_t>(i),
          drawn.width * (t.x() - f.left) / (f.right - f.left),
          drawn.height * (f.top - t.y()) / (f.top - f.bottom));
    }
  }
}

std::uint8_t code_of(double light) {
  return codes_of_light()[static_cast<std::size_t>(
      std::lround(std::clamp<double>(light, 0.0, kFullLight)))];
}

/// Distorts an image, with bilinear interpolation of the light.
Image bent(const Image& image, const View& shown, const View& drawn, const Optics& optics) {
  Image out{shown.width, shown.height,
            std::vector<std::uint8_t>(std::size_t{3} * static_cast<std::size_t>(shown.width) *
                                      static_cast<std::size_t>(shown.height))};
  look_through(shown, drawn, optics, [&](std::size_t pixel, double x, double y) {
    const auto split = [](double at, int count) {
      const double inside = std::clamp(at - 0.5, 0.0, count - 1.0);
      const int low = std::min(static_cast<int>(inside), std::max(0, count - 2));
      return std::pair(low, inside - low);
    };
    const auto [i, u] = split(x, image.width);
    const auto [j, v] = split(y, image.height);
    const int right = std::min(i + 1, image.width - 1), below = std::min(j + 1, image.height - 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto light = [&](int column, int row) -> double {
        return light_of_codes()[image.rgb[3 * (static_cast<std::size_t>(row) *
                                                   static_cast<std::size_t>(image.width) +
                                               static_cast<std::size_t>(column)) +
                                          c]];
      };
      out.rgb[3 * pixel + c] = code_of((1 - v) * ((1 - u) * light(i, j) + u * light(right, j)) +
                                       v * ((1 - u) * light(i, below) + u * light(right, below)));
    }
  });
  return out;
}

/// Slope of a value from pixel to pixel along a side: the smaller one of the slopes to both
/// neighbours, and 0 at the edge of an object (the minmod limiter of finite volumes).
double slope(double before, double here, double after) {
  const double a = here - before, b = after - here;
  if (a * b <= 0.0) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

/// Depth between the centres of pixels. In perspective, its inverse is linear along a plane.
float depth_at(const Labels& drawn, int i, int j, double x, double y) {
  const auto inverse = [&](int column, int row) {
    return 1.0 /
           static_cast<double>(
               drawn.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(drawn.width) +
                           static_cast<std::size_t>(column)]);
  };
  const double here = inverse(i, j);
  const auto slope_along = [&](int at, int count, const auto& neighbour) {
    if (count < 2) return 0.0;
    const double after = neighbour(at + 1 < count ? 1 : -1), before = neighbour(at > 0 ? -1 : 1);
    if (at == 0) return after - here;
    return at + 1 == count ? here - before : slope(before, here, after);
  };
  const double across = slope_along(i, drawn.width, [&](int by) { return inverse(i + by, j); });
  const double down = slope_along(j, drawn.height, [&](int by) { return inverse(i, j + by); });
  return static_cast<float>(1.0 / (here + across * (x - i - 0.5) + down * (y - j - 0.5)));
}

}  // namespace

Image area_filtered(const Image& image, int width, int height) {
  const std::vector<Cover> columns = covers(image.width, width),
                           rows = covers(image.height, height);
  const auto stride = 3 * static_cast<std::size_t>(width);
  std::vector<double> narrow(stride * static_cast<std::size_t>(image.height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    const std::uint8_t* row = image.rgb.data() + 3 * static_cast<std::size_t>(image.width) * y;
    for (std::size_t x = 0; x < columns.size(); ++x) {
      const std::uint8_t* pixel = row + std::ptrdiff_t{3} * columns[x].first;
      for (const double share : columns[x].shares) {
        for (std::size_t c = 0; c < 3; ++c) {
          narrow[stride * y + 3 * x + c] += share * light_of_codes()[*pixel++];
        }
      }
    }
  }
  Image out{width, height, std::vector<std::uint8_t>(stride * rows.size())};
  std::vector<double> sum(stride);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    std::ranges::fill(sum, 0.0);
    const double* row = narrow.data() + stride * static_cast<std::size_t>(rows[y].first);
    for (const double share : rows[y].shares) {
      for (std::size_t i = 0; i < stride; ++i) sum[i] += share * *row++;
    }
    std::ranges::transform(sum, out.rgb.begin() + static_cast<std::ptrdiff_t>(stride * y), code_of);
  }
  return out;
}

bool is_plain(const Optics& optics) {
  return optics.relay_width == 0 && optics.relay_height == 0 && !has_lens(optics);
}

View drawn_view(const View& shown, const Optics& optics) {
  return behind_lens(relayed_view(shown, optics), optics);
}

Image on_display(const Image& drawn, const View& shown, const Optics& optics) {
  const View relayed = relayed_view(shown, optics);
  if (!has_lens(optics)) return area_filtered(drawn, shown.width, shown.height);
  const Image seen = bent(drawn, relayed, behind_lens(relayed, optics), optics);
  if (relayed.width == shown.width && relayed.height == shown.height) return seen;
  return area_filtered(seen, shown.width, shown.height);
}

View label_view(const View& shown, const Optics& optics) {
  return behind_lens(shown, optics);
}

Labels on_display(const Labels& drawn, const View& shown, const Optics& optics) {
  if (!has_lens(optics)) return drawn;
  const auto count = static_cast<std::size_t>(shown.width) * static_cast<std::size_t>(shown.height);
  Labels out{shown.width, shown.height, std::vector<std::uint32_t>(count),
             std::vector<float>(count)};
  look_through(shown, behind_lens(shown, optics), optics,
               [&](std::size_t pixel, double x, double y) {
                 const int i = std::clamp(static_cast<int>(x), 0, drawn.width - 1);
                 const int j = std::clamp(static_cast<int>(y), 0, drawn.height - 1);
                 out.id[pixel] =
                     drawn.id[static_cast<std::size_t>(j) * static_cast<std::size_t>(drawn.width) +
                              static_cast<std::size_t>(i)];
                 out.depth[pixel] = depth_at(drawn, i, j, x, y);
               });
  return out;
}

}  // namespace headpin::render
