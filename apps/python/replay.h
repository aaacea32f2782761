#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <pybind11/pybind11.h>

#include "apps/python/open_trial.h"
#include "engine/response.h"
#include "scene/record/tables.h"
#include "scene/stage/condition.h"

namespace headpin::python {

/// A trial that was simulated again. It has the results; states are simulated once more when they are asked for.
struct Replay {
  std::shared_ptr<OpenTrial> trial;
  scene::Condition condition;
  scene::Scenario scenario;                     ///< under the condition
  std::shared_ptr<const engine::Response> own;  ///< a law of the caller's own, if there is one
  nlohmann::json result;                        ///< scene::summary()
  scene::TrialHeader header;                    ///< with the names of the bodies
  std::vector<scene::Event> events;             ///< of all ticks
  std::vector<scene::ThrowRow> throws;
  std::map<std::string, pybind11::object> made;  ///< what was asked for, by its name
};

/// Simulates a trial under a condition.
///
/// @param own  a law of the caller's own in place of the condition's; null: none
std::unique_ptr<Replay> replay(const std::shared_ptr<OpenTrial>& trial,
                               const scene::Condition& condition,
                               std::shared_ptr<const engine::Response> own);

}  // namespace headpin::python
