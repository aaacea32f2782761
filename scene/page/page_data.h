#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene/looks/looks.h"
#include "scene/stage/condition.h"
#include "scene/watch/recorded.h"

/// The data of a trial for the page: short parts as JSON, long parts as rows of numbers.
namespace headpin::scene {

/// The meshes of all objects of a trial. Making them takes longer than most simulations, so they
/// are made once for all simulations of the trial. If a mesh file cannot be read, the program's own
/// mesh is used.
struct PageLooks {
  std::vector<render::Mesh> meshes;
  std::vector<std::string> missing;  ///< a sentence for each such file
  Looks looks;                       ///< by their numbers

  explicit PageLooks(const Recorded& recorded);
};

/// `json.sections` tells what `floats` are: each has a name, the offset of its first number, rows
/// and columns, and for each column the quantum its numbers may be rounded to.
struct PageData {
  nlohmann::json json;
  std::vector<float> floats;
};

/// Simulates a trial, under its own condition or another one, and stores what is visible and measured.
///
/// Bodies of an unchanged trial are at the poses of its recorded states. `json.hash` says whether
/// the simulation has the same bits, or the first difference. Of a trial that is too long for a
/// page, every n-th tick and the strongest contacts are stored; `json.drawn` says so.
///
/// @param looks   of the trial, under any condition
/// @param meshes  with what all of it looks like; without, `json.meshes` is empty and numbers of
///                meshes are those of the same trial with them
/// @throws std::invalid_argument  as apply()
/// @throws std::runtime_error     when the file is another by now or the state turns non-finite
PageData page_data(const Recorded& recorded, const PageLooks& looks,
                   const Condition& condition = {}, bool meshes = true);

}  // namespace headpin::scene
