#include "scene/seen_mesh.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "files/sha256.h"
#include "scene/mesh_file.h"
#include "scene/scenario_files.h"

namespace headpin::scene {

namespace {

namespace fs = std::filesystem;

MeshMeasure measure_of(const MeshFile& mesh) {
  return {mesh.unit, mesh.axes};
}

/// The bytes of the file, with the hash it has if it must have one.
std::string bytes_of(MeshFile& mesh) {
  std::string bytes = read_mesh_file(mesh.file);
  const std::string found = files::sha256(bytes);
  if (!mesh.sha256.empty() && mesh.sha256 != found) {
    throw std::runtime_error(
        fmt::format("{}: SHA-256 {}, expected {}", mesh.file, found, mesh.sha256));
  }
  mesh.sha256 = found;
  return bytes;
}

void make_absolute(MeshFile& mesh, const fs::path& folder) {
  mesh.file = fs::absolute(folder / mesh.file).lexically_normal().string();
}

}  // namespace

void take_seen(MeshFile& mesh, const fs::path& folder) {
  make_absolute(mesh, folder);
  mesh_of(bytes_of(mesh), mesh.file, measure_of(mesh));
}

void take_polyhedron(SkittlePart& part, const fs::path& folder) {
  if (part.corners.empty() != part.faces.empty()) {
    throw std::invalid_argument("a polyhedron has corners and faces, or neither and a file");
  }
  if (part.corners.empty()) {
    if (part.mesh.file.empty()) {
      throw std::invalid_argument("a polyhedron has a file, or corners and faces; found neither");
    }
    make_absolute(part.mesh, folder);
    const engine::Polyhedron hull =
        polyhedron_of(bytes_of(part.mesh), part.mesh.file, measure_of(part.mesh));
    part.corners.assign(hull.vertices().begin(), hull.vertices().end());
    for (const engine::Polyhedron::Face& face : hull.faces()) {
      const auto corners = hull.corners(face);
      part.faces.emplace_back(corners.begin(), corners.end());
    }
  }
  const engine::Polyhedron hull(part.corners, part.faces);  // whatever it is from
  part.low = part.high = part.corners.front().z();
  part.radius = 0.0;
  for (const Vec3& p : hull.vertices()) {
    part.low = std::min(part.low, p.z());
    part.high = std::max(part.high, p.z());
    part.radius = std::max(part.radius, p.head<2>().norm());
  }
}

void find_again(MeshFile& mesh, const fs::path& trial) {
  if (mesh.file.empty()) return;
  const fs::path name = fs::path(mesh.file).filename();
  std::vector<fs::path> places{mesh.file, trial.parent_path() / name};
  for (const fs::path& data : data_folders()) places.push_back(data / "meshes" / name);
  for (const fs::path& path : places) {
    try {
      MeshFile found = mesh;
      found.file = fs::absolute(path).string();
      bytes_of(found);
      mesh = found;
      return;
    } catch (const std::runtime_error&) {  // it may be at the next place
    }
  }
}

std::optional<render::Mesh> seen_mesh(const MeshFile& mesh, const Vec3& colour, double gloss) {
  if (mesh.file.empty()) return std::nullopt;
  MeshFile file = mesh;
  MeshData data;
  try {
    data = mesh_of(bytes_of(file), file.file, measure_of(file));
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(fmt::format(
        "{}; a mesh that the eyes see is looked for where it was and beside the trial", e.what()));
  }
  render::Mesh seen;
  seen.gloss = gloss;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Vec3& c = data.colours.empty() ? colour : data.colours[i];
    seen.vertices.push_back(
        {data.points[i].cast<float>(), data.normals[i].cast<float>(), c.cast<float>()});
  }
  seen.indices = std::move(data.triangles);
  return seen;
}

}  // namespace headpin::scene
