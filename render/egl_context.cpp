#include "render/egl_context.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#ifdef HEADPIN_EGL

#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include "render/gl_functions.h"

namespace headpin::render {

namespace {

constexpr EGLenum kSurfaceless = 0x31DD;  // EGL_MESA_platform_surfaceless

std::runtime_error egl_error(const std::string& what, EGLint code) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "0x%x", static_cast<unsigned>(code));
  return std::runtime_error(what + " (EGL error " + number.data() + ")");
}

/// libEGL, loaded until the end of the program.
struct EglLibrary {
  void* handle = nullptr;
  decltype(&::eglGetPlatformDisplay) platform_display = nullptr;
  decltype(&::eglInitialize) initialize = nullptr;
  decltype(&::eglBindAPI) bind_api = nullptr;
  decltype(&::eglChooseConfig) choose = nullptr;
  decltype(&::eglCreateContext) create = nullptr;
  decltype(&::eglDestroyContext) destroy = nullptr;
  decltype(&::eglMakeCurrent) make_current = nullptr;
  decltype(&::eglGetCurrentDisplay) current_display = nullptr;
  decltype(&::eglGetProcAddress) function = nullptr;
  decltype(&::eglGetError) error = nullptr;

  EglLibrary() {
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
    find(current_display, "eglGetCurrentDisplay");
    find(function, "eglGetProcAddress");
    find(error, "eglGetError");
  }

  /// A function of an extension; null if it does not exist.
  template <typename Function>
  Function extension(const char* name) const {
    return reinterpret_cast<Function>(function(name));
  }
};

const EglLibrary& egl() {
  static const EglLibrary library;
  return library;
}

void let_go_of_egl() {
  const EGLDisplay display = egl().current_display();
  if (display == EGL_NO_DISPLAY) return;
  egl().bind_api(EGL_OPENGL_API);
  egl().make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/// Limits libEGL to Mesa, and Mesa to the processor. Otherwise an installed driver of a graphics
/// card would be used first. To be called before libEGL is loaded.
void ask_mesas_software() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  for (const char* folder : {"/etc/glvnd/egl_vendor.d", "/usr/share/glvnd/egl_vendor.d"}) {
    const std::filesystem::path vendor = std::filesystem::path(folder) / "50_mesa.json";
    std::error_code none;
    if (std::filesystem::exists(vendor, none)) {
      setenv("__EGL_VENDOR_LIBRARY_FILENAMES", vendor.c_str(), 1);
      return;
    }
  }
}

EGLDisplay surfaceless_display() {
  return egl().platform_display(kSurfaceless, EGL_DEFAULT_DISPLAY, nullptr);
}

std::vector<EGLDeviceEXT> all_devices() {
  const auto query = egl().extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  EGLint count = 0;
  if (query == nullptr || query(0, nullptr, &count) == EGL_FALSE) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (query(count, devices.data(), &count) == EGL_FALSE) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

class EglContext final : public GlContext {
 public:
  EglContext(EGLDisplay display, std::string name)
      : GlContext(let_go_of_egl), display_(display), name_(std::move(name)) {
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY || egl().initialize(display, &major, &minor) == EGL_FALSE) {
      throw egl_error(name_ + " gives no display without a surface (Debian: libegl-mesa0)",
                      egl().error());
    }
    const std::array<EGLint, 5> kind{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                     EGL_PBUFFER_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (egl().choose(display, kind.data(), &config, 1, &found) == EGL_FALSE || found == 0) {
      throw egl_error(name_ + " gives no configuration for OpenGL", egl().error());
    }
    const std::array<EGLint, 7> wishes{EGL_CONTEXT_MAJOR_VERSION,
                                       3,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       3,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_NONE};
    egl().bind_api(EGL_OPENGL_API);
    context_ = egl().create(display, config, EGL_NO_CONTEXT, wishes.data());
    if (context_ == EGL_NO_CONTEXT) {
      throw egl_error(name_ + " gives no OpenGL 3.3 core context", egl().error());
    }
  }
  ~EglContext() override {
    release();
    egl().destroy(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void* function(const char* name) const override {
    return reinterpret_cast<void*>(egl().function(name));
  }

  std::string backend() const override { return name_; }

 private:
  void bind() override {
    egl().bind_api(EGL_OPENGL_API);
    if (egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      throw egl_error(name_ + " cannot make its context current", egl().error());
    }
  }

  EGLDisplay display_;
  std::string name_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> egl_context() {
  prepare_mesa();
  ask_mesas_software();
  auto context = std::make_unique<EglContext>(surfaceless_display(), "EGL");
  context->make_current();
  const std::string renderer = renderer_name(load_functions(*context));
  if (!draws_on_the_processor(renderer)) {
    throw std::runtime_error(
        "EGL draws by " + renderer +
        ", expected Mesa's llvmpipe or softpipe; egl:auto uses a graphics card");
  }
  return context;
}

int egl_device_count() {
  return static_cast<int>(all_devices().size());
}

std::optional<int> cuda_number(int device) {
  const auto query = egl().extension<PFNEGLQUERYDEVICEATTRIBEXTPROC>("eglQueryDeviceAttribEXT");
  const std::vector<EGLDeviceEXT> devices = all_devices();
  EGLAttrib number = -1;
  const bool known =
      query != nullptr && static_cast<std::size_t>(device) < devices.size() &&
      query(devices[static_cast<std::size_t>(device)], EGL_CUDA_DEVICE_NV, &number) == EGL_TRUE;
  if (!known) return std::nullopt;
  return static_cast<int>(number);
}

std::unique_ptr<GlContext> egl_device_context(int device) {
  prepare_mesa();
  const std::vector<EGLDeviceEXT> devices = all_devices();
  if (static_cast<std::size_t>(device) >= devices.size()) {
    throw std::runtime_error("EGL lists " + std::to_string(devices.size()) +
                             " devices, numbered from 0; there is no " + std::to_string(device));
  }
  const EGLDisplay display = egl().platform_display(
      EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(device)], nullptr);
  return std::make_unique<EglContext>(display, "EGL device " + std::to_string(device));
}

}  // namespace headpin::render

#else

namespace headpin::render {

std::unique_ptr<GlContext> egl_context() {
  throw std::runtime_error("this program was built without it (Debian: libegl-dev)");
}

int egl_device_count() {
  return 0;
}

std::optional<int> cuda_number(int) {
  return std::nullopt;
}

std::unique_ptr<GlContext> egl_device_context(int) {
  return egl_context();
}

}  // namespace headpin::render

#endif
