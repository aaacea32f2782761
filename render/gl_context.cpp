#include "render/gl_context.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "render/egl_context.h"
#include "render/egl_devices.h"
#include "render/gl_functions.h"
#include "render/osmesa_context.h"

namespace headpin::render {

namespace {

/// The current context of this thread, and the function of its library that releases it. OSMesa and
/// EGL are independent: each may regard its context as current although the other's is.
struct Current {
  std::uint64_t context = 0;
  void (*let_go)() = nullptr;
};
thread_local Current current;

std::uint64_t new_context_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

struct Opener {
  std::string_view name;
  std::unique_ptr<GlContext> (*open)();
};
constexpr std::array kOpeners{Opener{"osmesa", osmesa_context}, Opener{"egl", egl_context}};

std::string text(const Gl& gl, GLenum name) {
  const GLubyte* string = gl.GetString(name);
  return string == nullptr ? "" : reinterpret_cast<const char*>(string);
}

}  // namespace

GlContext::GlContext(void (*let_go)()) : number_(new_context_number()), let_go_(let_go) {}

void GlContext::make_current() {
  if (current.context == number_) return;
  if (current.let_go != nullptr && current.let_go != let_go_) current.let_go();
  current = {};
  bind();
  current = {number_, let_go_};
}

void GlContext::release() {
  if (current.context != number_) return;
  let_go_();
  current = {};
}

namespace {

/// Checks that threads can be started: Mesa would wait forever for a thread that does not start.
void try_threads(const std::string& wanted) {
  constexpr int kMost = 32;  // largest number that Mesa starts
  std::vector<std::jthread> tried;
  try {
    for (int left = std::min(std::atoi(wanted.c_str()), kMost); left > 0; --left) {
      tried.emplace_back([](const std::stop_token& ended) {
        std::mutex none;
        std::unique_lock lock(none);
        std::condition_variable_any().wait(lock, ended, [] { return false; });
      });
    }
  } catch (const std::system_error& error) {
    throw std::runtime_error("LP_NUM_THREADS is " + wanted + ", but only " +
                             std::to_string(tried.size()) +
                             " threads can be started: " + error.code().message());
  }
}

}  // namespace

void prepare_mesa() {
  // With its own threads, Mesa 22.3 frees a fence while they still hold its lock (docs/threads.md).
  setenv("LP_NUM_THREADS", "0", 0);
  try_threads(std::getenv("LP_NUM_THREADS"));
  // With other drivers it crashes instead of failing.
  const char* driver = std::getenv("GALLIUM_DRIVER");
  if (driver != nullptr && std::strcmp(driver, "llvmpipe") != 0 &&
      std::strcmp(driver, "softpipe") != 0) {
    throw std::runtime_error(std::string("GALLIUM_DRIVER is ") + driver +
                             ": expected llvmpipe or softpipe");
  }
  const char* bits = std::getenv("LP_NATIVE_VECTOR_WIDTH");
  if (bits != nullptr && std::strcmp(bits, "128") != 0 && std::strcmp(bits, "256") != 0) {
    throw std::runtime_error(std::string("LP_NATIVE_VECTOR_WIDTH is ") + bits +
                             ": expected 128 or 256");
  }
}

std::span<const std::string_view> context_names() {
  static constexpr std::array kNames{kOpeners[0].name, kOpeners[1].name};
  return kNames;
}

bool is_context_name(std::string_view name) {
  return std::ranges::find(context_names(), name) != context_names().end() || is_egl_device(name);
}

std::unique_ptr<GlContext> open_context(std::string_view name) {
  if (is_egl_device(name)) return open_egl_device(name);
  std::string why;
  for (const Opener& opener : kOpeners) {
    if (!name.empty() && name != opener.name) continue;
    try {
      std::unique_ptr<GlContext> context = opener.open();
      context->make_current();
      check_drawing(load_functions(*context));
      context->instead_of = why;
      return context;
    } catch (const std::runtime_error& error) {
      why += std::string(why.empty() ? "" : "; ") + std::string(opener.name) + ": " + error.what();
    }
  }
  if (why.empty()) {
    throw std::invalid_argument("OpenGL context '" + std::string(name) +
                                "': expected osmesa, egl, egl:auto or egl:NUMBER");
  }
  throw std::runtime_error("nothing to draw with: " + why);
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

  // An address proves nothing, because unknown names have one too. The version does.
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
  gl.DrawArrays(GL_TRIANGLES, 0, 3);  // the upper half

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

std::string renderer_name(const Gl& gl) {
  return text(gl, GL_RENDERER);
}

bool draws_on_the_processor(std::string_view renderer) {
  return renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
}

std::string describe(const GlContext& context, const Gl& gl) {
  return context.backend() + ", " + text(gl, GL_RENDERER) + ", OpenGL " + text(gl, GL_VERSION);
}

}  // namespace headpin::render
