#pragma once

#include <string>
#include <vector>

#include "study/people.h"

namespace headpin::study {

/// Tables 2, 3 and 4 of the paper, for the counted participants, next to the published values.
struct Table {
  std::string name;  ///< table-2
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
};

/// @param of  "yes" for virtual participants, "no" for people, "mixed", "n/a" for nobody: stands in a column
std::vector<Table> paper_tables(const Design& design, const Questionnaire& questions,
                                const std::vector<Person>& counted, const std::string& of);

std::string to_csv(const Table& table);
/// In columns for a terminal.
std::string in_words(const Table& table);

}  // namespace headpin::study
