#include "render/png.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include <libdeflate.h>
#include <png.h>

#include "base/input_file.h"
#include "base/output_file.h"

namespace headpin::render {

namespace {

using Bytes = std::vector<std::uint8_t>;

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
  base::OutputFile file(path, {.overwrite = true, .durable = false});
  file.write(bytes.data(), bytes.size());
  file.commit();
}

}  // namespace

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
  const Bytes bytes = base::read_bytes(path.string(), kMost);
  try {
    return decode_png(bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace headpin::render
