// The table and the JSON of `headpin apart`.

#include <cmath>
#include <sstream>

#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

/// The numbers of an object whose names end in _s, and those of its parts.
void collect_times(const nlohmann::json& object, std::vector<double>& times) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_structured()) collect_times(value, times);
    if (value.is_number() && name.ends_with("_s")) times.push_back(value.get<double>());
  }
}

/// The numbers in the columns whose names end in _s.
std::vector<double> times_of_table(const std::string& csv) {
  std::vector<std::string> names;
  std::vector<double> times;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::size_t column = 0;
    const bool head = names.empty();
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (head) {
        names.push_back(cell);
      } else if (!cell.empty() && names.at(column).ends_with("_s")) {
        times.push_back(std::stod(cell));
      }
    }
  }
  return times;
}

// A time is a whole number of microseconds, and prints as it does in events.csv: 6.15, not 6.1499999999999995.
TEST_F(TrialCommands, ApartPrintsTimesAsTheTablesDo) {
  const nlohmann::json apart = json("apart --json " + kDemo + " --friction 0 -o apart.csv");
  std::vector<double> times;
  collect_times(apart, times);
  for (const nlohmann::json& body : apart["apart"]) {
    if (body["contact"].is_null()) continue;
    for (const char* of : {"a", "b"}) times.push_back(body["contact"][of].get<double>());
  }
  const std::vector<double> table = times_of_table(slurp(folder_ / "apart.csv"));
  EXPECT_GT(times.size(), 10u);
  EXPECT_GT(table.size(), 10u);
  times.insert(times.end(), table.begin(), table.end());
  for (const double time : times) EXPECT_EQ(time, std::round(1e6 * time) / 1e6);
}

}  // namespace
}  // namespace headpin
