#include "apps/serve/places.h"

#include <memory>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/answer_file.h"
#include "apps/next_run.h"
#include "apps/study_play.h"
#include "base/output_file.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr int kMostGuests = 9999;
constexpr const char* kCommand = "headpin serve";

/// A new file with the next free number.
std::unique_ptr<IncomingLog> open_next(const fs::path& folder) {
  fs::create_directories(folder);
  for (int number = 1; number <= kMostGuests; ++number) {
    const fs::path path = folder / fmt::format("guest-{:02}.lcmlog", number);
    try {
      return std::make_unique<IncomingLog>(path.string());
    } catch (const base::Exists&) {
      continue;
    }
  }
  throw std::runtime_error(fmt::format("{}: has {} games already", folder.string(), kMostGuests));
}

/// The answers that a page sent.
/// @throws NoAnswer  unless all questions are answered
study::Answers answers_in(const nlohmann::json& given, const study::Questionnaire& questions) {
  study::Answers answers;
  for (const study::Item& item : questions.items) {
    const auto found = given.find(item.id);
    const std::string text =
        found != given.end() && found->is_string() ? found->get<std::string>() : "";
    const auto answer = study::answer_of(item, text);
    if (!answer) {
      throw NoAnswer(fmt::format("{}: expected {}, found '{}'", item.id, study::allowed(item),
                                 study::shown(text)));
    }
    answers.push_back({item.id, *answer, study::kAsked});
  }
  return answers;
}

/// Does what needs the session of a participant, and says to the page where it cannot be played.
template <typename Work>
auto or_refused(const std::string& id, const Work& work) {
  try {
    return work();
  } catch (const PlayedAlready&) {
    throw Refused(409, fmt::format("{} has played already; a session is played only once", id));
  } catch (const base::Busy&) {
    throw Refused(409, fmt::format("another headpin is playing the session of {}", id));
  }
}

Place place_of(const Study& study, const study::PlannedParticipant& who) {
  const std::string id = who.id;
  Place place;
  place.participant = id;
  place.condition = condition_of(study, who);
  place.scenario = scenario_of(study, who);
  const bool red = study::games_of(study.design, who.allotted)[0].red;
  place.hint = fmt::format("Touch the {} button first, and play. Then touch the {} one.",
                           red ? "red" : "blue", red ? "blue" : "red");
  // The lock of the participant's folder is kept as long as the place, also where another link cannot begin.
  const auto run = std::make_shared<std::optional<NextRun>>();
  place.open = [&study, id, run] {
    return or_refused(id, [&] {
      if (*run) {
        (*run)->renew(study, id, kCommand, false);
      } else {
        run->emplace(study, id, kCommand, false);
      }
      return std::make_unique<IncomingLog>((*run)->path());
    });
  };
  place.require_unplayed = [&study, id, run] {
    or_refused(id, [&] {
      if (*run) (*run)->require_unplayed(study, id);
    });
  };
  place.answer = [&study, id](const nlohmann::json& given) {
    const study::Answers answers = answers_in(given, study.questions);
    AnswerFile file(study, id);
    file.set_drawn_aside();  // whoever has the link is a person
    file.add_all(answers, "the page");
  };
  return place;
}

}  // namespace

std::function<Place()> places_of(const scene::Scenario& scenario, const fs::path& folder) {
  return [scenario, folder] {
    return Place{.scenario = scenario, .open = [folder] { return open_next(folder); }};
  };
}

std::function<Place()> places_of(const Study& study) {
  return [&study, invited = std::make_shared<std::set<std::string>>()] {
    const auto replaced = study::replaced(study.plan);
    for (const study::PlannedParticipant& who : study.plan) {
      if (replaced.contains(who.id) || invited->contains(who.id)) continue;
      if (counting(runs_of(study, who.id)) != nullptr) continue;
      Place place = place_of(study, who);
      invited->insert(who.id);
      return place;
    }
    throw Refused(404, "everybody of the plan has played or has a link");
  };
}

nlohmann::json questions_in_json(const study::Questionnaire& questions) {
  nlohmann::json items = nlohmann::json::array();
  for (const study::Item& item : questions.items) {
    nlohmann::json choices = nlohmann::json::array();
    for (const study::Choice& choice : item.choices) {
      choices.push_back({{"id", choice.id}, {"text", choice.text}});
    }
    items.push_back({{"id", item.id},
                     {"text", item.text},
                     {"low", item.low},
                     {"high", item.high},
                     {"low_end", item.low_end},
                     {"high_end", item.high_end},
                     {"choices", std::move(choices)}});
  }
  return {{"languages", questions.languages}, {"items", std::move(items)}};
}

}  // namespace headpin::apps
