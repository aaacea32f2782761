#include "apps/plot_file.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "apps/rsvg.h"
#include "render/image.h"
#include "render/png.h"

namespace headpin::apps {

namespace {

constexpr double kPngScale = 2.0;             // pixels per px
constexpr double kPointsPerPx = 72.0 / 96.0;  // CSS: 96 px are one inch

using Surface = std::unique_ptr<CairoSurface, void (*)(CairoSurface*)>;

/// An SVG that librsvg has read.
struct SvgDocument {
  std::unique_ptr<RsvgHandle, void (*)(void*)> handle;
  double width = 0.0, height = 0.0;  ///< [px]
};

[[noreturn]] void librsvg_failed(GlibError* error) {
  const std::string why = error != nullptr ? error->message : "no reason given";
  if (error != nullptr) rsvg().error_free(error);
  throw std::runtime_error("librsvg: " + why);
}

void require_cairo(int status) {
  if (status == kCairoSuccess) return;
  throw std::runtime_error(fmt::format("cairo: {}", rsvg().status_to_string(status)));
}

SvgDocument read_svg(const std::string& svg) {
  GlibError* error = nullptr;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(svg.data());
  SvgDocument read{{rsvg().new_from_data(bytes, svg.size(), &error), rsvg().object_unref}};
  if (!read.handle) librsvg_failed(error);
  if (rsvg().get_intrinsic_size_in_pixels(read.handle.get(), &read.width, &read.height) == 0) {
    throw std::runtime_error("librsvg: expected an SVG with width and height, found none");
  }
  return read;
}

/// Draws the SVG on a white surface.
void draw_svg(const SvgDocument& svg, CairoSurface* surface, double scale) {
  const std::unique_ptr<CairoContext, void (*)(CairoContext*)> context(rsvg().create(surface),
                                                                       rsvg().destroy);
  rsvg().set_source_rgb(context.get(), 1.0, 1.0, 1.0);
  rsvg().paint(context.get());
  rsvg().scale(context.get(), scale, scale);
  const RsvgRectangle whole{0.0, 0.0, svg.width, svg.height};
  GlibError* error = nullptr;
  if (rsvg().render_document(svg.handle.get(), context.get(), &whole, &error) == 0)
    librsvg_failed(error);
}

std::string png_of(const SvgDocument& svg) {
  render::Image image{static_cast<int>(std::ceil(kPngScale * svg.width)),
                      static_cast<int>(std::ceil(kPngScale * svg.height)),
                      {}};
  const Surface surface(rsvg().image_surface_create(kCairoRgb24, image.width, image.height),
                        rsvg().surface_destroy);
  require_cairo(rsvg().surface_status(surface.get()));
  draw_svg(svg, surface.get(), kPngScale);
  require_cairo(rsvg().surface_status(surface.get()));
  const unsigned char* row = rsvg().image_surface_get_data(surface.get());
  for (int y = 0; y < image.height; ++y, row += rsvg().image_surface_get_stride(surface.get())) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, row + x * sizeof pixel, sizeof pixel);
      for (const int shift : {16, 8, 0}) {
        image.rgb.push_back(static_cast<std::uint8_t>(pixel >> shift));
      }
    }
  }
  const std::vector<std::uint8_t> bytes = render::encode_png(image);
  return {bytes.begin(), bytes.end()};
}

/// Appends to the string behind `closure`. cairo is C: no exception may pass through it.
int append_bytes(void* closure, const unsigned char* data, unsigned size) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), size);
    return kCairoSuccess;
  } catch (const std::bad_alloc&) {
    return kCairoNoMemory;
  }
}

std::string pdf_of(const SvgDocument& svg) {
  std::string bytes;
  const Surface surface(
      rsvg().pdf_surface_create_for_stream(append_bytes, &bytes, kPointsPerPx * svg.width,
                                           kPointsPerPx * svg.height),
      rsvg().surface_destroy);
  rsvg().pdf_surface_set_metadata(surface.get(), kCairoCreateDate, "");  // else the time of day
  draw_svg(svg, surface.get(), kPointsPerPx);
  rsvg().surface_finish(surface.get());
  require_cairo(rsvg().surface_status(surface.get()));
  return bytes;
}

bool is_drawn(const std::string& name) {
  return name.ends_with(".png") || name.ends_with(".pdf");
}

}  // namespace

bool is_plot(const std::string& name) {
  return name.ends_with(".svg") || is_drawn(name);
}

void require_plot_library(const std::string& name) try {
  if (is_drawn(name)) rsvg();
} catch (const std::runtime_error& error) {
  throw std::runtime_error(name + ": " + error.what());
}

std::string plot_file(const std::string& svg, const std::string& name) try {
  if (!is_drawn(name)) return svg;
  const SvgDocument document = read_svg(svg);
  return name.ends_with(".png") ? png_of(document) : pdf_of(document);
} catch (const std::runtime_error& error) {
  throw std::runtime_error(name + ": " + error.what());
}

}  // namespace headpin::apps
