#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene/looks/looks.h"
#include "scene/watch/recorded.h"

/// A trial as a page shows it: everything small as JSON, everything long as numbers in rows.
namespace headpin::scene {

/// What a reader may move, as the options of `headpin replay` do, in every version of the game; what
/// is not given stays as the trial has it.
struct Moved {
  std::optional<double> elasticity, friction;  ///< of every object, 0 to 1
  std::optional<std::string> shape, response;

  bool nothing() const { return !elasticity && !friction && !shape && !response; }
};

/// @throws std::invalid_argument  for a value out of range or an unknown name
void apply(const Moved& moved, Scenario& scenario);

/// The meshes of everything that a trial shows. Making them takes longer than most simulations, so
/// they are made once for all simulations of the trial. What a file that cannot be read was the look
/// of has the program's own shape.
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

/// Simulates a trial, moved or not, and keeps what of it is seen and measured.
///
/// Bodies of an unmoved trial are shown where its own states have them; `json.hash` tells whether
/// the simulation came to the same bits, and where first not. Every n-th tick is drawn of a trial
/// that has more than a page can hold, and the strongest of its contacts; `json.drawn` says so.
///
/// @param looks   of the trial, moved or not
/// @param meshes  with what all of it looks like; without, `json.meshes` is empty and numbers of
///                meshes are those of the same trial with them
/// @throws std::invalid_argument  as apply()
/// @throws std::runtime_error     when the file is another by now or the state turns non-finite
PageData page_data(const Recorded& recorded, const PageLooks& looks, const Moved& moved = {},
                   bool meshes = true);

}  // namespace headpin::scene
