#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace headpin::render {

/// A picture as it is shown: rows from the top, three bytes a pixel, sRGB.
struct Image {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  std::vector<std::uint8_t> rgb;

  bool operator==(const Image&) const = default;
};

/// Full light; sixty-four of them still fit an unsigned.
inline constexpr unsigned kFullLight = 16383;
/// Light 0..kFullLight of each sRGB code, and the code of each such light (IEC 61966-2-1).
const std::array<std::uint16_t, 256>& light_of_codes();
const std::vector<std::uint8_t>& codes_of_light();

/// FNV-1a of the RGB bytes, 64 bit: what a trial's log keeps of a frame.
std::uint64_t pixel_hash(const Image& image);

/// Both eyes in one picture, the left one on the left.
///
/// @throws std::invalid_argument  when the heights differ
Image side_by_side(const Image& left, const Image& right);

/// Each pixel from the samples in and around it: the mean of their light, not of their codes, weighted
/// by what their cells in the grid cover of the pixel. So an edge is told twice as well, by nine
/// samples where five lie in a pixel.
///
/// @param rgba     sRGB bytes as OpenGL reads them, rows from the bottom, four bytes a sample: those
///                 of the SampleGrid that has the picture in it
/// @param width    of the result
/// @param height   of the result
/// @param samples  SampleGrid::n, 1..8
Image average(std::span<const std::uint8_t> rgba, int width, int height, int samples);

/// The picture as a PNG file, fast: libdeflate at level 1, "up" filter.
///
/// @param pixel_aspect  width of a pixel over its height, written as pHYs
std::vector<std::uint8_t> encode_png(const Image& image, double pixel_aspect = 1.0);

/// @throws std::runtime_error  when the bytes are no whole PNG; says what libpng says
Image decode_png(std::span<const std::uint8_t> bytes);

/// Writes beside `path` and renames: the file is whole or is not there.
///
/// @throws std::runtime_error  naming the file and the reason
void write_png(const std::filesystem::path& path, const Image& image, double pixel_aspect = 1.0);

/// Likewise, grey of 16 bits a pixel.
void write_png16(const std::filesystem::path& path, std::span<const std::uint16_t> grey, int width,
                 int height, double pixel_aspect = 1.0);

/// @throws std::runtime_error  naming the file and the reason
Image read_png(const std::filesystem::path& path);

}  // namespace headpin::render
