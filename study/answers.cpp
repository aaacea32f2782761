#include "study/answers.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/csv.h"

namespace headpin::study {

namespace {

const std::vector<std::string> kAnswerColumns = {"participant", "item", "answer", "source"};

std::string ids_of(const Questionnaire& questions) {
  std::string all;
  for (const Item& item : questions.items) all += (all.empty() ? "" : ", ") + item.id;
  return all;
}

const Item& item_of(const CsvTable& table, const CsvRow& row, const Questionnaire& questions,
                    const std::string& id) {
  const Item* item = questions.find(id);
  if (!item) refuse(table, row, "an item of the questionnaire (" + ids_of(questions) + ")", id);
  return *item;
}

std::string read_answer(const CsvTable& table, const CsvRow& row, const Item& item,
                        const std::string& cell) {
  const auto answer = answer_of(item, cell);
  if (!answer) refuse(table, row, fmt::format("for {} {}", item.id, allowed(item)), cell);
  return *answer;
}

void add(const CsvTable& table, const CsvRow& row, Answers& answers, Answer answer) {
  if (const Answer* before = find(answers, answer.item)) {
    refuse(table, row,
           fmt::format("one answer to {}; {} is given already", answer.item, before->answer),
           answer.answer);
  }
  answers.push_back(std::move(answer));
}

std::string read_participant(const CsvTable& table, const CsvRow& row,
                             const std::set<std::string>& names) {
  const std::string& name = table.cell(row, "participant");
  if (!names.contains(name)) refuse(table, row, "a participant of the plan", name);
  return name;
}

/// Reads a table with one row per participant.
std::map<std::string, Answers> parse_wide(const CsvTable& table, const Questionnaire& questions,
                                          const std::set<std::string>& names) {
  for (const std::string& column : table.columns) {
    if (column != "participant") item_of(table, CsvRow{1, {}}, questions, column);
  }
  std::map<std::string, Answers> all;
  for (const CsvRow& row : table.rows) {
    const std::string name = read_participant(table, row, names);
    if (all.contains(name)) refuse(table, row, "one row a participant", name);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i] == "participant") continue;
      const Item& item = *questions.find(table.columns[i]);
      add(table, row, all[name], {item.id, read_answer(table, row, item, row.cells[i]), kForm});
    }
  }
  return all;
}

}  // namespace

const Answer* find(const Answers& answers, std::string_view item) {
  const auto found = std::ranges::find(answers, item, &Answer::item);
  return found == answers.end() ? nullptr : &*found;
}

std::string answers_heading() {
  return csv_line(kAnswerColumns);
}

std::string answer_line(const std::string& participant, const Answer& answer) {
  return csv_line({participant, answer.item, answer.answer, answer.source});
}

Answers parse_answers(std::string_view text, const std::string& where,
                      const Questionnaire& questions, const std::string& participant) {
  Answers answers;
  if (text.empty()) return answers;
  const CsvTable table = parse_csv(text, where);
  if (table.columns != kAnswerColumns) {  // more answers are added as they stand there
    refuse(table, CsvRow{1, {}}, fmt::format("the columns {}", fmt::join(kAnswerColumns, ", ")),
           fmt::format("{}", fmt::join(table.columns, ", ")));
  }
  for (const CsvRow& row : table.rows) {
    const std::string& name = table.cell(row, "participant");
    if (name != participant) refuse(table, row, "answers of " + participant, name);
    const Item& item = item_of(table, row, questions, table.cell(row, "item"));
    const std::string& source = table.cell(row, "source");
    if (source != kAsked && source != kForm && source != kDrawn) {
      refuse(table, row, fmt::format("{}, {} or {}", kAsked, kForm, kDrawn), source);
    }
    add(table, row, answers,
        {item.id, read_answer(table, row, item, table.cell(row, "answer")), source});
  }
  return answers;
}

std::map<std::string, Answers> parse_forms(std::string_view text, const std::string& where,
                                           const Questionnaire& questions,
                                           const std::set<std::string>& names) {
  const CsvTable table = parse_csv(text, where);
  table.require("participant");
  if (!table.find("item")) return parse_wide(table, questions, names);
  std::map<std::string, Answers> all;
  for (const CsvRow& row : table.rows) {
    const std::string name = read_participant(table, row, names);
    const Item& item = item_of(table, row, questions, table.cell(row, "item"));
    add(table, row, all[name],
        {item.id, read_answer(table, row, item, table.cell(row, "answer")), kForm});
  }
  return all;
}

std::vector<const Item*> missing(const Questionnaire& questions, const Answers& answers) {
  std::vector<const Item*> items;
  for (const Item& item : questions.items) {
    if (!find(answers, item.id)) items.push_back(&item);
  }
  return items;
}

std::optional<int> score_of(const Questionnaire& questions, const Answers& answers) {
  int high = 0;
  for (const Item& item : questions.items) {
    if (!item.counts_from) continue;
    const Answer* answer = find(answers, item.id);
    const auto value = answer ? whole_in(answer->answer) : std::nullopt;
    if (!value) return std::nullopt;
    high += *value >= *item.counts_from;
  }
  return high;
}

}  // namespace headpin::study
