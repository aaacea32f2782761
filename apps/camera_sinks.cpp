#include "apps/camera_sinks.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "render/camera.h"
#include "render/matrices.h"

namespace headpin::apps {

namespace {

constexpr std::array<const char*, 2> kCameraNames = {"left", "right"};

template <typename Matrix>
nlohmann::ordered_json rows_of(const Matrix& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(row);
  }
  return rows;
}

nlohmann::ordered_json camera_json(const render::View& view) {
  const render::Camera camera(view);
  Mat3 K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return {{"width", view.width},     {"height", view.height},
          {"fx", camera.fx},         {"fy", camera.fy},
          {"cx", camera.cx},         {"cy", camera.cy},
          {"K", rows_of(K)},         {"near", view.frustum.near},
          {"far", view.frustum.far}, {"gl_projection", rows_of(render::projection(view.frustum))}};
}

}  // namespace

CamerasFile::CamerasFile(base::OutputFile file, const std::array<render::View, 2>& views)
    : file_(std::move(file)) {
  const nlohmann::ordered_json convention = "OpenCV: x right, y down, z ahead";
  const nlohmann::ordered_json pixels = "the centre of the first pixel, top left, is at (0, 0)";
  const nlohmann::ordered_json world =
      "T_cam_world takes a point of the world [m] into the camera [m]";
  const nlohmann::ordered_json gl_view = "diag(1, -1, -1, 1) * T_cam_world";
  write(fmt::format("{{\n\"convention\": {},\n\"pixels\": {},\n\"world\": {},\n\"gl_view\": {},\n",
                    convention.dump(), pixels.dump(), world.dump(), gl_view.dump()));
  write("\"cameras\": {");
  for (std::size_t eye = 0; eye < 2; ++eye) {
    write(fmt::format("{}\n\"{}\": {}", eye == 0 ? "" : ",", kCameraNames[eye],
                      camera_json(views[eye]).dump()));
  }
  write("\n},\n\"frames\": [");
}

void CamerasFile::add(const scene::EyeFrame& frame) {
  nlohmann::ordered_json row = {
      {"frame", frame.number}, {"tick", frame.tick}, {"t_us", frame.time.count()}};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Pose X_CW = render::Camera(frame.views[eye]).X_CW;
    row[kCameraNames[eye]] = {{"T_cam_world", rows_of(render::matrix(X_CW))}};
  }
  write((first_ ? "\n" : ",\n") + row.dump());
  first_ = false;
}

void CamerasFile::finish() {
  write("\n]\n}\n");
}

ColmapFolder::ColmapFolder(base::OutputFolder& folder, const std::array<render::View, 2>& views)
    : folder_(folder), images_(folder_.file("images.txt")) {
  base::OutputText cameras(folder_.file("cameras.txt"));
  cameras << "# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY\n";
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const render::Camera camera(views[eye]);
    constexpr double kCentre = 0.5;  // COLMAP's place of the centre of the first pixel
    cameras << fmt::format("{} PINHOLE {} {} {} {} {} {}\n", eye + 1, views[eye].width,
                           views[eye].height, camera.fx, camera.fy, camera.cx + kCentre,
                           camera.cy + kCentre);
  }
  cameras.close();
  base::OutputText points(folder_.file("points3D.txt"));
  points << "# POINT3D_ID X Y Z R G B ERROR TRACK[]\n";
  points.close();
  images_ << "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# (no points: an empty line)\n";
}

void ColmapFolder::add(const scene::EyeFrame& frame) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto& [q, p] = render::Camera(frame.views[eye]).X_CW;
    images_ << fmt::format("{} {} {} {} {} {} {} {} {} {}_{:06}.png\n\n", ++written_, q.w(), q.x(),
                           q.y(), q.z(), p.x(), p.y(), p.z(), eye + 1, kCameraNames[eye],
                           frame.number);
  }
}

void ColmapFolder::finish() {
  images_.close();
}

void ColmapFolder::commit() {
  folder_.commit("images.txt");
}

}  // namespace headpin::apps
