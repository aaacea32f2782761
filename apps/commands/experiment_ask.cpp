#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "apps/answer_file.h"
#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "apps/study_people.h"
#include "study/answers.h"
#include "study/csv.h"
#include "study/model.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct AskOptions {
  std::string study, participant, from, language;
  bool is_virtual = false, all = false, json = false;
};

void print_question(const study::Item& item, std::size_t number, std::size_t all,
                    const std::string& language) {
  fmt::print("\n{} of {}. {}\n", number, all, item.text.at(language));
  if (item.is_scale()) {
    fmt::print("   {} {}  ...  {} {}\n", item.low, item.low_end.at(language), item.high,
               item.high_end.at(language));
    return;
  }
  for (const study::Choice& choice : item.choices) fmt::print("   {}\n", choice.text.at(language));
}

/// Repeats a question until there is a valid answer; nothing at the end of the input.
std::optional<std::string> ask_one(const study::Item& item) {
  for (;;) {
    fmt::print("> ");
    std::fflush(stdout);
    std::string line;
    if (!std::getline(std::cin, line)) return std::nullopt;
    if (const auto answer = study::answer_of(item, study::trimmed(line))) return answer;
    fmt::print("   expected {}, found '{}'\n", study::allowed(item), study::shown(line));
  }
}

void ask_participant(const Study& study, const AskOptions& options) {
  const std::string& id = planned(study, options.participant).id;
  const auto& languages = study.questions.languages;
  const std::string language = options.language.empty() ? languages[0] : options.language;
  if (std::ranges::find(languages, language) == languages.end()) {
    throw UsageError(fmt::format("--language: expected one of {}, found '{}'",
                                 fmt::join(languages, ", "), language));
  }
  AnswerFile file(study, id);
  if (plays_as_person(study, id)) file.set_drawn_aside();
  const auto& items = study.questions.items;
  const auto open = study::missing(study.questions, file.answers);
  if (open.size() < items.size()) {
    fmt::print("{}: {} of {} questions are answered\n", id, items.size() - open.size(),
               items.size());
  }
  for (const study::Item* item : open) {
    print_question(*item, static_cast<std::size_t>(item - items.data()) + 1, items.size(),
                   language);
    const auto answer = ask_one(*item);
    if (!answer) {
      fmt::print("\n");
      throw std::runtime_error(fmt::format(
          "{}: {} of {} questions are answered; the same command continues with the next", id,
          file.answers.size(), items.size()));
    }
    file.add({{item->id, *answer, study::kAsked}});
  }
  fmt::print("\n{}: all {} questions are answered\n", id, items.size());
}

/// Reads answers that were typed in from paper. Checks all of them before it stores any.
void take_forms(const Study& study, const AskOptions& options) {
  std::set<std::string> names;
  for (const study::PlannedParticipant& one : study.plan) names.insert(one.id);
  const auto forms =
      study::parse_forms(read_study_file(options.from), options.from, study.questions, names);
  for (const auto& [id, answers] : forms) {
    study::Answers there = answers_of(study, id);
    if (plays_as_person(study, id)) leave_out_drawn(there);
    refuse_others(there, answers, options.from, study.at.answers(id), id);
  }
  std::size_t added = 0;
  for (const auto& [id, answers] : forms) {
    check_stop();
    AnswerFile file(study, id);
    if (plays_as_person(study, id)) file.set_drawn_aside();
    added += file.add_all(answers, options.from);
  }
  if (options.json) return print_json({{"participants", forms.size()}, {"new_answers", added}});
  fmt::print("{}: forms of {} participants, {} new answers\n", options.from, forms.size(), added);
}

/// Draws the missing answers of one participant.
/// @param of_a_person  gets what a person has played or answered, instead of any answer drawn
/// @return  number of new answers
std::size_t draw_one(const Study& study, const study::PlannedParticipant& one,
                     std::string& of_a_person) {
  const std::vector<Run> runs = runs_of(study, one.id);
  if (const Run* const run = of_person(runs)) {
    of_a_person = run->path.string() + " is a person's";
    return 0;
  }
  AnswerFile file(study, one.id);
  if (const study::Answer* const answer = given_by_person(file.answers)) {
    of_a_person = fmt::format("{} has an answer of a person: {}, {}",
                              study.at.answers(one.id).string(), answer->item, answer->source);
    return 0;
  }
  try {
    return file.add_all(
        study::draw_answers(study.design, study.questions, study.design.seed.value_or(1), one),
        "the model");
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// Draws the missing answers of participants of whom no person has played or answered anything.
void draw(const Study& study, const AskOptions& options) {
  std::size_t added = 0;
  int people = 0, left_out = 0;
  for (const study::PlannedParticipant& one : study.plan) {
    if (!options.all && one.id != options.participant) continue;
    check_stop();
    std::string of_a_person;
    added += draw_one(study, one, of_a_person);
    if (of_a_person.empty()) {
      ++people;
      continue;
    }
    if (!options.all) {
      throw UsageError(fmt::format("{} is no virtual participant: {}", one.id, of_a_person));
    }
    ++left_out;
  }
  if (left_out > 0) {
    say("{} {} left out: a person has played or answered\n", left_out,
        left_out == 1 ? "participant is" : "participants are");
  }
  if (options.json) return print_json({{"participants", people}, {"new_answers", added}});
  fmt::print("{} virtual participants, {} answers drawn from the model of '{}'\n", people, added,
             study.design.name);
}

void ask(const AskOptions& options) {
  const bool from_one = !options.participant.empty();
  if (!options.from.empty() && (from_one || options.all || options.is_virtual)) {
    throw UsageError(
        "--from: the forms have the names of the participants; expected no --participant and no "
        "--virtual");
  }
  if (options.from.empty() && from_one == options.all) {
    throw UsageError("expected --participant NAME, --all --virtual, or --from FILE");
  }
  if (options.all && !options.is_virtual) throw UsageError("--all: expected --virtual too");
  watch_stop_signals();
  const Study study = open_study(options.study);
  if (from_one) planned(study, options.participant);
  if (!options.from.empty()) return take_forms(study, options);
  if (options.is_virtual) return draw(study, options);
  ask_participant(study, options);
}

}  // namespace

void add_experiment_ask(CLI::App& group) {
  CLI::App* command = group.add_subcommand(
      "ask", "Ask a participant the questions, or read answers from paper forms");
  const auto options = std::make_shared<AskOptions>();
  add_study(*command, options->study);
  command->add_option("--participant", options->participant, "participant who answers");
  command->add_option("--language", options->language,
                      "language of the questions; default: the first in the questionnaire");
  command->add_option("--from", options->from,
                      "file with the answers of paper forms (.csv): one row per participant and "
                      "one column per item, or the columns participant, item, answer");
  command->add_flag(
      "--virtual", options->is_virtual,
      "draw the answers from the published model; files and tables mark them as virtual");
  command->add_flag("--all", options->all, "with --virtual: all virtual participants");
  add_json(*command, options->json);
  command->footer(
      "The command shows a form on the terminal. It stores each answer at once; when it is "
      "interrupted, the\nsame command continues with the next question. Type n/a for a question "
      "without an answer. The answers\nare in answers/NAME.csv.\n\n"
      "Example:\n  headpin experiment ask study --participant p001\n"
      "  headpin experiment ask study --from forms.csv");
  command->callback([options] { ask(*options); });
}

}  // namespace headpin::apps
