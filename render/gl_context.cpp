#include "render/gl_context.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <GL/osmesa.h>
#include <dlfcn.h>

#include "render/gl_functions.h"

#ifdef __SANITIZE_ADDRESS__
// OSMesa and the compiler under it keep some memory to the end of the process.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libLLVM\n";
}
#endif

namespace headpin::render {

namespace {

/// Mesa 22.3 crashes on these instead of failing, so they are refused before it sees them.
void check_environment() {
  const char* driver = std::getenv("GALLIUM_DRIVER");
  if (driver != nullptr && std::strcmp(driver, "llvmpipe") != 0 &&
      std::strcmp(driver, "softpipe") != 0) {
    throw std::runtime_error(std::string("GALLIUM_DRIVER is ") + driver +
                             ": OSMesa knows llvmpipe and softpipe");
  }
  const char* bits = std::getenv("LP_NATIVE_VECTOR_WIDTH");
  if (bits != nullptr && std::strcmp(bits, "128") != 0 && std::strcmp(bits, "256") != 0) {
    throw std::runtime_error(std::string("LP_NATIVE_VECTOR_WIDTH is ") + bits +
                             ": expected 128 or 256");
  }
}

/// libOSMesa, kept loaded: its compiler threads outlive any context.
struct OsMesaLibrary {
  void* handle = nullptr;
  decltype(&::OSMesaCreateContextAttribs) create = nullptr;
  decltype(&::OSMesaDestroyContext) destroy = nullptr;
  decltype(&::OSMesaMakeCurrent) make_current = nullptr;
  decltype(&::OSMesaGetCurrentContext) current = nullptr;
  decltype(&::OSMesaGetProcAddress) function = nullptr;

  OsMesaLibrary() {
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
      if (handle == nullptr) handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    }
    if (handle == nullptr) {
      throw std::runtime_error("cannot load libOSMesa.so.8 (Debian: libosmesa6): " +
                               std::string(dlerror()));
    }
    const auto find = [&](auto& pointer, const char* name) {
      pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(dlsym(handle, name));
      if (pointer == nullptr) throw std::runtime_error("libOSMesa has no " + std::string(name));
    };
    find(create, "OSMesaCreateContextAttribs");
    find(destroy, "OSMesaDestroyContext");
    find(make_current, "OSMesaMakeCurrent");
    find(current, "OSMesaGetCurrentContext");
    find(function, "OSMesaGetProcAddress");
  }
};

const OsMesaLibrary& osmesa() {
  static const OsMesaLibrary library;
  return library;
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext() {
    const std::array<int, 13> wishes{OSMESA_FORMAT,
                                     OSMESA_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     0,
                                     OSMESA_STENCIL_BITS,
                                     0,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     3,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     3,
                                     0};
    context_ = osmesa().create(wishes.data(), nullptr);
    if (context_ == nullptr) throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context");
  }
  ~OsMesaContext() override {
    if (osmesa().current() == context_) osmesa().make_current(nullptr, nullptr, 0, 0, 0);
    osmesa().destroy(context_);
  }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  void make_current() override {
    if (osmesa().current() == context_) return;
    if (osmesa().make_current(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1) == 0) {
      throw std::runtime_error("OSMesa cannot make its context current");
    }
  }

  void* function(const char* name) const override {
    return reinterpret_cast<void*>(osmesa().function(name));
  }

  std::string backend() const override { return "OSMesa"; }

 private:
  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 4> pixel_{};
};

std::string text(const Gl& gl, GLenum name) {
  const GLubyte* string = gl.GetString(name);
  return string == nullptr ? "" : reinterpret_cast<const char*>(string);
}

}  // namespace

std::unique_ptr<GlContext> osmesa_context() {
  check_environment();
  return std::make_unique<OsMesaContext>();
}

Gl load_functions(const GlContext& context) {
  Gl gl;
  const auto load = [&](auto& pointer, const char* name) {
    pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(context.function(name));
    if (pointer == nullptr) {
      throw std::runtime_error(context.backend() + " has no function " + name);
    }
  };
#define HEADPIN_GL_LOAD(name) load(gl.name, "gl" #name);
  HEADPIN_GL_FUNCTIONS(HEADPIN_GL_LOAD)
#undef HEADPIN_GL_LOAD

  // Addresses prove nothing (names that do not exist have one too); the version does.
  const std::string version = text(gl, GL_VERSION);
  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  if (version.empty() || 10 * major + minor < 33) {
    throw std::runtime_error(context.backend() + " gives OpenGL '" + version +
                             "', expected 3.3 or newer");
  }
  return gl;
}

void check_drawing(const Gl& gl) {
  constexpr int kSize = 4;
  GLuint buffer = 0, target = 0;
  gl.GenRenderbuffers(1, &target);
  gl.BindRenderbuffer(GL_RENDERBUFFER, target);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, kSize, kSize);
  gl.GenFramebuffers(1, &buffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, buffer);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  const bool complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;

  gl.ClearColor(1.0F, 0.0F, 0.0F, 1.0F);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  const char* vertex =
      "#version 330 core\n"
      "void main() { gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID & 2), 0, 1); }";
  const char* fragment =
      "#version 330 core\n"
      "out vec4 c; void main() { c = vec4(0, 0, 1, 1); }";
  const GLuint program = gl.CreateProgram();
  for (const auto& [kind, source] :
       {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl.CreateShader(static_cast<GLenum>(kind));
    gl.ShaderSource(shader, 1, &source, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(program, shader);
    gl.DeleteShader(shader);
  }
  gl.LinkProgram(program);
  GLuint arrays = 0;
  gl.GenVertexArrays(1, &arrays);
  gl.BindVertexArray(arrays);
  gl.UseProgram(program);
  gl.Viewport(0, 0, kSize, kSize);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);  // from the middle up

  std::array<std::uint8_t, 4 * kSize * kSize> pixels{};
  gl.ReadPixels(0, 0, kSize, kSize, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  gl.Finish();

  gl.UseProgram(0);
  gl.BindVertexArray(0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.DeleteVertexArrays(1, &arrays);
  gl.DeleteProgram(program);
  gl.DeleteFramebuffers(1, &buffer);
  gl.DeleteRenderbuffers(1, &target);

  const auto is = [&](int row, std::array<std::uint8_t, 4> colour) {
    const auto first = pixels.begin() + std::ptrdiff_t{4} * kSize * row;
    return std::equal(colour.begin(), colour.end(), first);
  };
  if (!complete || gl.GetError() != GL_NO_ERROR || !is(0, {255, 0, 0, 255}) ||
      !is(kSize - 1, {0, 0, 255, 255})) {
    throw std::runtime_error("OpenGL does not draw: a test picture read back is wrong (" +
                             text(gl, GL_RENDERER) + ")");
  }
}

std::string describe(const GlContext& context, const Gl& gl) {
  return context.backend() + ", " + text(gl, GL_RENDERER) + ", OpenGL " + text(gl, GL_VERSION);
}

}  // namespace headpin::render
