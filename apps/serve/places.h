#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "apps/serve/guests.h"
#include "apps/study_folder.h"
#include "scene/scenario/scenario.h"

/// What each guest plays, and where the log goes.
namespace headpin::apps {

/// Guests play a scenario. Their logs are FOLDER/guest-01.lcmlog and so on, with the next free
/// number.
std::function<Place()> places_of(const scene::Scenario& scenario,
                                 const std::filesystem::path& folder);

/// Each guest is the next participant of the plan who has not played; their logs and answers are
/// those of the study.
std::function<Place()> places_of(const Study& study);

/// The questions of a study as its page asks them: items with their texts, and the languages.
nlohmann::json questions_in_json(const study::Questionnaire& questions);

}  // namespace headpin::apps
