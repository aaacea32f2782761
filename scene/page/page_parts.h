#pragma once

#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/data/optics.h"
#include "scene/looks/glimpse.h"
#include "scene/looks/looks.h"
#include "scene/scenario/scenario.h"

/// What pages are made of: short parts as JSON, long parts as tables of numbers.
namespace headpin::scene {

/// A table of numbers for the page.
struct Table {
  std::string name;
  std::vector<std::string> columns;
  std::vector<double> quanta;  ///< of each column: what it may be rounded to
  std::vector<float> values;   ///< row after row

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
};

/// The meshes of all objects of a scenario. Making them takes longer than most simulations, so they
/// are made once for all simulations of a trial. If a mesh file cannot be read, the program's own
/// mesh is used.
struct PageLooks {
  std::vector<render::Mesh> meshes;
  std::vector<std::string> missing;  ///< a sentence for each such file
  Looks looks;                       ///< by their numbers

  explicit PageLooks(const Scenario& scenario);
};

/// `json.sections` tells what `floats` are: each has a name, the offset of its first number, rows
/// and columns, and for each column the quantum its numbers may be rounded to.
struct PageData {
  nlohmann::json json;
  std::vector<float> floats;
};

nlohmann::json numbers(const Vec3& v);
nlohmann::json numbers(const Pose& X);  ///< w, x, y, z, p

/// Of each eye its camera, how wide its pixels are for their height on the display, and whether the
/// display has a lens.
nlohmann::json of_eyes(const render::Optics& optics);
nlohmann::json of_light(const render::DrawList& room);
nlohmann::json of_room(const Scenario& scenario);
/// The objects that never move.
nlohmann::json of_still(const render::DrawList& room);
/// The score board's characters, by their meshes, and the places of its rows; null without a board.
nlohmann::json of_board(const Looks& looks);
/// The mesh of a ring of oil on a ball; null where the scenario has none.
nlohmann::json of_ring_mesh(const Looks& looks);
/// The rings of oil on a ball: of each its pose on the ball (w, x, y, z, p) and its radius.
nlohmann::json of_rings(const Glimpse& g, double ball_radius);

/// Adds meshes, by their numbers, to `out["meshes"]` and to the tables.
void add_meshes(const std::vector<render::Mesh>& meshes, const std::set<int>& wanted,
                nlohmann::json& out, std::vector<Table>& tables);

/// Puts the tables into the data's numbers, and what they are into `json.sections`.
void pack(std::vector<Table> tables, PageData& data);

}  // namespace headpin::scene
