#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/study_folder.h"
#include "base/line_file.h"
#include "study/answers.h"

namespace headpin::apps {

/// Throws if other answers would change existing ones.
/// @param from  where the others come from
void refuse_others(const study::Answers& there, const study::Answers& others,
                   const std::string& from, const std::filesystem::path& path,
                   const std::string& id);

/// The answers in a participant's file, only read; none without a file. A last line that is torn, as a
/// crash leaves it, is left out, and said.
/// @throws std::invalid_argument  as study::parse_answers()
study::Answers answers_of(const Study& study, const std::string& id);

/// Whether a person plays the participant, as of_person(): then the answers are a person's too.
bool plays_as_person(const Study& study, const std::string& id);

/// The first answer that a person gave, by which no missing ones are drawn; null if there is none.
const study::Answer* given_by_person(const study::Answers& answers);

/// Leaves those that a person gave.
void leave_out_drawn(study::Answers& answers);

/// The file of a participant's answers; answers can be added. The study must live as long.
class AnswerFile {
 public:
  /// @throws base::Busy             when another headpin has it open
  /// @throws std::runtime_error     when it cannot be opened, or has no commas
  /// @throws std::invalid_argument  as study::parse_answers()
  AnswerFile(const Study& study, const std::string& id);

  /// Moves drawn answers to a file of their own, answers/NAME.drawn, and says so: then a person's can be
  /// given.
  void set_drawn_aside();

  /// Adds new answers, all or none.
  void add(const study::Answers& more);

  /// Adds the answers that do not exist yet.
  /// @return  their number
  /// @throws std::runtime_error  if an existing answer is different; then none is added
  std::size_t add_all(const study::Answers& others, const std::string& from);

  study::Answers answers;

 private:
  void open();

  const study::Questionnaire& questions_;
  std::string id_;
  std::filesystem::path path_;
  std::optional<base::LineFile> file_;
};

}  // namespace headpin::apps
