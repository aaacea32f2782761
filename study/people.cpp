#include "study/people.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "study/csv.h"

namespace headpin::study {

namespace {

/// A column of the table, and the function that fills it.
struct Filled {
  Column column;
  std::function<std::string(const Person&)> value;
};

std::string yes_no(bool yes) {
  return yes ? "yes" : "no";
}

/// Whether the changed version was played first; nothing if none was played.
std::optional<bool> played_changed_first(const Person& p) {
  const auto& order = p.played.measures.order;
  if (order.empty()) return std::nullopt;
  return (order[0] == "red") != p.planned.allotted.base_is_red;
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string(kNoAnswer);
}

void add_plan(const Design& design, const Questionnaire& questions, std::vector<Filled>& all) {
  const auto text = [&](const char* name, const char* kind, const char* meaning, auto value) {
    all.push_back({{name, kind, "", meaning}, value});
  };
  text("participant", "text", "name", [](const Person& p) { return p.planned.id; });
  text("virtual", "yes/no",
       "a virtual participant played, or nobody, and answers were drawn from a model",
       [](const Person& p) { return yes_no(p.is_virtual()); });
  text("counts", "yes/no", "whether tables and model include the participant",
       [=](const Person& p) { return yes_no(why_not(design, questions, p).empty()); });
  text("why_not", "text", "why they do not",
       [=](const Person& p) { return why_not(design, questions, p); });
  text("place", "whole", "of the allotment",
       [](const Person& p) { return fmt::format("{}", p.planned.place + 1); });
  text("cell", "text", "values of the base version, a digit a factor",
       [=](const Person& p) { return cell_of(design, p.planned); });
  text("changed", "text", "parameter that has its other value in the changed version",
       [=](const Person& p) { return changed_key_of(design, p.planned); });
  for (std::size_t i = 0; i < design.factors.size(); ++i) {
    const Factor& factor = design.factors[i];
    const std::string meaning = fmt::format("{} of the base version: 0 is {}, 1 is {}", factor.key,
                                            factor.levels[0], factor.levels[1]);
    all.push_back({{factor.letter, "whole", "", meaning},
                   [=](const Person& p) { return std::string(1, cell_of(design, p.planned)[i]); }});
  }
  text("planned_first", "text", "version that was to be played first: base or changed",
       [](const Person& p) { return p.planned.allotted.changed_first ? "changed" : "base"; });
  text("played_first", "text", "version that was played first", [](const Person& p) -> std::string {
    const std::optional<bool> changed = played_changed_first(p);
    if (!changed) return kNoAnswer;
    return *changed ? "changed" : "base";
  });
  text("base_colour", "text", "button of the base version",
       [](const Person& p) { return p.planned.allotted.base_is_red ? "red" : "blue"; });
  text("run", "text", "the recording that counts: the first that has its end and both versions",
       [](const Person& p) { return p.played.run.empty() ? kNoAnswer : p.played.run; });
  text("runs", "whole", "recordings of the session, those that were cut off among them",
       [](const Person& p) { return fmt::format("{}", p.played.runs); });
}

void add_answers(const Questionnaire& questions, std::vector<Filled>& all) {
  all.push_back({{"score", "whole", "", "high answers among the items that are scored"},
                 [=](const Person& p) {
                   const auto score = score_of(questions, p.answers);
                   return score ? fmt::format("{}", *score) : std::string(kNoAnswer);
                 }});
  all.push_back({{"of", "whole", "", "items that are scored"},
                 [=](const Person&) { return fmt::format("{}", questions.scored()); }});
  for (const Item& item : questions.items) {
    const std::string meaning =
        fmt::format("{} ({}){}", item.text.at(questions.languages[0]), allowed(item),
                    item.counts_from ? fmt::format("; high from {} on", *item.counts_from) : "");
    all.push_back({{item.id, item.is_scale() ? "whole" : "text", "", meaning},
                   [id = item.id](const Person& p) {
                     const Answer* answer = find(p.answers, id);
                     return answer ? answer->answer : std::string(kNoAnswer);
                   }});
  }
}

/// The measures of the base or of the changed version.
const VersionMeasures* version_of(const Person& person, bool changed) {
  const std::string colour = person.planned.allotted.base_is_red != changed ? "red" : "blue";
  const auto found = person.played.measures.versions.find(colour);
  return found == person.played.measures.versions.end() ? nullptr : &found->second;
}

void add_version(bool changed, std::vector<Filled>& all) {
  const std::string prefix = changed ? "changed_" : "base_";
  const auto add = [&](const char* name, const char* kind, const char* unit, const char* meaning,
                       auto value) {
    all.push_back({{prefix + name, kind, unit, meaning}, [=](const Person& p) {
                     const VersionMeasures* version = version_of(p, changed);
                     return version ? number(value(*version)) : std::string(kNoAnswer);
                   }});
  };
  using V = VersionMeasures;
  using Number = std::optional<double>;
  add("games", "whole", "",
      "games of the version that were begun: 1, if its button was touched once",
      [](const V& v) -> Number { return v.games; });
  add("games_over", "whole", "", "of them, those that were played to their end",
      [](const V& v) -> Number { return v.games_over; });
  add("skittles", "whole", "",
      "skittles down that count, of all games of the version, without points for bonus",
      [](const V& v) -> Number { return v.skittles; });
  add("throws", "whole", "", "balls let go, of all games of the version",
      [](const V& v) -> Number { return v.throws; });
  add("fouls", "whole", "", "of them beyond the foul line",
      [](const V& v) -> Number { return v.fouls; });
  add("release_speed_mps", "number", "m/s", "of the balls as they left the hand, mean",
      [](const V& v) { return v.release_speed(); });
  add("hand_path_m", "number", "m", "way of the hand in the room, of places 0.1 s apart",
      [](const V& v) -> Number { return v.hand_path_m; });
  add("head_path_m", "number", "m", "way of the head in the room, likewise",
      [](const V& v) -> Number { return v.head_path_m; });
  add("approaches", "whole", "", "times that a ball or a skittle flew at the player",
      [](const V& v) -> Number { return v.approaches; });
  add("evaded", "whole", "",
      "of them, those that head or hand got out of the way of; one that was under way as the version "
      "ended is not among them",
      [](const V& v) -> Number { return v.evaded; });
}

void add_recording(std::vector<Filled>& all) {
  const auto add = [&](const char* name, const char* kind, const char* unit, const char* meaning,
                       auto value) {
    all.push_back({{name, kind, unit, meaning}, [=](const Person& p) -> std::string {
                     return p.played.run.empty() ? std::string(kNoAnswer) : value(p.played);
                   }});
  };
  add("duration_s", "number", "s", "of the session",
      [](const Played& p) { return number(p.measures.duration_s); });
  add("longest_gap_s", "number", "s", "longest time without a sample of any device",
      [](const Played& p) { return number(p.longest_gap_s); });
  add("lost_samples", "whole", "", "holes in the devices' counts",
      [](const Played& p) { return fmt::format("{}", p.lost); });
  add("bad_samples", "whole", "", "samples that the tracker flagged",
      [](const Played& p) { return fmt::format("{}", p.bad); });
  add("frame_rate_hz", "number", "Hz", "frames drawn a second of a live session",
      [](const Played& p) { return number(p.frame_rate_hz); });
  add("unsolved_islands", "whole", "", "groups of bodies the solver stopped at its last pass",
      [](const Played& p) { return fmt::format("{}", p.measures.unsolved_islands); });
  add("state_hash", "hash", "", "of the last tick of the replay",
      [](const Played& p) { return p.measures.state_hash; });
  add("game_hash", "hash", "", "of all ticks of the replay",
      [](const Played& p) { return p.measures.game_hash; });
  add("replays", "yes/no", "", "the game hash that the recording says is that of its replay",
      [](const Played& p) { return yes_no(p.replays); });
  add("trial_sha256", "hash", "", "of the recording's bytes",
      [](const Played& p) { return p.sha256; });
}

std::vector<Filled> columns_of(const Design& design, const Questionnaire& questions) {
  std::vector<Filled> all;
  add_plan(design, questions, all);
  add_answers(questions, all);
  add_version(false, all);
  add_version(true, all);
  add_recording(all);
  return all;
}

}  // namespace

bool Person::is_virtual() const {
  return played.run.empty() ? played.is_virtual || has_drawn_answers() : played.is_virtual;
}

bool Person::has_drawn_answers() const {
  return std::ranges::any_of(answers, [](const Answer& one) { return one.source == kDrawn; });
}

bool is_in_other_order(const Person& person) {
  const std::optional<bool> changed = played_changed_first(person);
  return changed && *changed != person.planned.allotted.changed_first;
}

bool has_other_games(const Person& person) {
  return std::ranges::any_of(person.played.measures.versions, [](const auto& version) {
    return !version.second.is_one_whole_game();
  });
}

std::string why_not(const Design& design, const Questionnaire& questions, const Person& person) {
  if (!person.replaced_by.empty()) return "dropped out, replaced by " + person.replaced_by;
  const bool drawn = !person.answers.empty() && person.answers.front().source == kDrawn;
  const bool played_in_vain = person.played.run.empty() && person.played.runs > 0;
  if (played_in_vain) return "no session that counts: " + person.played.why_not;
  if (person.played.run.empty() && !drawn) return "no session that counts";
  if (!person.is_virtual() && person.has_drawn_answers()) {
    return "a person's session with drawn answers";
  }
  if (!missing(questions, person.answers).empty()) return "questions not answered";
  if (!score_of(questions, person.answers)) return "no answer to a scored item";
  if (!values_of(design, person.planned.allotted, person.answers)) {
    return "no answer to an item of the model";
  }
  return {};
}

std::vector<Column> people_columns(const Design& design, const Questionnaire& questions) {
  std::vector<Column> columns;
  for (const Filled& one : columns_of(design, questions)) columns.push_back(one.column);
  return columns;
}

std::string people_csv(const Design& design, const Questionnaire& questions,
                       const std::vector<Person>& people) {
  const std::vector<Filled> columns = columns_of(design, questions);
  std::vector<std::string> cells;
  for (const Filled& one : columns) cells.push_back(one.column.name);
  std::string text = csv_line(cells);
  for (const Person& person : people) {
    for (std::size_t i = 0; i < columns.size(); ++i) cells[i] = columns[i].value(person);
    text += csv_line(cells);
  }
  return text;
}

}  // namespace headpin::study
