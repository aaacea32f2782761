#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/condition.h"
#include "scene/record/log.h"

/// Sessions in real time, for several commands.
namespace headpin::apps {

struct LiveOptions {
  std::vector<std::string> sources;
  std::string lcm, scenario, gl, eyes = "png";
  std::optional<scene::Scenario> given;  ///< in place of a scenario by its name
  std::optional<std::string> participant, condition_name, record;
  std::vector<std::string> hemispheres;
  int baud = 115200;
  std::optional<int> samples;  ///< in place of the scenario's
  std::optional<double> duration_s;
  bool force = false, json = false, use_lcm = false, no_trial = false;
  scene::States states = scene::States::changes;
  Condition condition;
};

/// Adds the options SOURCE, --lcm, --fastrak, --baud, --hemisphere, --duration, --eyes, --no-trial
/// and --gl.
///
/// @return  to be called after parsing: adds --lcm and --fastrak to the sources
std::function<void()> add_source_options(CLI::App& command,
                                         const std::shared_ptr<LiveOptions>& options);

/// Runs a session until it is stopped, like `headpin live`.
void go_live(const LiveOptions& options);

}  // namespace headpin::apps
