#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "render/image.h"

/// Pictures as PNG files.
namespace headpin::render {

/// Encodes a PNG file quickly: libdeflate at level 1, "up" filter. Writing stays our own code
/// around libdeflate: libpng at the same speed (level 1) makes files that are 15 % larger, and with
/// its default settings it takes 5 times as long. Reading uses libpng.
///
/// @param pixel_aspect  width of a pixel over its height, written as pHYs
std::vector<std::uint8_t> encode_png(const Image& image, double pixel_aspect = 1.0);

/// @throws std::runtime_error  with libpng's message, when the bytes are not a complete PNG
Image decode_png(std::span<const std::uint8_t> bytes);

/// Writes to a temporary name and renames: the file is complete or absent.
///
/// @throws std::runtime_error  naming the file and the reason
void write_png(const std::filesystem::path& path, const Image& image, double pixel_aspect = 1.0);

/// The same for 16-bit grey.
void write_png16(const std::filesystem::path& path, std::span<const std::uint16_t> grey, int width,
                 int height, double pixel_aspect = 1.0);

/// @throws std::runtime_error  naming the file and the reason
Image read_png(const std::filesystem::path& path);

}  // namespace headpin::render
