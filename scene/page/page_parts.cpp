#include "scene/page/page_parts.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "render/eyes.h"
#include "render/lens.h"
#include "scene/stage/seen_mesh.h"

namespace headpin::scene {

using nlohmann::json;

namespace {

const char* name_of(render::Surface surface) {
  if (surface == render::Surface::lit) return "lit";
  return surface == render::Surface::baked ? "baked" : "floor";
}

Table vertices_of(const render::Mesh& mesh, int number) {
  constexpr double kPlace = 1.0 / 16384.0, kNormal = 1.0 / 128.0, kLight = 1.0 / 512.0;
  Table table{fmt::format("mesh {} vertices", number), {}, {}, {}};
  for (const char* kind : {"p", "n", "colour"}) {
    for (const char* axis : {"x", "y", "z"}) {
      table.columns.push_back(fmt::format("{}{}", kind, axis));
      table.quanta.push_back(kind[0] == 'p' ? kPlace : kind[0] == 'n' ? kNormal : kLight);
    }
  }
  for (const render::Vertex& v : mesh.vertices) {
    for (const Eigen::Vector3f& part : {v.p, v.n, v.colour}) {
      table.values.insert(table.values.end(), part.data(), part.data() + 3);
    }
  }
  return table;
}

Table triangles_of(const render::Mesh& mesh, int number) {
  Table table{fmt::format("mesh {} triangles", number), {"a", "b", "c"}, {1, 1, 1}, {}};
  table.values.assign(mesh.indices.begin(), mesh.indices.end());
  return table;
}

/// The scenario without the mesh files that cannot be read.
Scenario with_own_shapes(Scenario scenario, std::vector<std::string>& missing) {
  const std::pair<const char*, MeshFile*> seen[] = {{"skittles", &scenario.skittle.mesh},
                                                    {"ball", &scenario.ball.mesh},
                                                    {"hand", &scenario.hand.mesh},
                                                    {"walls", &scenario.room.mesh}};
  for (const auto& [what, mesh] : seen) {
    try {
      seen_mesh(*mesh, Vec3::Zero(), 0.0);
    } catch (const std::runtime_error& e) {
      missing.push_back(
          fmt::format("Not as the trial's eyes saw it: the {}, shown in headpin's own shape ({}).",
                      what, e.what()));
      *mesh = {};
    }
  }
  return scenario;
}

}  // namespace

PageLooks::PageLooks(const Scenario& scenario)
    : looks(MeshKeeper{[this](const render::Mesh& mesh) {
              meshes.push_back(mesh);
              return static_cast<int>(meshes.size()) - 1;
            }},
            make_stage(with_own_shapes(scenario, missing))) {}

json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

json numbers(const Pose& X) {
  return {X.q.w(), X.q.x(), X.q.y(), X.q.z(), X.p.x(), X.p.y(), X.p.z()};
}

json of_eyes(const render::Optics& optics) {
  json out = json::array();
  for (const render::View& view : render::eyes({}, optics)) {
    const render::Frustum& f = view.frustum;
    out.push_back({{"X_DE", numbers(view.X_WE)},
                   {"width", view.width},
                   {"height", view.height},
                   {"pixel_aspect", optics.pixel_aspect()},
                   {"lens", render::has_lens(optics)},
                   {"frustum",
                    {{"left", f.left},
                     {"right", f.right},
                     {"bottom", f.bottom},
                     {"top", f.top},
                     {"near", f.near},
                     {"far", f.far}}}});
  }
  return out;
}

json of_light(const render::DrawList& room) {
  json out = {{"sky", numbers(room.sky)},
              {"ground", numbers(room.ground)},
              {"background", numbers(room.background)},
              {"towards", numbers(room.shadow.n_W)},
              {"shadow", room.shadow.depth},
              {"lamps", json::array()}};
  for (const render::Lamp& lamp : room.lamps) {
    out["lamps"].push_back({{"p", numbers(lamp.p_W)}, {"power", numbers(lamp.power)}});
  }
  return out;
}

json of_room(const Scenario& scenario) {
  return {{"width", scenario.room.width},
          {"height", scenario.room.height},
          {"behind", scenario.room.behind},
          {"ahead", scenario.room.ahead},
          {"head_pin", scenario.lane.head_pin}};
}

json of_still(const render::DrawList& room) {
  json out = json::array();
  for (const render::DrawItem& item : room.items) {
    out.push_back({{"mesh", item.mesh}, {"X_WG", numbers(item.X_WG)}});
  }
  return out;
}

json of_board(const Looks& looks) {
  if (!looks.board) return nullptr;
  json out = {{"characters", json::object()}, {"cells", json::array()}};
  for (const auto& [character, mesh] : looks.board->meshes) {
    out["characters"][std::string(1, character)] = mesh;
  }
  for (std::size_t row = 0; row < kBoardRows; ++row) {
    json cells = json::array();
    for (std::size_t column = 0; column < kBoardColumns; ++column) {
      cells.push_back(numbers(looks.board->measures.cell(row, column)));
    }
    out["cells"].push_back(std::move(cells));
  }
  return out;
}

json of_ring_mesh(const Looks& looks) {
  return looks.oil_ring ? json(*looks.oil_ring) : json();
}

json of_rings(const Glimpse& g, double ball_radius) {
  json out = json::array();
  for (const Pose& X_BG : g.X_BG_rings) {
    out.push_back(numbers(X_BG));
    out.back().push_back(ring_radius(ball_radius, X_BG));
  }
  return out;
}

void add_meshes(const std::vector<render::Mesh>& meshes, const std::set<int>& wanted, json& out,
                std::vector<Table>& tables) {
  for (const int number : wanted) {
    const render::Mesh& mesh = meshes[static_cast<std::size_t>(number)];
    out["meshes"].push_back(
        {{"number", number}, {"surface", name_of(mesh.surface)}, {"gloss", mesh.gloss}});
    tables.push_back(vertices_of(mesh, number));
    tables.push_back(triangles_of(mesh, number));
  }
}

void pack(std::vector<Table> tables, PageData& data) {
  data.json["sections"] = json::array();
  for (Table& table : tables) {
    data.json["sections"].push_back({{"name", table.name},
                                     {"offset", data.floats.size()},
                                     {"rows", table.rows()},
                                     {"columns", table.columns},
                                     {"quanta", table.quanta}});
    data.floats.insert(data.floats.end(), table.values.begin(), table.values.end());
    table = {};
  }
}

}  // namespace headpin::scene
