#include "apps/answer_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "apps/streams.h"
#include "study/csv.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

/// Whether a line without an end is only the beginning of one that headpin writes: of the heading, of
/// the cells, or of the word of the source.
bool is_torn(std::string_view line, bool is_heading) {
  if (line.empty()) return false;
  if (is_heading) return study::answers_heading().starts_with(line);
  if (std::ranges::count(line, ',') < 3) return true;
  const std::string_view last = line.substr(line.rfind(',') + 1);
  const std::array<std::string_view, 3> sources = {study::kAsked, study::kForm, study::kDrawn};
  return std::ranges::any_of(
      sources, [&](std::string_view source) { return source != last && source.starts_with(last); });
}

/// Lines are added as answer_line() writes them.
void require_commas(const std::string& text, const std::string& path) {
  if (text.empty() || study::parse_csv(text, path).separator == ',') return;
  throw std::runtime_error(path +
                           ":1: expected commas between the columns, found semicolons or tabs; "
                           "save the file as CSV with commas");
}

}  // namespace

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
  const std::string whole = file_->whole_lines(), rest = file_->text().substr(whole.size());
  const bool torn = is_torn(rest, whole.empty());
  const std::string& text = torn ? whole : file_->text();
  require_commas(text, path_.string());
  answers = study::parse_answers(text, path_.string(), study.questions, id);
  if (!torn) return;
  say("{}: its last line is no whole answer, as a crash leaves it; removed: {}\n", path_.string(),
      study::shown(rest));
  file_->cut_last_line();
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

}  // namespace headpin::apps
