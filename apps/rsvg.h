#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// What headpin uses of librsvg, which reads SVG, and of cairo, on which it draws. Both are loaded
/// at run time, when a plot is to be PNG or PDF; no headers of theirs are needed to build headpin.
namespace headpin::apps {

// Known by their addresses alone.
struct RsvgHandle;
struct CairoSurface;
struct CairoContext;

struct GlibError {
  std::uint32_t domain;
  int code;
  char* message;
};
struct RsvgRectangle {
  double x, y, width, height;
};

/// Receives the bytes of a PDF; returns a status of cairo.
using CairoWrite = int (*)(void* closure, const unsigned char* data, unsigned size);

// Enumerations of cairo.
inline constexpr int kCairoSuccess = 0, kCairoNoMemory = 1;
inline constexpr int kCairoRgb24 = 1;  // a pixel is 32 bits in the order of the machine: 0xXXRRGGBB
inline constexpr int kCairoCreateDate = 5;  // of the metadata of a PDF

/// The functions, each without the prefix of its library.
struct Rsvg {
  RsvgHandle* (*new_from_data)(const std::uint8_t* svg, std::size_t size, GlibError** error);
  int (*get_intrinsic_size_in_pixels)(RsvgHandle*, double* width, double* height);
  int (*render_document)(RsvgHandle*, CairoContext*, const RsvgRectangle* where, GlibError** error);
  void (*object_unref)(void* object);
  void (*error_free)(GlibError*);

  CairoSurface* (*image_surface_create)(int format, int width, int height);
  unsigned char* (*image_surface_get_data)(CairoSurface*);
  int (*image_surface_get_stride)(CairoSurface*);
  CairoSurface* (*pdf_surface_create_for_stream)(CairoWrite, void* closure, double width,
                                                 double height);  ///< in points of 1/72 inch
  void (*pdf_surface_set_metadata)(CairoSurface*, int what, const char* value);
  void (*surface_finish)(CairoSurface*);
  int (*surface_status)(CairoSurface*);
  void (*surface_destroy)(CairoSurface*);
  CairoContext* (*create)(CairoSurface*);
  void (*destroy)(CairoContext*);
  void (*scale)(CairoContext*, double x, double y);
  void (*set_source_rgb)(CairoContext*, double red, double green, double blue);
  void (*paint)(CairoContext*);
  const char* (*status_to_string)(int status);

  std::string versions;  ///< "librsvg 2.54.7, cairo 1.16.0"
};

/// Loads the libraries at the first call; they stay loaded.
/// @throws std::runtime_error  what cannot be loaded, and the Debian package that has it
const Rsvg& rsvg();

}  // namespace headpin::apps
