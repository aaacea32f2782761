#include "apps/answer_file.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "apps/streams.h"
#include "base/output_file.h"
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

/// The last line of a file, where it is torn; else nothing.
std::string_view torn_line(std::string_view text) {
  const std::size_t begin = text.find_last_of("\n\r") + 1;  // npos + 1 is 0
  const std::string_view last = text.substr(begin);
  return is_torn(last, begin == 0) ? last : std::string_view();
}

bool has_commas(std::string_view text, const std::string& path) {
  return text.empty() || study::parse_csv(text, path).separator == ',';
}

std::string lines_of(const std::string& id, const study::Answers& answers) {
  std::string lines = study::answers_heading();
  for (const study::Answer& answer : answers) lines += study::answer_line(id, answer);
  return lines;
}

/// A file for the drawn answers beside the others: a new one, or one that has them already.
fs::path aside_for(const fs::path& answers, const std::string& lines) {
  fs::path path = answers;
  path.replace_extension(".drawn");
  for (int number = 2; fs::exists(path) && read_study_file(path) != lines; ++number) {
    path.replace_extension(fmt::format(".drawn-{}", number));
  }
  return path;
}

/// Lines are added as answer_line() writes them.
void require_commas(const std::string& text, const std::string& path) {
  if (has_commas(text, path)) return;
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

study::Answers answers_of(const Study& study, const std::string& id) {
  const fs::path path = study.at.answers(id);
  if (!fs::exists(path)) return {};
  std::string text = read_study_file(path);
  const std::string torn(torn_line(text));
  const std::string whole = text.substr(0, text.size() - torn.size());
  if (!torn.empty() && has_commas(whole, path.string())) {
    text = whole;
    say("{}: its last line is no whole answer, as a crash leaves it; left out: {}\n", path.string(),
        study::shown(torn));
  }
  return study::parse_answers(text, path.string(), study.questions, id);
}

bool plays_as_person(const Study& study, const std::string& id) {
  return of_person(runs_of(study, id)) != nullptr;
}

const study::Answer* given_by_person(const study::Answers& answers) {
  const auto found = std::ranges::find_if(
      answers, [](const study::Answer& answer) { return answer.source != study::kDrawn; });
  return found == answers.end() ? nullptr : &*found;
}

void leave_out_drawn(study::Answers& answers) {
  std::erase_if(answers, [](const study::Answer& one) { return one.source == study::kDrawn; });
}

AnswerFile::AnswerFile(const Study& study, const std::string& id)
    : questions_(study.questions), id_(id), path_(study.at.answers(id)) {
  fs::create_directories(path_.parent_path());
  open();
}

void AnswerFile::open() {
  file_.emplace(path_.string());
  const std::string torn(torn_line(file_->text()));
  const std::string text = file_->text().substr(0, file_->text().size() - torn.size());
  require_commas(text, path_.string());
  answers = study::parse_answers(text, path_.string(), questions_, id_);
  if (torn.empty()) return;
  say("{}: its last line is no whole answer, as a crash leaves it; removed: {}\n", path_.string(),
      study::shown(torn));
  file_->cut_last_line();
}

void AnswerFile::set_drawn_aside() {
  study::Answers own = answers, drawn;
  leave_out_drawn(own);
  std::ranges::copy_if(answers, std::back_inserter(drawn),
                       [](const study::Answer& one) { return one.source == study::kDrawn; });
  if (drawn.empty()) return;
  const std::string lines = lines_of(id_, drawn);
  const fs::path aside = aside_for(path_, lines);
  if (!fs::exists(aside)) base::write_text({aside.string(), {}}, lines);
  base::write_text({path_.string(), {.overwrite = true, .locked = true}}, lines_of(id_, own));
  say("{}: a person answers for {}; {} drawn answers are kept in {}\n", path_.string(), id_,
      drawn.size(), aside.string());
  open();
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
