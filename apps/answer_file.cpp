#include "apps/answer_file.h"

#include <fmt/format.h>

#include "apps/streams.h"
#include "study/csv.h"

namespace headpin::apps {

namespace fs = std::filesystem;

void refuse_others(const study::Answers& there, const study::Answers& others,
                   const std::string& from, const fs::path& path, const std::string& id) {
  for (const study::Answer& answer : others) {
    const study::Answer* before = study::find(there, answer.item);
    if (!before || before->answer == answer.answer) continue;
    throw std::runtime_error(fmt::format("{}: {} has answered {} to {}; {} says {}", path.string(),
                                         id, before->answer, answer.item, from, answer.answer));
  }
}

AnswerFile::AnswerFile(const Study& study, const std::string& id)
    : id_(id), path_(study.at.answers(id)) {
  fs::create_directories(path_.parent_path());
  file_.emplace(path_.string());
  const auto read = [&](const std::string& text) {
    return study::parse_answers(text, path_.string(), study.questions, id);
  };
  try {
    answers = read(file_->text());
  } catch (const std::exception&) {
    if (file_->whole_lines() == file_->text()) throw;
    answers = read(file_->whole_lines());  // a crash may have left a part of a line
    say("{}: its last line is no whole answer, as a crash leaves it: removed\n", path_.string());
    file_->cut_last_line();
  }
  require_commas();
}

void AnswerFile::add(const study::Answers& more) {
  std::string lines;
  if (answers.empty() && file_->text().empty()) lines = study::answers_heading();
  for (const study::Answer& answer : more) lines += study::answer_line(id_, answer);
  file_->append(lines);
  answers.insert(answers.end(), more.begin(), more.end());
}

std::size_t AnswerFile::add_all(const study::Answers& others, const std::string& from) {
  refuse_others(answers, others, from, path_, id_);
  study::Answers more;
  for (const study::Answer& answer : others) {
    if (!study::find(answers, answer.item)) more.push_back(answer);
  }
  if (!more.empty()) add(more);
  return more.size();
}

/// Lines are added as answer_line() writes them.
void AnswerFile::require_commas() const {
  const std::string& text = file_->text();
  if (text.empty() || study::parse_csv(text, path_.string()).separator == ',') return;
  throw std::runtime_error(path_.string() +
                           ":1: expected commas between the columns, found semicolons or tabs; "
                           "save the file as CSV with commas");
}

}  // namespace headpin::apps
