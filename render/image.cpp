#include "render/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include <libdeflate.h>
#include <png.h>

#include "engine/hash.h"
#include "files/input_file.h"
#include "files/output_file.h"
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

/// Rows of pixels in PNG's layout.
struct Raster {
  const std::uint8_t* bytes;
  int width, height;
  int channels;  ///< 3: RGB of 8 bits each; 1: grey of 16 bits, the higher byte first
  std::size_t stride() const {
    return (channels == 3 ? std::size_t{3} : std::size_t{2}) * static_cast<std::size_t>(width);
  }
};

void append_number(Bytes& bytes, std::size_t number) {
  for (const int shift : {24, 16, 8, 0}) {
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
}

/// A chunk (PNG, 2nd edition, 5.3).
void append_chunk(Bytes& png, std::string_view name, const Bytes& data) {
  append_number(png, data.size());
  const std::size_t start = png.size();
  png.insert(png.end(), name.begin(), name.end());
  png.insert(png.end(), data.begin(), data.end());
  append_number(png, libdeflate_crc32(0, png.data() + start, png.size() - start));
}

/// Each row minus the row above it: "up", filter 2 (9.2).
Bytes filtered(const Raster& image) {
  const std::size_t row = image.stride(), rows = static_cast<std::size_t>(image.height);
  Bytes out((row + 1) * rows);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* here = image.bytes + y * row;
    std::uint8_t* to = out.data() + y * (row + 1);
    *to++ = y == 0 ? 0 : 2;
    if (y == 0) {
      std::copy_n(here, row, to);
      continue;
    }
    const std::uint8_t* above = here - row;
    for (std::size_t i = 0; i < row; ++i) to[i] = static_cast<std::uint8_t>(here[i] - above[i]);
  }
  return out;
}

/// The fastest level: see PNG in tests/bench/README.md.
Bytes compressed(const Bytes& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(1), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  Bytes out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(),
                                      out.size()));
  return out;
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

Bytes encoded(const Raster& raster, double pixel_aspect) {
  if (!(pixel_aspect > 0.001 && pixel_aspect < 1000.0)) {
    throw std::invalid_argument("PNG: pixel aspect " + std::to_string(pixel_aspect));
  }
  const bool colour = raster.channels == 3;
  Bytes head, aspect;
  append_number(head, static_cast<std::size_t>(raster.width));
  append_number(head, static_cast<std::size_t>(raster.height));
  // Bits per channel, RGB or grey, and the only methods for compression, filters and interlace in
  // use.
  for (const int byte : {colour ? 8 : 16, colour ? 2 : 0, 0, 0, 0}) {
    head.push_back(static_cast<std::uint8_t>(byte));
  }
  append_number(aspect, 10000);
  append_number(aspect, static_cast<std::size_t>(std::lround(10000 * pixel_aspect)));
  aspect.push_back(0);  // without a unit

  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(png, "IHDR", head);
  if (colour) append_chunk(png, "sRGB", {0});  // perceptual
  append_chunk(png, "pHYs", aspect);
  append_chunk(png, "IDAT", compressed(filtered(raster)));
  append_chunk(png, "IEND", {});
  return png;
}

void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
  // One of many files in a folder; the folder syncs them when it is complete.
  files::OutputFile file(path, {.overwrite = true, .durable = false});
  file.write(bytes.data(), bytes.size());
  file.commit();
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

std::vector<std::uint8_t> encode_png(const Image& image, double pixel_aspect) {
  const std::size_t expected = 3 * static_cast<std::size_t>(std::max(image.width, 0)) *
                               static_cast<std::size_t>(std::max(image.height, 0));
  if (expected == 0 || image.rgb.size() != expected) {
    throw std::invalid_argument("PNG: " + std::to_string(image.rgb.size()) + " bytes for " +
                                std::to_string(image.width) + "x" + std::to_string(image.height));
  }
  return encoded({image.rgb.data(), image.width, image.height, 3}, pixel_aspect);
}

void write_png16(const std::filesystem::path& path, std::span<const std::uint16_t> grey, int width,
                 int height, double pixel_aspect) {
  if (width < 1 || height < 1 ||
      grey.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw std::invalid_argument("PNG: " + std::to_string(grey.size()) + " values for " +
                                std::to_string(width) + "x" + std::to_string(height));
  }
  Bytes high_first;
  high_first.reserve(2 * grey.size());
  for (const std::uint16_t value : grey) {
    high_first.push_back(static_cast<std::uint8_t>(value >> 8));
    high_first.push_back(static_cast<std::uint8_t>(value & 255));
  }
  write_bytes(path, encoded({high_first.data(), width, height, 1}, pixel_aspect));
}

Image decode_png(std::span<const std::uint8_t> bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Image image;
  bool ok = png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) != 0;
  if (ok) {
    constexpr png_uint_32 kLargest = 16384;  // OpenGL's limit; invalid headers may have more
    if (png.width > kLargest || png.height > kLargest) {
      png_image_free(&png);
      throw std::runtime_error("PNG: larger than " + std::to_string(kLargest) + " pixels");
    }
    png.format = PNG_FORMAT_RGB;
    image = {static_cast<int>(png.width), static_cast<int>(png.height), Bytes(PNG_IMAGE_SIZE(png))};
    ok = png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) != 0;
  }
  if (!ok) {
    const std::string message = png.message;
    png_image_free(&png);
    throw std::runtime_error("PNG: " + message);
  }
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image, double pixel_aspect) {
  write_bytes(path, encode_png(image, pixel_aspect));
}

Image read_png(const std::filesystem::path& path) {
  constexpr std::size_t kMost = 2'000'000'000;
  const Bytes bytes = files::read_bytes(path.string(), kMost);
  try {
    return decode_png(bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace headpin::render
