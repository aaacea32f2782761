#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apps/study_folder.h"
#include "scene/play/score.h"
#include "scene/scenario/scenario.h"

/// How the sessions of a study are played, but for those in real time.
namespace headpin::apps {

/// What a participant plays under: the study's scenario with both versions as the plan has them.
///
/// @param rig_of  a trial whose samples are played, in the tracker and rig of its own; empty for none
scene::Scenario scenario_of(const Study& study, const study::PlannedParticipant& participant,
                            const std::string& rig_of = "");

/// "cell 010 of EFS, elasticity changes"
std::string condition_of(const Study& study, const study::PlannedParticipant& participant);

/// What a session came to.
struct PlayedSession {
  std::string path;
  double duration_s = 0.0;
  scene::Score score;
};

/// A virtual participant's session: drawn from the study's seed and the participant's name, so the
/// same on every machine. The trial has samples, events and hashes; `replay -o` makes its states.
///
/// @param each_tick  called before each tick; may throw to end it all
PlayedSession play_virtual(const Study& study, const study::PlannedParticipant& participant,
                           const std::string& path, const std::function<void()>& each_tick);

/// The samples of a trial, played under the participant's conditions.
PlayedSession play_trial(const Study& study, const study::PlannedParticipant& participant,
                         const std::string& trial, const std::string& path,
                         const std::function<void()>& each_tick);

}  // namespace headpin::apps
