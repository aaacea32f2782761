#pragma once

#include <memory>

#include "render/gl_context.h"

namespace headpin::render {

/// OSMesa, which draws on the processor. It is loaded at run time. Mesa 25.1 does not have it any
/// more.
///
/// @throws std::runtime_error  when the library is missing, when environment variables would crash
///                             Mesa, or when there is no OpenGL 3.3 core context
std::unique_ptr<GlContext> osmesa_context();

}  // namespace headpin::render
