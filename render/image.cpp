#include "render/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "base/hash.h"
#include "render/sample_grid.h"

namespace headpin::render {

namespace {

using Bytes = std::vector<std::uint8_t>;

double light_of_code(double code) {  // IEC 61966-2-1, both 0..1
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

double code_of_light(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

std::array<std::uint16_t, 256> make_light_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double light = light_of_code(static_cast<double>(i) / 255.0);
    table[i] = static_cast<std::uint16_t>(std::lround(kFullLight * light));
  }
  return table;
}

/// The sRGB code of each mean light 0..kFullLight.
Bytes make_code_table() {
  Bytes table(kFullLight + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double code = code_of_light(static_cast<double>(i) / kFullLight);
    table[i] = static_cast<std::uint8_t>(std::lround(255.0 * code));
  }
  return table;
}

/// The weight of a nearby sample in a pixel.
struct Share {
  int i, j;              ///< in the grid, from the one at the pixel's lower left corner
  std::uint32_t weight;  ///< of kWhole
};
constexpr std::uint32_t kWhole = 1 << 16;

/// The weights of samples: the part of the pixel that lies in the cell of each one, which is a
/// square of the grid. So all samples near an edge contribute, not only those inside the pixel.
std::vector<Share> make_shares(int n) {
  constexpr int kFine = 64;  // points along a side of a cell; those in the pixel are counted
  const int whole = 2 * kFine * (n * n + 1);
  std::vector<Share> shares;
  std::uint32_t left = kWhole;
  for (int j = -1; j <= n + 1; ++j) {
    for (int i = -2; i <= n + 1; ++i) {
      int inside = 0;
      for (int y = 0; y < kFine; ++y) {
        for (int x = 0; x < kFine; ++x) {
          const int a = kFine * (2 * i - n % 2) + 2 * x + 1, b = 2 * kFine * j + 2 * y + 1;
          const int across = n * a + b, up = n * b - a;  // place in the pixel, in parts of `whole`
          if (across >= 0 && across < whole && up >= 0 && up < whole) ++inside;
        }
      }
      const double part = static_cast<double>(inside) / (kFine * kFine * (n * n + 1));
      const auto weight = static_cast<std::uint32_t>(std::lround(part * kWhole));
      if (weight == 0) continue;
      shares.push_back({i, j, weight});
      left -= weight;
    }
  }
  std::ranges::max_element(shares, {}, &Share::weight)->weight += left;  // rest of the rounding
  return shares;
}

const std::vector<Share>& shares_of_a_pixel(int n) {
  static const std::array kOfSamples{make_shares(2), make_shares(3), make_shares(4), make_shares(5),
                                     make_shares(6), make_shares(7), make_shares(8)};
  return kOfSamples.at(static_cast<std::size_t>(n - 2));
}

/// The weighted mean light of each pixel's samples; the order of rows is reversed.
void average_grid(std::span<const std::uint8_t> rgba, int n, Image& image) {
  struct Taken {
    std::ptrdiff_t at;           // from the pixel's corner
    const std::uint32_t* light;  // of each code, weighted
  };
  using Weighted = std::array<std::uint32_t, 256>;
  std::map<std::uint32_t, Weighted> weighted;
  std::vector<Taken> taken;
  const int w = image.width, h = image.height;
  const std::ptrdiff_t row = SampleGrid{n}.width(w, h);
  for (const Share& share : shares_of_a_pixel(n)) {
    const auto [found, is_new] = weighted.try_emplace(share.weight);
    if (is_new) {
      std::ranges::transform(light_of_codes(), found->second.begin(),
                             [&](std::uint32_t light) { return share.weight * light; });
    }
    taken.push_back({4 * (share.j * row + share.i), found->second.data()});
  }
  const Bytes& code = codes_of_light();
  std::uint8_t* pixel = image.rgb.data();
  for (int y = h - 1; y >= 0; --y) {
    const std::uint8_t* corner = rgba.data() + 4 * (n * y * row + h - y);
    for (int x = 0; x < w; ++x, corner += 4 * (row + n), pixel += 3) {
      std::uint32_t red = kWhole / 2, green = red, blue = red;  // for rounding
      for (const auto& [at, light] : taken) {
        red += light[corner[at]];
        green += light[corner[at + 1]];
        blue += light[corner[at + 2]];
      }
      pixel[0] = code[red / kWhole];
      pixel[1] = code[green / kWhole];
      pixel[2] = code[blue / kWhole];
    }
  }
}

}  // namespace

const std::array<std::uint16_t, 256>& light_of_codes() {
  static const std::array<std::uint16_t, 256> table = make_light_table();
  return table;
}

const std::vector<std::uint8_t>& codes_of_light() {
  static const Bytes table = make_code_table();
  return table;
}

std::uint64_t pixel_hash(const Image& image) {
  Fnv hash;
  for (const std::uint8_t byte : image.rgb) hash.add(byte);
  return hash.value();
}

Image side_by_side(const Image& left, const Image& right) {
  if (left.height != right.height) {
    throw std::invalid_argument("side by side: pictures " + std::to_string(left.height) + " and " +
                                std::to_string(right.height) + " pixels high");
  }
  Image both{left.width + right.width, left.height, {}};
  both.rgb.reserve(left.rgb.size() + right.rgb.size());
  for (int y = 0; y < left.height; ++y) {
    for (const Image* eye : {&left, &right}) {
      const auto row = eye->rgb.begin() + std::ptrdiff_t{3} * eye->width * y;
      both.rgb.insert(both.rgb.end(), row, row + std::ptrdiff_t{3} * eye->width);
    }
  }
  return both;
}

Image average(std::span<const std::uint8_t> rgba, int width, int height, int samples) {
  const auto w = static_cast<std::size_t>(width);
  const auto h = static_cast<std::size_t>(height);
  const SampleGrid grid{samples};
  if (width < 1 || height < 1 || samples < 1 || samples > 8 ||
      rgba.size() != std::size_t{4} * static_cast<std::size_t>(grid.width(width, height)) *
                         static_cast<std::size_t>(grid.height(width, height))) {
    throw std::invalid_argument("average: " + std::to_string(rgba.size()) + " bytes for " +
                                std::to_string(width) + "x" + std::to_string(height) + " pixels");
  }
  Image image{width, height, Bytes(3 * w * h)};
  if (samples == 1) {  // one sample needs no mean
    for (std::size_t y = 0; y < h; ++y) {
      const std::uint8_t* sample = rgba.data() + 4 * w * (h - 1 - y);
      std::uint8_t* pixel = image.rgb.data() + 3 * w * y;
      for (std::size_t x = 0; x < w; ++x, sample += 4, pixel += 3) {
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = sample[c];  // a call would cost more
      }
    }
    return image;
  }
  average_grid(rgba, samples, image);
  return image;
}

}  // namespace headpin::render
