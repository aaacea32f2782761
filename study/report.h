#pragma once

#include <map>
#include <string>
#include <vector>

#include "study/paper_tables.h"
#include "study/people.h"

namespace headpin::study {

/// Further parts of a report that it does not compute itself.
struct ReportParts {
  std::vector<Table> tables;          ///< in their order; Tables 5 and 6 among them, if any
  std::vector<std::string> pictures;  ///< SVG documents
  /// By participant: the path of the page of the trial, to be opened from the report's folder.
  std::map<std::string, std::string> pages;
  /// Why there is no analysis of these participants; empty if there is one, or none at all.
  std::string left_out = {};
};

/// Text escaped for HTML and SVG.
std::string escaped(const std::string& text);

/// A study as one HTML page that needs nothing else: design, who played what, tables beside the
/// published ones, pictures, answers, and every throw as a small picture.
std::string html_report(const Design& design, const Questionnaire& questions,
                        const std::vector<Person>& people, const ReportParts& parts);

}  // namespace headpin::study
