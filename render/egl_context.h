#pragma once

#include <memory>
#include <optional>

#include "render/gl_context.h"

namespace headpin::render {

/// EGL without a surface: Mesa on the processor, whatever else is installed. It is loaded at run
/// time.
/// @throws as osmesa_context(); also where something else than Mesa's software draws
std::unique_ptr<GlContext> egl_context();

/// One of the devices that EGL lists, a graphics card or the processor (render/egl_devices.h).
/// @throws as osmesa_context()
std::unique_ptr<GlContext> egl_device_context(int device);
int egl_device_count();
std::optional<int> cuda_number(int device);  ///< its CUDA number, if it has one

}  // namespace headpin::render
