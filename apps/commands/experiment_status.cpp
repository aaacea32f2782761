#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/answer_file.h"
#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "apps/study_people.h"
#include "base/shell_word.h"
#include "study/model.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct StatusOptions {
  std::string study;
  bool json = false;
};

/// Progress of one participant.
struct HowFar {
  const study::PlannedParticipant* planned;
  std::vector<Run> runs;
  std::size_t missing;  ///< number of missing answers
  std::string replaced_by;
  bool drawn_for_person =
      false;               ///< there are drawn answers, which do not count: a person has played
  bool has_given = false;  ///< a person has given an answer: no others are drawn then
};

std::string played_in_words(const Study& study, const HowFar& one) {
  const std::vector<Run>& runs = one.runs;
  if (runs.empty()) return "not yet";
  const Run* counts = counting(runs);
  const Run& last = runs.back();
  const Run& told = counts ? *counts : last;
  const std::string length = fmt::format("{}, {:.1f} s", told.name, told.seconds);
  if (counts) {
    return length + (told.is_virtual ? ", virtual" : "") +
           (began_otherwise(study, *one.planned, told) ? ", in another order than planned" : "") +
           (told.one_game_each ? "" : ", a version played more than once, or not to its end");
  }
  return fmt::format("{}, {}", length, why_not(last));
}

std::vector<HowFar> steps_done(const Study& study) {
  const auto replaced = study::replaced(study.plan);
  std::vector<HowFar> all;
  for (const study::PlannedParticipant& one : study.plan) {
    const auto by = replaced.find(one.id);
    HowFar far{&one, runs_of(study, one.id), 0, by == replaced.end() ? "" : by->second};
    study::Answers answers = answers_of(study, one.id);
    if (of_person(far.runs)) {
      const std::size_t before = answers.size();
      leave_out_drawn(answers);
      far.drawn_for_person = answers.size() < before;
    }
    far.has_given = given_by_person(answers) != nullptr;
    far.missing = study::missing(study.questions, answers).size();
    all.push_back(std::move(far));
  }
  return all;
}

/// The step that comes when all have played and answered; empty if its results are there, and newer
/// than what they are of.
std::string next_step(const Study& study) {
  const fs::path& root = study.at.root;
  const auto tables = newest_of(root / "tables");
  if (tables < last_change(study)) return "score";
  return newest_of(root / "analysis") < tables ? "analyse" : "";
}

/// The next command for the user; empty if all is done.
std::string next_command(const Study& study, const std::vector<HowFar>& all) {
  const std::string folder = base::typed_word(study.at.root.string());
  const bool draws = study::has_published_model(study.design);
  for (const HowFar& one : all) {
    if (!one.replaced_by.empty()) continue;
    const Run* run = counting(one.runs);
    if (run && one.missing == 0) continue;
    if (run) {
      return fmt::format("headpin experiment ask {} --participant {}{}", folder, one.planned->id,
                         run->is_virtual && draws && !one.has_given ? " --virtual" : "");
    }
    return fmt::format("headpin experiment run {} --participant {} SOURCE", folder,
                       one.planned->id);
  }
  const std::string step = next_step(study);
  return step.empty() ? "" : fmt::format("headpin experiment {} {}", step, folder);
}

void tell_status(const StatusOptions& options) {
  const Study study = open_study(options.study);
  say_not_in_plan(study);
  const std::vector<HowFar> all = steps_done(study);
  const std::string next = next_command(study, all);
  if (options.json) {
    nlohmann::ordered_json people = nlohmann::ordered_json::array();
    for (const HowFar& one : all) {
      const Run* counts = counting(one.runs);
      people.push_back(
          {{"participant", one.planned->id},
           {"cell", study::cell_of(study.design, *one.planned)},
           {"changed", study::changed_key_of(study.design, *one.planned)},
           {"runs", one.runs.size()},
           {"run", counts ? nlohmann::json(counts->name) : nlohmann::json()},
           {"in_other_order", counts ? nlohmann::json(began_otherwise(study, *one.planned, *counts))
                                     : nlohmann::json()},
           {"one_game_each", counts ? nlohmann::json(counts->one_game_each) : nlohmann::json()},
           {"answers", study.questions.items.size() - one.missing},
           {"replaced_by", one.replaced_by}});
    }
    return print_json({{"participants", people}, {"next", next}});
  }
  fmt::print("{:<12}{:<6}{:<12}{:<10}{}\n", "participant", study.design.letters(), "changed",
             "answers", "played");
  for (const HowFar& one : all) {
    const std::size_t asked = study.questions.items.size();
    fmt::print("{:<12}{:<6}{:<12}{:<10}{}{}{}\n", one.planned->id,
               study::cell_of(study.design, *one.planned),
               study::changed_key_of(study.design, *one.planned),
               fmt::format("{} of {}", asked - one.missing, asked), played_in_words(study, one),
               one.drawn_for_person ? ", a person's, with drawn answers" : "",
               one.replaced_by.empty() ? "" : ", replaced by " + one.replaced_by);
  }
  if (!next.empty()) fmt::print("next: {}\n", next);
}

}  // namespace

void add_experiment_status(CLI::App& group) {
  CLI::App* command =
      group.add_subcommand("status", "Show who has played, what is missing, and the next command");
  const auto options = std::make_shared<StatusOptions>();
  add_study(*command, options->study);
  add_json(*command, options->json);
  command->footer("Example:\n  headpin experiment status study");
  command->callback([options] { tell_status(*options); });
}

}  // namespace headpin::apps
