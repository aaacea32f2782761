#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene/recorded.h"

/// A trial as a page shows it: everything small as JSON, everything long as numbers in rows.
namespace headpin::scene {

/// What a reader may move, as the options of `headpin replay` do; what is not given stays as the
/// trial has it.
struct Moved {
  std::optional<double> elasticity, friction;  ///< of every object, 0 to 1
  std::optional<std::string> shape, response;

  bool nothing() const { return !elasticity && !friction && !shape && !response; }
};

/// @throws std::invalid_argument  for a value out of range or an unknown name
void apply(const Moved& moved, Scenario& scenario);

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
/// @param meshes  with what all of it looks like; without, `json.meshes` is empty and numbers of
///                meshes are those of the same trial with them
/// @throws std::invalid_argument  as apply()
/// @throws std::runtime_error     when the file is another by now or the state turns non-finite
PageData page_data(const Recorded& recorded, const Moved& moved = {}, bool meshes = true);

}  // namespace headpin::scene
