#include "tests/bench/mujoco_pictures.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

namespace headpin::bench {

namespace {

constexpr int kWidth = 360, kHeight = 240;

/// OSMesa as it is loaded, so that no other libGL stands before it.
struct OsMesa {
  decltype(&OSMesaCreateContextExt) create;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaDestroyContext) destroy;
};

const OsMesa& osmesa() {
  static const OsMesa loaded = [] {
    void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_GLOBAL);
    if (library == nullptr) throw std::runtime_error("no OSMesa");
    const auto find = [&](auto function, const char* name) {
      return reinterpret_cast<decltype(function)>(dlsym(library, name));  // NOLINT
    };
    return OsMesa{find(&OSMesaCreateContextExt, "OSMesaCreateContextExt"),
                  find(&OSMesaMakeCurrent, "OSMesaMakeCurrent"),
                  find(&OSMesaDestroyContext, "OSMesaDestroyContext")};
  }();
  return loaded;
}

std::string mesh_asset(const char* name, const render::Mesh& mesh) {
  std::string text = fmt::format("<mesh name='{}' vertex='", name);
  for (const render::Vertex& v : mesh.vertices) {
    text += fmt::format("{:.6f} {:.6f} {:.6f} ", v.p.x(), v.p.y(), v.p.z());
  }
  text += "' face='";
  for (const std::uint32_t i : mesh.indices) text += std::to_string(i) + " ";
  return text + "'/>";
}

std::string pose(const Pose& X) {
  return fmt::format(" pos='{} {} {}' quat='{} {} {} {}'", X.p.x(), X.p.y(), X.p.z(), X.q.w(),
                     X.q.x(), X.q.y(), X.q.z());
}

std::string model_text(const MujocoPictures::Scene& scene, int samples) {
  std::string text = fmt::format(
      "<mujoco><visual><global fovy='40' offwidth='{}' offheight='{}'/>"
      "<quality shadowsize='1024' offsamples='{}' numslices='32' numstacks='32'/>"
      "<map znear='0.005' zfar='4'/></visual><statistic extent='10'/><size nuser_body='0'/>",
      kWidth, kHeight, samples);
  text += "<asset>" + mesh_asset("skittle", scene.skittle) + mesh_asset("hand", scene.hand) +
          "</asset><default><geom contype='0' conaffinity='0'/></default><worldbody>"
          "<light directional='true' castshadow='true' dir='-0.2 0.3 -1' pos='0 0 3'/>";
  const auto box = [&](const Vec3& at, const Vec3& half, const char* rgba) {
    text += fmt::format("<geom type='box' pos='{} {} {}' size='{} {} {}' rgba='{}'/>", at.x(),
                        at.y(), at.z(), half.x(), half.y(), half.z(), rgba);
  };
  box({0, 2.3, -0.05}, {2.25, 5.3, 0.05}, "0.7 0.5 0.3 1");      // floor
  box({0, 3.5, 0.001}, {0.527, 3.5, 0.001}, "0.85 0.7 0.45 1");  // lane
  box({0, 7.65, 1.4}, {2.25, 0.05, 1.4}, "0.2 0.35 0.6 1");
  box({0, -3.05, 1.4}, {2.25, 0.05, 1.4}, "0.9 0.85 0.75 1");
  box({-2.3, 2.3, 1.4}, {0.05, 5.3, 1.4}, "0.9 0.85 0.75 1");
  box({2.3, 2.3, 1.4}, {0.05, 5.3, 1.4}, "0.9 0.85 0.75 1");
  box({0, 2.3, 2.85}, {2.25, 5.3, 0.05}, "0.95 0.93 0.9 1");
  for (const Pose& X_WB : scene.X_WB_skittles) {
    text += "<geom type='mesh' mesh='skittle' rgba='0.95 0.94 0.9 1'" + pose(X_WB) + "/>";
  }
  text += fmt::format("<geom type='sphere' size='{}' rgba='0.1 0.25 0.6 1'{}/>", scene.ball_radius,
                      pose(scene.X_WB_ball));
  text += "<geom type='mesh' mesh='hand' rgba='0.85 0.63 0.5 1'" + pose(scene.X_WH) + "/>";
  for (const double x : {-0.032, 0.032}) {
    text += "<camera" + pose({scene.X_WD.q, scene.X_WD * Vec3(x, 0.0, 0.0)}) + " fovy='40'/>";
  }
  return text + "</worldbody></mujoco>";
}

}  // namespace

struct MujocoPictures::Inside {
  OSMesaContext gl = nullptr;
  std::vector<unsigned char> buffer = std::vector<unsigned char>(4 * kWidth * kHeight);
  mjModel* model = nullptr;
  mjData* data = nullptr;
  mjvScene scene{};
  mjvOption option{};
  mjrContext context{};

  void make_current() {
    if (osmesa().make_current(gl, buffer.data(), GL_UNSIGNED_BYTE, kWidth, kHeight) == 0) {
      throw std::runtime_error("OSMesa cannot make MuJoCo's context current");
    }
  }
};

MujocoPictures::MujocoPictures(const Scene& scene, int samples)
    : inside_(std::make_unique<Inside>()),
      left_(3 * kWidth * kHeight),
      right_(3 * kWidth * kHeight) {
  Inside& in = *inside_;
  setenv("MUJOCO_GL", "osmesa", 1);  // which of the libraries it asks for OpenGL's functions
  const std::string xml = model_text(scene, samples);
  mjVFS files;
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(xml.size()));
  std::copy(xml.begin(), xml.end(), static_cast<char*>(files.filedata[0]));
  std::array<char, 512> error{};
  in.model = mj_loadXML("scene.xml", &files, error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(&files);
  if (in.model == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  in.data = mj_makeData(in.model);
  mj_forward(in.model, in.data);
  in.gl = osmesa().create(GL_RGBA, 24, 8, 8, nullptr);
  in.make_current();
  mjv_defaultScene(&in.scene);
  mjv_defaultOption(&in.option);
  mjr_defaultContext(&in.context);
  mjv_makeScene(in.model, &in.scene, 200);
  mjr_makeContext(in.model, &in.context, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &in.context);
  if (in.context.currentBuffer != mjFB_OFFSCREEN) throw std::runtime_error("MuJoCo: no buffer");
  osmesa().make_current(nullptr, nullptr, 0, 0, 0);
}

MujocoPictures::~MujocoPictures() {
  Inside& in = *inside_;
  in.make_current();
  mjr_freeContext(&in.context);
  mjv_freeScene(&in.scene);
  mj_deleteData(in.data);
  mj_deleteModel(in.model);
  osmesa().make_current(nullptr, nullptr, 0, 0, 0);
  osmesa().destroy(in.gl);
}

double MujocoPictures::draw(std::size_t times) {
  std::thread([&] {
    inside_->make_current();
    for (std::size_t i = 0; i < times; ++i) draw_here();
    osmesa().make_current(nullptr, nullptr, 0, 0, 0);
  }).join();  // a context is current in one thread, ours in another
  return left_[0] + right_[0];
}

void MujocoPictures::draw_here() {
  Inside& in = *inside_;
  const mjrRect all{0, 0, kWidth, kHeight};
  for (int eye = 0; eye < 2; ++eye) {
    mjvCamera camera;
    mjv_defaultCamera(&camera);
    camera.type = mjCAMERA_FIXED;
    camera.fixedcamid = eye;
    mjv_updateScene(in.model, in.data, &in.option, nullptr, &camera, mjCAT_ALL, &in.scene);
    in.scene.flags[mjRND_SHADOW] = 1;
    in.scene.flags[mjRND_REFLECTION] = 0;
    in.scene.flags[mjRND_SKYBOX] = 0;
    mjr_render(all, &in.scene, &in.context);
    mjr_readPixels((eye == 0 ? left_ : right_).data(), nullptr, all, &in.context);
  }
}

}  // namespace headpin::bench
