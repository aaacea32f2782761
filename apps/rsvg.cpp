#include "apps/rsvg.h"

#include <stdexcept>
#include <type_traits>

#include <dlfcn.h>
#include <fmt/format.h>

namespace headpin::apps {

namespace {

/// librsvg is linked with cairo and GLib, so their functions are found through it.
void* load_librsvg() {
  void* library = dlopen("librsvg-2.so.2", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw std::runtime_error(
        fmt::format("cannot load librsvg-2.so.2 (Debian: librsvg2-2): {}", dlerror()));
  }
  return library;
}

Rsvg load_rsvg() {
  void* library = load_librsvg();
  Rsvg loaded{};
  const auto find = [&](auto& pointer, const char* name) {
    pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(dlsym(library, name));
    if (pointer == nullptr) {
      throw std::runtime_error(
          fmt::format("librsvg-2.so.2 is too old: expected 2.52 or newer, found one without {} "
                      "(Debian: librsvg2-2)",
                      name));
    }
  };
  find(loaded.new_from_data, "rsvg_handle_new_from_data");
  find(loaded.get_intrinsic_size_in_pixels, "rsvg_handle_get_intrinsic_size_in_pixels");
  find(loaded.render_document, "rsvg_handle_render_document");
  find(loaded.object_unref, "g_object_unref");
  find(loaded.error_free, "g_error_free");
  find(loaded.image_surface_create, "cairo_image_surface_create");
  find(loaded.image_surface_get_data, "cairo_image_surface_get_data");
  find(loaded.image_surface_get_stride, "cairo_image_surface_get_stride");
  find(loaded.pdf_surface_create_for_stream, "cairo_pdf_surface_create_for_stream");
  find(loaded.pdf_surface_set_metadata, "cairo_pdf_surface_set_metadata");
  find(loaded.surface_finish, "cairo_surface_finish");
  find(loaded.surface_status, "cairo_surface_status");
  find(loaded.surface_destroy, "cairo_surface_destroy");
  find(loaded.create, "cairo_create");
  find(loaded.destroy, "cairo_destroy");
  find(loaded.scale, "cairo_scale");
  find(loaded.set_source_rgb, "cairo_set_source_rgb");
  find(loaded.paint, "cairo_paint");
  find(loaded.status_to_string, "cairo_status_to_string");

  const unsigned *major = nullptr, *minor = nullptr, *micro = nullptr;
  const char* (*cairo_version)() = nullptr;
  find(major, "rsvg_major_version");
  find(minor, "rsvg_minor_version");
  find(micro, "rsvg_micro_version");
  find(cairo_version, "cairo_version_string");
  loaded.versions =
      fmt::format("librsvg {}.{}.{}, cairo {}", *major, *minor, *micro, cairo_version());
  return loaded;
}

}  // namespace

const Rsvg& rsvg() {
  static const Rsvg loaded = load_rsvg();
  return loaded;
}

}  // namespace headpin::apps
