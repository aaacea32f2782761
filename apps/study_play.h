#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apps/study_folder.h"
#include "scene/play/score.h"
#include "scene/scenario/scenario.h"

/// Plays sessions of a study that are not in real time.
namespace headpin::apps {

/// The scenario of a participant: that of the study, with the two versions of the plan.
///
/// @param rig_of  a trial whose samples are played, in its own rig and with its own grip and spin of the hand; empty
///                for none
scene::Scenario scenario_of(const Study& study, const study::PlannedParticipant& participant,
                            const std::string& rig_of = "");

/// "cell 010 of EFS, elasticity changes"
std::string condition_of(const Study& study, const study::PlannedParticipant& participant);

/// The result of a session.
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
