#pragma once

#include "scene/page/page_parts.h"
#include "scene/stage/condition.h"
#include "scene/watch/recorded.h"

/// The data of a trial for the page: short parts as JSON, long parts as rows of numbers.
namespace headpin::scene {

/// Simulates a trial, under its own condition or another one, and stores what is visible and measured.
///
/// Bodies of an unchanged trial are at the poses of its recorded states. `json.hash` says whether
/// the simulation has the same bits, or the first difference. Of a trial that is too long for a
/// page, every n-th tick and the strongest contacts are stored; `json.drawn` says so.
///
/// @param looks   of the trial, under any condition
/// @param meshes  with what all of it looks like, also in other runs of the same scenario and under
///                other conditions; without, `json.meshes` is empty and numbers of meshes are those
///                of the same trial with them
/// @throws std::invalid_argument  as apply()
/// @throws std::runtime_error     when the file is another by now or the state turns non-finite
PageData page_data(const Recorded& recorded, const PageLooks& looks,
                   const Condition& condition = {}, bool meshes = true);

}  // namespace headpin::scene
