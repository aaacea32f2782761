#include "scene/stage/seen_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "base/sha256.h"
#include "scene/scenario/files.h"
#include "scene/stage/mesh_file.h"

namespace headpin::scene {

namespace {

namespace fs = std::filesystem;

MeshMeasure measure_of(const MeshFile& mesh) {
  return {mesh.unit, mesh.axes};
}

/// The bytes of the file. Checks its hash if one is given.
std::string bytes_of(MeshFile& mesh) {
  std::string bytes = read_mesh_file(mesh.file);
  const std::string found = base::sha256(bytes);
  if (!mesh.sha256.empty() && mesh.sha256 != found) {
    throw std::runtime_error(
        fmt::format("{}: SHA-256 {}, expected {}", mesh.file, found, mesh.sha256));
  }
  mesh.sha256 = found;
  return bytes;
}

double area_of(const MeshData& mesh) {
  double area = 0.0;
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const auto point = [&](std::size_t k) { return mesh.points[mesh.triangles[i + k]]; };
    area += 0.5 * (point(1) - point(0)).cross(point(2) - point(0)).norm();
  }
  return area;
}

MeshData data_of(const MeshFile& mesh) {
  MeshFile file = mesh;
  try {
    return mesh_of(bytes_of(file), file.file, measure_of(file));
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format(
        "{}; the program looks for a mesh at its recorded path and next to the trial", e.what()));
  }
}

/// The bytes of the file that a scenario with corners was made from; none where it is gone, or another
/// one now. The corners do without it.
std::optional<std::string> bytes_if_there(MeshFile mesh) {
  try {
    return bytes_of(mesh);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

void make_absolute(MeshFile& mesh, const fs::path& folder) {
  mesh.file = fs::absolute(folder / mesh.file).lexically_normal().string();
}

/// The unit with which a mesh would be as large as it must.
std::string offer_of_unit(double unit, double farthest, const Reach& reach) {
  for (const double other : {1.0, 0.001, 0.01, 0.0254, 0.3048}) {
    const double then = farthest * other / unit;
    if (then < reach.least || then > reach.most) continue;
    return fmt::format("with unit = {} it would be {:.3g}", other, then);
  }
  return "set `unit` if the file has other units";
}

}  // namespace

Reach reach_of_ball(const Ball& ball) {
  return {0.5 * ball.radius, 2.0 * ball.radius};
}

Reach reach_of_skittle(const Skittle& skittle) {
  return {0.5 * skittle.height, 2.0 * skittle.height};
}

void take_seen(MeshFile& mesh, const fs::path& folder, const Reach& reach) {
  make_absolute(mesh, folder);
  const MeshData data = mesh_of(bytes_of(mesh), mesh.file, measure_of(mesh));
  double farthest = 0.0;
  for (const Vec3& p : data.points) farthest = std::max(farthest, p.norm());
  if (!(farthest >= reach.least && farthest <= reach.most)) {
    throw std::invalid_argument(fmt::format(
        "{}: its farthest point is {:.4g} m from its origin, expected {:.4g} to {:.4g}; "
        "{}",
        mesh.file, farthest, reach.least, reach.most, offer_of_unit(mesh.unit, farthest, reach)));
  }
  constexpr double kFlat = 1e-6;  // as a part of a square around it
  if (area_of(data) < kFlat * farthest * farthest) {
    throw std::invalid_argument(
        fmt::format("{}: {} triangles of no area", mesh.file, data.triangles.size() / 3));
  }
}

bool is_still_there(const MeshFile& mesh) {
  return !mesh.file.empty() && bytes_if_there(mesh).has_value();
}

std::vector<std::string> not_drawn(const Scenario& scenario) {
  std::vector<std::string> told;
  for (const auto& [key, mesh] : {std::pair{"room.mesh", &scenario.room.mesh},
                                  {"skittle.mesh", &scenario.skittle.mesh},
                                  {"ball.mesh", &scenario.ball.mesh},
                                  {"hand.mesh", &scenario.hand.mesh}}) {
    if (mesh->file.empty()) continue;
    const std::string unseen = data_of(*mesh).unseen;
    if (unseen.empty()) continue;
    told.push_back(fmt::format("{}: {}: not drawn: {}", key, mesh->file, unseen));
  }
  return told;
}

std::vector<std::string> not_convex(const Scenario& scenario) {
  // One mesh, with its unit and axes, may be several parts, each of one or more pieces.
  std::map<std::tuple<std::string, double, std::string>, std::vector<const SkittlePart*>> by_mesh;
  for (const SkittlePart& part : scenario.skittle.parts) {
    if (part.shape != PartShape::polyhedron || part.mesh.file.empty()) continue;
    auto& pieces = by_mesh[{part.mesh.file, part.mesh.unit, part.mesh.axes}];
    const auto same = [&](const SkittlePart* other) { return other->corners == part.corners; };
    if (std::ranges::none_of(pieces, same)) pieces.push_back(&part);
  }
  std::vector<std::string> told;
  for (const auto& [key, pieces] : by_mesh) {
    const MeshFile& mesh = pieces[0]->mesh;
    const std::optional<std::string> bytes = bytes_if_there(mesh);
    if (!bytes) continue;
    std::vector<engine::Polyhedron> hulls;
    for (const SkittlePart* piece : pieces) hulls.emplace_back(piece->corners, piece->faces);
    const double added = std::max(0.0, added_by(hulls, *bytes, mesh.file, measure_of(mesh)));
    constexpr double kRounding = 1e-4;  // of coordinates that a file gives with four digits
    const std::size_t count = pieces.size();
    if (count == 1 && added < kRounding) continue;
    told.push_back(
        fmt::format("skittle.parts: {}: not convex: {} convex piece{} collide{} in its place, with "
                    "{:.1f} % more volume",
                    fs::path(mesh.file).filename().string(), count, count == 1 ? "" : "s",
                    count == 1 ? "s" : "", 100.0 * added));
  }
  return told;
}

std::vector<SkittlePart> polyhedra_of_part(const SkittlePart& part, const fs::path& folder,
                                           std::size_t most) {
  if (part.corners.empty() != part.faces.empty()) {
    throw std::invalid_argument("a polyhedron has corners and faces, or neither and a file");
  }
  std::vector<SkittlePart> parts;
  const auto add = [&](const SkittlePart& from, const engine::Polyhedron& hull) {
    SkittlePart& one = parts.emplace_back(from);
    one.corners.assign(hull.vertices().begin(), hull.vertices().end());
    one.faces.clear();
    for (const engine::Polyhedron::Face& face : hull.faces()) {
      const auto corners = hull.corners(face);
      one.faces.emplace_back(corners.begin(), corners.end());
    }
    one.low = one.high = one.corners.front().z();
    one.radius = 0.0;
    for (const Vec3& p : one.corners) {
      one.low = std::min(one.low, p.z());
      one.high = std::max(one.high, p.z());
      one.radius = std::max(one.radius, p.head<2>().norm());
    }
  };
  if (!part.corners.empty()) {
    add(part, engine::Polyhedron(part.corners, part.faces));  // also checks its corners and faces
    return parts;
  }
  if (part.mesh.file.empty()) {
    throw std::invalid_argument("a polyhedron has a file, or corners and faces; found neither");
  }
  SkittlePart from = part;
  make_absolute(from.mesh, folder);
  const std::string bytes = bytes_of(from.mesh);
  for (const engine::Polyhedron& hull :
       polyhedra_of(bytes, from.mesh.file, measure_of(from.mesh), most)) {
    add(from, hull);
  }
  return parts;
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
    } catch (const std::runtime_error&) {  // try the next place
    }
  }
}

std::optional<render::Mesh> seen_mesh(const MeshFile& mesh, const Vec3& colour, double gloss) {
  if (mesh.file.empty()) return std::nullopt;
  MeshData data = data_of(mesh);
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
