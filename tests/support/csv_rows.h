#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace headpin {

/// Rows of a table whose cells have no commas, by the names of its columns.
inline std::vector<std::map<std::string, std::string>> csv_rows(const std::string& text) {
  std::istringstream lines(text);
  std::string line, cell;
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::vector<std::string> all;
    while (std::getline(cells, cell, ',')) all.push_back(cell);
    if (names.empty()) {
      names = all;
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < all.size(); ++i) row[names[i]] = all[i];
  }
  return rows;
}

}  // namespace headpin
