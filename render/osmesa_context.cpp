#include "render/osmesa_context.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

#ifdef HEADPIN_OSMESA

#include <GL/osmesa.h>
#include <dlfcn.h>

namespace headpin::render {

namespace {

/// libOSMesa, kept loaded: its compiler threads outlive any context.
struct OsMesaLibrary {
  void* handle = nullptr;
  decltype(&::OSMesaCreateContextAttribs) create = nullptr;
  decltype(&::OSMesaDestroyContext) destroy = nullptr;
  decltype(&::OSMesaMakeCurrent) make_current = nullptr;
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
    find(function, "OSMesaGetProcAddress");
  }
};

const OsMesaLibrary& osmesa() {
  static const OsMesaLibrary library;
  return library;
}

void let_go_of_osmesa() {
  osmesa().make_current(nullptr, nullptr, 0, 0, 0);
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext() : GlContext(let_go_of_osmesa) {
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
    release();
    osmesa().destroy(context_);
  }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  void* function(const char* name) const override {
    return reinterpret_cast<void*>(osmesa().function(name));
  }

  std::string backend() const override { return "OSMesa"; }

 private:
  void bind() override {
    if (osmesa().make_current(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1) == 0) {
      throw std::runtime_error("OSMesa cannot make its context current");
    }
  }

  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 4> pixel_{};
};

}  // namespace

std::unique_ptr<GlContext> osmesa_context() {
  prepare_mesa();
  return std::make_unique<OsMesaContext>();
}

}  // namespace headpin::render

#else

namespace headpin::render {

std::unique_ptr<GlContext> osmesa_context() {
  throw std::runtime_error("this program was built without it (Debian: libosmesa6-dev)");
}

}  // namespace headpin::render

#endif
