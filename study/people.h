#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/answers.h"
#include "study/measures.h"
#include "study/model.h"
#include "study/plan.h"

/// The table of participants: one row each, with a description of the columns.
namespace headpin::study {

/// A recording of a session, and its measures.
struct Played {
  std::string run;           ///< run-01; empty where no session counts
  int runs = 0;              ///< recordings in all
  std::string why_not = {};  ///< where none of the recordings counts: what is wrong with the last
  bool is_virtual = false;
  double longest_gap_s = 0.0;  ///< without a sample
  std::int64_t lost = 0, bad = 0;
  std::optional<double> frame_rate_hz;  ///< of a live session
  bool replays = true;                  ///< the trial's game hash is that of its replay
  std::string sha256;
  SessionMeasures measures;
};

struct Person {
  PlannedParticipant planned;
  std::string replaced_by = {};
  Answers answers;
  Played played;

  /// A virtual participant played the session that counts, or nobody did, and an answer was drawn.
  bool is_virtual() const;
  /// An answer was drawn from a model.
  bool has_drawn_answers() const;
};

/// Whether a session was played in another order than the plan has. It counts all the same.
bool is_in_other_order(const Person& person);

/// Whether a version was played more than once, or not to its end. It counts all the same, with all of
/// its games.
bool has_other_games(const Person& person);

/// The reason why a participant does not count; empty for one who counts.
std::string why_not(const Design& design, const Questionnaire& questions, const Person& person);

/// One column of a table of the study.
struct Column {
  std::string name;  ///< with the unit last
  std::string kind;  ///< number, whole, text, yes/no or hash
  std::string unit;
  std::string meaning;
};

/// The columns of participants.csv, which depend on factors and questions.
std::vector<Column> people_columns(const Design& design, const Questionnaire& questions);

/// The table, CSV.
std::string people_csv(const Design& design, const Questionnaire& questions,
                       const std::vector<Person>& people);

}  // namespace headpin::study
