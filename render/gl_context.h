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
/// All drawing goes to framebuffer objects; the context's own buffer has one pixel.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes it the current context of the calling thread, also after a context of another library.
  void make_current();

  /// The address of an OpenGL function; unknown names may have an address too.
  virtual void* function(const char* name) const = 0;

  virtual std::string backend() const = 0;  ///< "OSMesa", "EGL" or "EGL device 0"

  /// Why an earlier kind of context does not work; empty if this is the first kind.
  std::string instead_of;

 protected:
  /// @param let_go  removes the current context of this library from the calling thread
  explicit GlContext(void (*let_go)());
  /// For destructors: makes the context no longer current.
  void release();

 private:
  virtual void bind() = 0;

  std::uint64_t number_;
  void (*let_go_)();
};

/// The names that open_context() tries by default, in this order.
std::span<const std::string_view> context_names();

/// Whether open_context() accepts the name: one of context_names(), `egl:auto`, or `egl:` and a
/// number.
bool is_context_name(std::string_view name);

/// Opens the named context, or else the first of context_names() that draws; `instead_of` then says
/// why earlier ones failed.
///
/// @param name  as is_context_name(), or empty
/// @throws std::invalid_argument  for another name
/// @throws std::runtime_error     when none draws, with the reason for each
std::unique_ptr<GlContext> open_context(std::string_view name = {});

/// To be called before Mesa starts: makes it draw in the calling thread, unless LP_NUM_THREADS is
/// set, and refuses environment variables that crash it.
/// @throws std::runtime_error  naming the variable, its value and the expected values
void prepare_mesa();

/// The context's functions, after make_current().
///
/// @throws std::runtime_error  when the context reports an OpenGL version below 3.3
Gl load_functions(const GlContext& context);

/// Draws the upper half of a small picture and reads it back; the context's state is unchanged.
///
/// @throws std::runtime_error  when the pixels are wrong: a stub library that draws nothing, a
///                             stale buffer, rows upside down
void check_drawing(const Gl& gl);

std::string renderer_name(const Gl& gl);  ///< from OpenGL
/// Whether a renderer of this name is Mesa's software.
bool draws_on_the_processor(std::string_view renderer);

/// Backend, renderer and version, for logs.
std::string describe(const GlContext& context, const Gl& gl);

}  // namespace headpin::render
