#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace headpin::render {

/// A picture: rows from the top, three bytes per pixel, sRGB.
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

/// FNV-1a hash of the RGB bytes, 64 bit; a trial stores it for each frame.
std::uint64_t pixel_hash(const Image& image);

/// Both eyes in one picture, the left one on the left.
///
/// @throws std::invalid_argument  when the heights differ
Image side_by_side(const Image& left, const Image& right);

/// Anti-aliasing: a pixel is the mean of the linear light of the samples in and around it, weighted
/// by the area of the pixel that their cells cover. So an edge has the accuracy of nine samples
/// although five are in the pixel.
///
/// @param rgba     sRGB bytes from OpenGL, rows from the bottom, four bytes per sample, of the
///                 SampleGrid that contains the picture
/// @param width    of the result
/// @param height   of the result
/// @param samples  SampleGrid::n, 1..8
Image average(std::span<const std::uint8_t> rgba, int width, int height, int samples);

}  // namespace headpin::render
