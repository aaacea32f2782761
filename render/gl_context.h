#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace headpin::render {

struct Gl;

/// An OpenGL 3.3 core context that needs neither window nor display nor graphics card.
///
/// Everything is drawn into framebuffer objects: the context's own buffer is one pixel.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes it the calling thread's context, whichever library's was that before.
  void make_current();

  /// Address of an OpenGL function. A name that does not exist may still give one.
  virtual void* function(const char* name) const = 0;

  virtual std::string backend() const = 0;  ///< "OSMesa", "EGL" or "EGL device 0"

  std::string instead_of;  ///< why it is not one that comes before it; empty where nothing does

 protected:
  /// @param let_go  leaves the calling thread without any context of this one's library
  explicit GlContext(void (*let_go)());
  /// In a destructor: no longer current.
  void release();

 private:
  virtual void bind() = 0;

  std::uint64_t number_;
  void (*let_go_)();
};

/// Off-screen Mesa: draws on the processor. Loaded at run time. Mesa 25.1 no longer has it.
///
/// @throws std::runtime_error  when the library is missing, when the environment asks Mesa for what
///                             would crash it, or when no OpenGL 3.3 core context can be had
std::unique_ptr<GlContext> osmesa_context();

/// EGL without a surface: the same Mesa by another door, on the processor, whatever else is
/// installed. Loaded at run time.
/// @throws as osmesa_context(); also where something else than Mesa's software draws
std::unique_ptr<GlContext> egl_context();

/// One of the devices that EGL lists, a graphics card or the processor (render/egl_devices.h).
/// @throws as osmesa_context()
std::unique_ptr<GlContext> egl_device_context(int device);
int egl_device_count();
std::optional<int> cuda_number(int device);  ///< CUDA's number of it, where it has one

/// What open_context() tries by itself, in this order.
std::span<const std::string_view> context_names();

/// Whether open_context() knows it: one of context_names(), `egl:auto`, or `egl:` and a number.
bool is_context_name(std::string_view name);

/// The first of context_names() that draws, or the one that is named; `instead_of` says what failed
/// before it.
///
/// @param name  as is_context_name(), or empty
/// @throws std::invalid_argument  for another name
/// @throws std::runtime_error     when none draws: says of each why
std::unique_ptr<GlContext> open_context(std::string_view name = {});

/// Before Mesa starts: has it draw in the caller's thread, unless LP_NUM_THREADS says otherwise, and
/// refuses what it crashes on.
/// @throws std::runtime_error  naming variable, value and what is expected
void prepare_mesa();

/// The context's functions, after make_current().
///
/// @throws std::runtime_error  when the context is older than OpenGL 3.3, which it says itself
Gl load_functions(const GlContext& context);

/// Draws the upper half of a small picture and reads it back; leaves no trace in the context.
///
/// @throws std::runtime_error  when the pixels are not what was drawn: a stub library that draws
///                             nothing, a stale buffer, rows upside down
void check_drawing(const Gl& gl);

std::string renderer_name(const Gl& gl);  ///< as OpenGL tells it
/// Whether a renderer of this name is Mesa's software.
bool draws_on_the_processor(std::string_view renderer);

/// Who draws, for logs: backend, renderer and version as the context tells them.
std::string describe(const GlContext& context, const Gl& gl);

}  // namespace headpin::render
