// Tables of `export`, changed or not, become a trial again.

#include "devices/log/event_log.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

const std::string kTrial = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

class TablesAgain : public CommandLine {
 protected:
  TablesAgain() { EXPECT_EQ(headpin("export " + kTrial + " -o tables").code, 0); }

  std::vector<std::string> lines(const std::string& table) const {
    std::vector<std::string> all;
    std::istringstream text(slurp(folder_ / "tables" / table));
    for (std::string line; std::getline(text, line);) all.push_back(line);
    return all;
  }
  void put(const std::string& table, const std::vector<std::string>& lines) const {
    std::ofstream file(folder_ / "tables" / table);
    for (const std::string& line : lines) file << line << '\n';
  }
};

TEST_F(TablesAgain, AreTheTrialTheyCameFrom) {
  for (const char* from : {"tables", "tables/", "tables/trackers.csv"}) {
    const nlohmann::json made =
        json(std::string("import --json --force ") + from + " -o again.lcmlog");
    EXPECT_EQ(made["samples"], 843) << from;
    EXPECT_EQ(json("replay --json again.lcmlog")["game_hash"],
              json("replay --json " + kTrial)["game_hash"]);
  }
  ASSERT_EQ(headpin("export again.lcmlog -o twice").code, 0);
  for (const char* table : {"trackers.csv", "buttons.csv", "events.csv", "scenario.toml"}) {
    EXPECT_EQ(slurp(folder_ / "twice" / table), slurp(folder_ / "tables" / table)) << table;
  }
  EXPECT_EQ(json("info --json again.lcmlog")["participant"], "demo");
  ASSERT_EQ(headpin("import tables -o named.lcmlog --participant p7").code, 0);
  EXPECT_EQ(json("info --json named.lcmlog")["participant"], "p7");
}

// As a spreadsheet or a program leaves them: other columns, another order, True for 1, no buttons' times of arrival.
TEST_F(TablesAgain, MayHaveFewerColumnsInAnotherOrder) {
  std::vector<std::string> few = {
      "note;qw;qx;qy;qz;station;x_m;y_m;z_m;device_time_s;host_time_s\r"};
  for (const std::string& line : lines("trackers.csv")) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells[0] == "device_time_s") continue;
    std::string out = "mine";
    for (const int column : {8, 9, 10, 11, 3, 5, 6, 7, 0, 1}) {
      std::string cell = cells[static_cast<std::size_t>(column)];
      std::ranges::replace(cell, '.', ',');
      out += ";" + cell;
    }
    few.push_back(out + '\r');
  }
  put("trackers.csv", few);
  put("buttons.csv",
      {"trigger;device_time_s;left_thumb;right_thumb", "True;1,2;False;0,0", "0,0;3,94822;False;"});
  fs::remove(folder_ / "tables/events.csv");
  fs::remove(folder_ / "tables/trial.json");
  ASSERT_EQ(headpin("import tables -o again.lcmlog").code, 0);
  EXPECT_EQ(json("replay --json again.lcmlog")["game_hash"],
            json("replay --json " + kTrial)["game_hash"]);
}

// R reads the frame T as a truth, and a blank status as none.
TEST_F(TablesAgain, MayComeFromR) {
  std::vector<std::string> all;
  for (const std::string& line : lines("trackers.csv")) {
    const bool names = line.find("device_time_s") != std::string::npos;
    std::string out;
    std::istringstream row(line), header(lines("trackers.csv")[0]);
    for (std::string cell, name; std::getline(header, name, ',');) {
      std::getline(row, cell, ',');
      if (!names && name == "frame") cell = "TRUE";
      if (!names && name == "status") cell = "NA";
      out += (out.empty() ? "" : ",") + cell;
      cell.clear();
    }
    all.push_back(out);
  }
  put("trackers.csv", all);
  ASSERT_EQ(headpin("import tables -o again.lcmlog").code, 0);
  EXPECT_EQ(json("replay --json again.lcmlog")["game_hash"],
            json("replay --json " + kTrial)["game_hash"]);
}

// A hand twice as far from its first place throws a faster ball.
TEST_F(TablesAgain, ThatWereChangedAreAnotherThrow) {
  std::vector<std::string> all = lines("trackers.csv");
  for (std::string& line : all) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells[3] != "2") continue;
    cells[5] = std::to_string(2.069 + 1.2 * (std::stod(cells[5]) - 2.069));
    cells[6] = std::to_string(-0.395 + 1.2 * (std::stod(cells[6]) + 0.395));
    cells[7] = std::to_string(-0.108 + 1.2 * (std::stod(cells[7]) + 0.108));
    line.clear();
    for (const std::string& cell : cells) line += (line.empty() ? "" : ",") + cell;
  }
  put("trackers.csv", all);
  ASSERT_EQ(headpin("import tables -o faster.lcmlog").code, 0);
  const double was = json("replay --json " + kTrial)["release_speed_mps"],
               is = json("replay --json faster.lcmlog")["release_speed_mps"];
  EXPECT_GT(is / was, 1.1);  // a part of it is from the turn of the hand, which stays
  EXPECT_LT(is / was, 1.2);
}

TEST_F(TablesAgain, SayWhereTheyAreWrong) {
  const std::vector<std::string> right = lines("trackers.csv");
  const auto with = [&](std::size_t line, const std::string& from, const std::string& to) {
    std::vector<std::string> all = right;
    const std::size_t at = all[line].find(from);
    ASSERT_NE(at, std::string::npos) << from;
    all[line].replace(at, from.size(), to);
    put("trackers.csv", all);
  };
  with(2, "0.008333,", "soon,");
  expect_refusal("import tables -o OUT.lcmlog", 1,
                 "tables/trackers.csv:3: column device_time_s: expected a number, found 'soon'");
  with(2, ",2,T,", ",2,W,");
  expect_refusal("import tables -o OUT.lcmlog", 1, "trackers.csv:3: column frame: expected T");
  with(2, ",2,T,", ",two,T,");
  expect_refusal("import tables -o OUT.lcmlog", 1,
                 "trackers.csv:3: column station: expected a number");
  with(1, "0.8617308111089731", "8.6");
  expect_refusal("import tables -o OUT.lcmlog", 1,
                 "trackers.csv:2: column qw: expected a unit quaternion");
  with(1, "0.8617308111089731", "");
  expect_refusal("import tables -o OUT.lcmlog", 1, "trackers.csv:2: column qw: expected a value");
  put("trackers.csv", {right[0]});
  expect_refusal("import tables -o OUT.lcmlog", 1, "trackers.csv: expected samples, found none");
  put("trackers.csv", right);
  expect_refusal("import tables -o OUT.lcmlog --heading keep", 2,
                 "--heading: tables is a complete trial");
  expect_refusal("import tables --explain -o OUT.toml", 2, "--output: tables is a complete trial");
  put("buttons.csv", {"device_time_s,trigger", "1.2,pressed"});
  expect_refusal("import tables -o OUT.lcmlog", 1,
                 "buttons.csv:2: column trigger: expected 1 or 0");
  put("buttons.csv", {"device_time_s,trigger"});
  std::vector<std::string> scenario = lines("scenario.toml");
  const auto mass = std::ranges::find_if(
      scenario, [](const std::string& line) { return line.starts_with("mass = "); });
  ASSERT_NE(mass, scenario.end());
  *mass = "mass = 'heavy'";
  put("scenario.toml", scenario);
  expect_refusal("import tables -o OUT.lcmlog", 1, "tables/scenario.toml");
  fs::remove(folder_ / "tables/scenario.toml");
  expect_refusal("import tables -o OUT.lcmlog", 1,
                 "scenario.toml: expected the scenario of the trial");
}

// Averages of quaternions are shorter than 1; a filter's are made unit ones, which is said.
TEST_F(TablesAgain, MakeRotationsOfAverages) {
  std::vector<std::string> all = lines("trackers.csv");
  const std::string whole =
      "0.8617308111089731,0.13614671504239317,-0.34637028155471083,0.34483577138160615";
  const std::size_t at = all[1].find(whole);
  ASSERT_NE(at, std::string::npos);
  all[1].replace(at, whole.size(),
                 "0.8186442705535244,0.12933937929027351,-0.32905176747697529,0.32759398281252584");
  put("trackers.csv", all);
  const Result made = headpin("import tables -o again.lcmlog");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("1 rotations were no unit quaternions, and are made so"));
  ASSERT_EQ(headpin("export again.lcmlog -o twice").code, 0);
  std::istringstream twice(slurp(folder_ / "twice/trackers.csv"));
  std::string line;
  std::getline(twice, line);
  std::getline(twice, line);
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  EXPECT_NEAR(std::stod(cells[8]), 0.8617308111089731, 1e-12);
  EXPECT_NEAR(std::stod(cells[10]), -0.34637028155471083, 1e-12);
}

// What a live session told at its end is no event of a tick when it comes back.
TEST_F(TablesAgain, OfALiveSessionAreReplayedToALogWithTheStampsOfItsTicks) {
  std::vector<std::string> all = lines("events.csv");
  all.push_back("7.008333,-1,kept_pace,,0,0,0,0,0,0,0,");
  put("events.csv", all);
  ASSERT_EQ(headpin("import tables -o again.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay again.lcmlog -o played.lcmlog").code, 0);
  const std::string text = slurp(folder_ / "played.lcmlog");
  devices::LogReader log(
      std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  std::set<Time> of_states;
  Time last{};
  while (const std::optional<devices::LogEvent> event = log.next()) {
    EXPECT_GE(event->time, last);
    last = event->time;
    if (event->channel.starts_with("STATE")) of_states.insert(event->time);
  }
  EXPECT_GT(of_states.size(), 1600u);  // 1682 ticks
  EXPECT_THAT(slurp(folder_ / "played.lcmlog"), HasSubstr("kept_pace"));
}

}  // namespace
}  // namespace headpin
