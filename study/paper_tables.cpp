#include "study/paper_tables.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "study/csv.h"

namespace headpin::study {

namespace {

const Column kPeople = {"people", "whole", "", "how many of those who are counted"};
const Column kPublishedPeople = {"published", "whole", "",
                                 "how many were published; n/a where none were"};
const Column kVirtual = {
    "virtual", "text", "",
    "yes: of virtual participants; no: of people; mixed: of both; n/a: of nobody"};

std::string count(std::int64_t n) {
  return fmt::format("{}", n);
}

/// The published number of this answer to an item; nothing if none are published.
std::optional<int> published_count(const Design& design, const std::string& item,
                                   std::optional<std::size_t> changed, const std::string& answer) {
  for (const PublishedAnswers& one : design.published) {
    if (one.item != item || one.changed != changed) continue;
    for (const auto& [text, people] : one.counts) {
      if (text == answer) return people;
    }
    return 0;
  }
  return std::nullopt;
}

std::string or_none(const std::optional<int>& value) {
  return value ? count(*value) : std::string(kNoAnswer);
}

/// Percentage of `all`, rounded to whole numbers as in the paper.
std::string percent(std::int64_t part, std::int64_t all) {
  return all == 0 ? std::string(kNoAnswer) : count((200 * part + all) / (2 * all));
}

Table table_2(const Design& design, const std::vector<Person>& counted, const std::string& of) {
  Table table{"table-2", "Experimental design: participants who are counted", {}, {}};
  table.columns = {
      {"cell", "text", "", "values of the base version, a digit a factor: " + design.letters()},
      {"changed", "text", "", "parameter that changes"},
      kPeople,
      {"design", "whole", "", "how many the design has in a block"},
      kVirtual};
  for (std::size_t row = 0; row < design.rows.size(); ++row) {
    const auto people = std::ranges::count_if(
        counted, [&](const Person& one) { return one.planned.allotted.row == row; });
    table.rows.push_back({design.rows[row].cell, design.factors[design.rows[row].changed].key,
                          count(people), count(design.rows[row].people), of});
  }
  table.rows.push_back({"total", "", count(std::ssize(counted)), count(design.block()), of});
  return table;
}

Table table_3(const Design& design, const Item& sick, const std::vector<Person>& counted,
              const std::string& of) {
  Table table{"table-3", "Reported sickness level", {}, {}};
  table.columns = {{"level", "text", "", "answer to the question of sickness"},
                   kPeople,
                   {"percent", "whole", "%", "of all, rounded"},
                   kPublishedPeople,
                   {"published_percent", "whole", "%", "likewise, of what was published"},
                   kVirtual};
  int published_sum = 0;
  bool published = true;
  for (int level = sick.low; level <= sick.high; ++level) {
    const auto one = published_count(design, sick.id, std::nullopt, count(level));
    published = published && one.has_value();
    published_sum += one.value_or(0);
  }
  std::array<std::int64_t, 2> percents{};
  const auto all = std::ssize(counted);
  for (int level = sick.low; level <= sick.high; ++level) {
    const std::string answer = count(level);
    const auto people = std::ranges::count_if(counted, [&](const Person& one) {
      const Answer* given = find(one.answers, sick.id);
      return given && given->answer == answer;
    });
    const auto before = published_count(design, sick.id, std::nullopt, answer);
    table.rows.push_back({answer, count(people), percent(people, all), or_none(before),
                          published ? percent(*before, published_sum) : kNoAnswer, of});
    percents[0] += whole_in(table.rows.back()[2]).value_or(0);
    percents[1] += whole_in(table.rows.back()[4]).value_or(0);
  }
  table.rows.push_back({"total", count(all), count(percents[0]),
                        published ? count(published_sum) : kNoAnswer,
                        published ? count(percents[1]) : kNoAnswer, of});
  return table;
}

Table table_4(const Design& design, const Item& noticed, const std::vector<Person>& counted,
              const std::string& of) {
  Table table{
      "table-4", "Response to parameter changes: participants who perceived the change", {}, {}};
  table.columns = {{"changed", "text", "", "parameter that changed"},
                   {"noticed", "text", "", "whether a difference was noticed"},
                   kPeople,
                   kPublishedPeople,
                   kVirtual};
  for (std::size_t factor = 0; factor < design.factors.size(); ++factor) {
    for (const Choice& choice : noticed.choices) {
      const auto people = std::ranges::count_if(counted, [&](const Person& one) {
        const Answer* given = find(one.answers, noticed.id);
        return design.rows[one.planned.allotted.row].changed == factor && given &&
               given->answer == choice.id;
      });
      table.rows.push_back({design.factors[factor].key, choice.id, count(people),
                            or_none(published_count(design, noticed.id, factor, choice.id)), of});
    }
  }
  return table;
}

}  // namespace

std::vector<Table> paper_tables(const Design& design, const Questionnaire& questions,
                                const std::vector<Person>& counted, const std::string& of) {
  std::vector<Table> tables = {table_2(design, counted, of)};
  const Item* sick = questions.find("sick");
  if (sick && sick->is_scale()) tables.push_back(table_3(design, *sick, counted, of));
  const Item* noticed = questions.find("noticed");
  if (noticed && !noticed->is_scale()) tables.push_back(table_4(design, *noticed, counted, of));
  return tables;
}

std::string to_csv(const Table& table) {
  std::vector<std::string> names;
  for (const Column& column : table.columns) names.push_back(column.name);
  std::string text = csv_line(names);
  for (const auto& row : table.rows) text += csv_line(row);
  return text;
}

std::string in_words(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t width = table.columns[i].name.size();
    for (const auto& row : table.rows) width = std::max(width, row[i].size());
    widths.push_back(width);
  }
  std::string text = table.title + "\n";
  const auto add = [&](auto cell) {
    std::string line;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      line += fmt::format("  {:<{}}", cell(i), widths[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  };
  add([&](std::size_t i) { return table.columns[i].name; });
  for (const auto& row : table.rows) add([&](std::size_t i) { return row[i]; });
  return text;
}

}  // namespace headpin::study
