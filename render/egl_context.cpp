#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "render/gl_context.h"

#ifdef HEADPIN_EGL

#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS
#include <EGL/egl.h>
#include <dlfcn.h>

namespace headpin::render {

namespace {

constexpr EGLenum kSurfaceless = 0x31DD;  // EGL_MESA_platform_surfaceless

std::runtime_error egl_error(const std::string& what, EGLint code) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "0x%x", static_cast<unsigned>(code));
  return std::runtime_error(what + " (EGL error " + number.data() + ")");
}

/// libEGL and its display without a surface, kept as long as the program runs.
struct EglLibrary {
  void* handle = nullptr;
  decltype(&::eglGetPlatformDisplay) platform_display = nullptr;
  decltype(&::eglInitialize) initialize = nullptr;
  decltype(&::eglBindAPI) bind_api = nullptr;
  decltype(&::eglChooseConfig) choose = nullptr;
  decltype(&::eglCreateContext) create = nullptr;
  decltype(&::eglDestroyContext) destroy = nullptr;
  decltype(&::eglMakeCurrent) make_current = nullptr;
  decltype(&::eglGetProcAddress) function = nullptr;
  decltype(&::eglGetError) error = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLConfig config = nullptr;

  EglLibrary() {
    // A graphics card draws other bits: it has to be asked for, by LIBGL_ALWAYS_SOFTWARE=0.
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
    handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      throw std::runtime_error("cannot load libEGL.so.1 (Debian: libegl1): " +
                               std::string(dlerror()));
    }
    const auto find = [&](auto& pointer, const char* name) {
      pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(dlsym(handle, name));
      if (pointer == nullptr) throw std::runtime_error("libEGL has no " + std::string(name));
    };
    find(platform_display, "eglGetPlatformDisplay");
    find(initialize, "eglInitialize");
    find(bind_api, "eglBindAPI");
    find(choose, "eglChooseConfig");
    find(create, "eglCreateContext");
    find(destroy, "eglDestroyContext");
    find(make_current, "eglMakeCurrent");
    find(function, "eglGetProcAddress");
    find(error, "eglGetError");
    open_display();
  }

  void open_display() {
    display = platform_display(kSurfaceless, EGL_DEFAULT_DISPLAY, nullptr);
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY || initialize(display, &major, &minor) == EGL_FALSE) {
      throw egl_error("EGL gives no display without a surface (Debian: libegl-mesa0)", error());
    }
    const std::array<EGLint, 5> wishes{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                       EGL_PBUFFER_BIT, EGL_NONE};
    EGLint found = 0;
    if (choose(display, wishes.data(), &config, 1, &found) == EGL_FALSE || found == 0) {
      throw egl_error("EGL gives no configuration for OpenGL", error());
    }
  }
};

const EglLibrary& egl() {
  static const EglLibrary library;
  return library;
}

void let_go_of_egl() {
  egl().bind_api(EGL_OPENGL_API);
  egl().make_current(egl().display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

class EglContext final : public GlContext {
 public:
  EglContext() : GlContext(let_go_of_egl) {
    const std::array<EGLint, 7> wishes{EGL_CONTEXT_MAJOR_VERSION,
                                       3,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       3,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_NONE};
    egl().bind_api(EGL_OPENGL_API);
    context_ = egl().create(egl().display, egl().config, EGL_NO_CONTEXT, wishes.data());
    if (context_ == EGL_NO_CONTEXT) {
      throw egl_error("EGL gives no OpenGL 3.3 core context", egl().error());
    }
  }
  ~EglContext() override {
    release();
    egl().destroy(egl().display, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void* function(const char* name) const override {
    return reinterpret_cast<void*>(egl().function(name));
  }

  std::string backend() const override { return "EGL"; }

 private:
  void bind() override {
    egl().bind_api(EGL_OPENGL_API);
    if (egl().make_current(egl().display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      throw egl_error("EGL cannot make its context current", egl().error());
    }
  }

  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> egl_context() {
  prepare_mesa();
  return std::make_unique<EglContext>();
}

}  // namespace headpin::render

#else

namespace headpin::render {

std::unique_ptr<GlContext> egl_context() {
  throw std::runtime_error("this program was built without it (Debian: libegl-dev)");
}

}  // namespace headpin::render

#endif
