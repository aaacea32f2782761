#pragma once

#include <memory>
#include <string>

namespace headpin::render {

struct Gl;

/// An OpenGL 3.3 core context that needs neither window nor display nor graphics card.
///
/// Everything is drawn into framebuffer objects: the context's own buffer is one pixel.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes it the calling thread's context.
  virtual void make_current() = 0;

  /// Address of an OpenGL function. A name that does not exist may still give one.
  virtual void* function(const char* name) const = 0;

  virtual std::string backend() const = 0;  ///< "OSMesa"
};

/// Off-screen Mesa: draws on the processor. Loaded at run time.
///
/// @throws std::runtime_error  when the library is missing, when the environment asks Mesa for what
///                             would crash it, or when no OpenGL 3.3 core context can be had
std::unique_ptr<GlContext> osmesa_context();

/// The context's functions, after make_current().
///
/// @throws std::runtime_error  when the context is older than OpenGL 3.3, which it says itself
Gl load_functions(const GlContext& context);

/// Draws the upper half of a small picture and reads it back; leaves no trace in the context.
///
/// @throws std::runtime_error  when the pixels are not what was drawn: a stub library that draws
///                             nothing, a stale buffer, rows upside down
void check_drawing(const Gl& gl);

/// Who draws, for logs: backend, renderer and version as the context tells them.
std::string describe(const GlContext& context, const Gl& gl);

}  // namespace headpin::render
