// docs/ says what the program says, and nothing that the program prints is missing there.

#include <regex>
#include <set>

#include <fmt/format.h>

#include "scene/scenario/scenario.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

const fs::path kDocs = HEADPIN_SOURCE_DIR "/docs";

class Reference : public CommandLine {
 protected:
  /// Every `name` of a page's first column.
  static std::set<std::string> told(const std::string& page) {
    std::set<std::string> names;
    std::istringstream lines(slurp(kDocs / page));
    static const std::regex pattern(R"(^\| `([^`]+)` \|.*)");
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (std::regex_match(line, match, pattern)) names.insert(match[1]);
    }
    EXPECT_GT(names.size(), 5u) << page;
    return names;
  }
};

TEST_F(Reference, PagesAreWhatTheProgramSays) {
  ASSERT_EQ(headpin("manual written").code, 0);
  int pages = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "written" / "docs")) {
    EXPECT_EQ(slurp(entry.path()), slurp(kDocs / entry.path().filename()))
        << entry.path().filename() << " differs; `./dev docs` writes it anew";
    EXPECT_THAT(slurp(kDocs / "README.md"), HasSubstr(entry.path().filename().string()));
    ++pages;
  }
  EXPECT_GE(pages, 5);
}

/// Names of all keys, at any depth; what stands below `channels` and `rows` are names of data.
void collect(const nlohmann::json& value, std::set<std::string>& names) {
  for (const auto& [name, item] : value.items()) {
    if (value.is_object()) names.insert(name);
    if (name == "channels") {
      for (const auto& channel : item) collect(channel, names);
    } else if (name != "elasticity" && name != "friction" && name != "rows") {
      if (item.is_structured()) collect(item, names);
    }
  }
}

TEST_F(Reference, EveryJsonKeyIsTold) {
  std::set<std::string> names;
  const auto take = [&](const std::string& arguments) { collect(json(arguments), names); };
  take("synthesize --json -o throw.lcmlog");
  take("synthesize --json --participant 7 --throws 1 -o session.lcmlog");
  take("import --json " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o found.lcmlog");
  take("import --json --explain " HEADPIN_SOURCE_DIR "/assets/throws/example.csv --units m");
  take("replay --json throw.lcmlog -o game.lcmlog");
  take("replay --json game.lcmlog --verify --from 1");
  take("replay --json session.lcmlog -o played.lcmlog");
  take("replay --json played.lcmlog --friction 0 --set game.ball_back_s=100");
  take("replay --json played.lcmlog --each-throw");
  take("replay --json throw.lcmlog -o other.lcmlog --set material.ball.friction=0.1");
  take("info --json game.lcmlog");
  // Without losses all comes bouncing back at who threw it.
  take(
      "replay --json session.lcmlog -o back.lcmlog --set version.red.elasticity=1 "
      "--set version.red.friction=0 --set version.blue.elasticity=1");
  take("info --json back.lcmlog");
  // A hand that is not there fells nothing.
  take("replay --json throw.lcmlog -o nothing.lcmlog --set rig.hand_station=3");
  take("info --json nothing.lcmlog");
  // A game that nobody plays has a sheet of no points.
  take("replay --json throw.lcmlog --set game.rules=plain");
  take("compare --json game.lcmlog other.lcmlog");
  take("export --json game.lcmlog -o tables");
  take("export --json game.lcmlog --gltf game.glb");
  take("export --json game.lcmlog --mcap game.mcap");
  take("export --json game.lcmlog --xdf game.xdf");
  take("plot --json game.lcmlog -o game.svg");
  take("frames --json game.lcmlog -o frames --frames 0-1");
  take("stream --json throw.lcmlog --lcm 'file://stream.lcmlog?mode=w' --speed 0");
  take("live --json --lcm file://throw.lcmlog --duration 0.1 --eyes none --record shown.lcmlog");
  take("info --json shown.lcmlog");
  take("experiment plan --json -o study --people 1");
  take("experiment run --json study --all --virtual");
  take("experiment status --json study");
  take("experiment ask --json study --all --virtual");
  take("experiment plan --json -o study --people 2");
  take("experiment score --json study");
  take("experiment export --json study --motion-bids data");
  take("experiment report --json study --mix -o study.html");
  take("experiment power --json --people 18 --studies 2");
  std::ofstream(folder_ / "sweep.toml") << "trials = ['throw.lcmlog']\n[grid]\n"
                                           "room.width = [4, 2.2]\nlane.width = [1.05, 2.4]\n";
  take("sweep plan --json sweep.toml -o sweep --estimate");
  take("sweep run --json sweep");
  take("sweep status --json sweep");
  take("sweep merge --json sweep -o sweep.csv");
  take("sweep report --json sweep -o sweep.html");
  take("sweep slurm --json sweep --minutes 5");
  take("apart --json throw.lcmlog --friction 0");
  take(
      "whatif --json played.lcmlog --costs --within 2 --speed 1 --direction 0 --height 0 --spin 0 "
      "--board -1:1:3");
  take("scenario list --json");
  take("emulate --json --motion still --duration 0.1");
  collect(nlohmann::json::parse(headpin("info --json missing.lcmlog").out), names);
  for (const auto& finding : json("doctor --json")) collect(finding, names);
  const std::set<std::string> known = told("json.md");
  for (const std::string& name : names) EXPECT_TRUE(known.contains(name)) << name;
  // What only a session with a Fastrak prints, and a server when it begins.
  const std::set<std::string> elsewhere = {
      "missed", "restarts", "skipped_bytes", "certificate_sha256", "links", "operator",
      // and what R comes to
      "degrees_of_freedom", "deviance", "endless_terms", "script_changed"};
  for (const std::string& name : known) {
    EXPECT_TRUE(names.contains(name) || elsewhere.contains(name)) << name << " is printed by none";
  }
}

TEST_F(Reference, EveryKindOfEventAndEveryChannelIsTold) {
  ASSERT_EQ(headpin("import " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o t.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay t.lcmlog -o game.lcmlog").code, 0);
  ASSERT_EQ(headpin("stream game.lcmlog --lcm 'file://s.lcmlog?mode=w' --speed 0").code, 0);
  const std::set<std::string> kinds = told("events.md"), channels = told("channels.md");
  std::set<std::string> seen;
  const nlohmann::json events = json("info --json game.lcmlog")["events"];
  for (const auto& event : events) {
    EXPECT_TRUE(kinds.contains(event["kind"])) << event["kind"];
    seen.insert(event["kind"]);
  }
  EXPECT_GE(seen.size(), 6u);
  for (const char* log : {"game.lcmlog", "s.lcmlog"}) {
    const nlohmann::json found = json(std::string("info --json ") + log)["channels"];
    for (const auto& [channel, ignored] : found.items()) {
      EXPECT_TRUE(channels.contains(channel)) << channel;
    }
  }
}

TEST_F(Reference, EveryKeyOfAScenarioIsToldAndEveryKeyToldIsOne) {
  const std::set<std::string> keys = told("scenario.md");
  std::set<std::string> written;
  std::istringstream lines(headpin("info " + kDemo + " --scenario").out);
  std::string section;
  std::smatch match;
  static const std::regex header(R"(^\[([\w.]+)\].*)"), key(R"(^(\w+) = .*)");
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, header)) section = match[1].str() + ".";
    if (std::regex_match(line, match, key)) written.insert(section + match[1].str());
  }
  EXPECT_GT(written.size(), 40u);
  for (const std::string& name : written) EXPECT_TRUE(keys.contains(name)) << name;
  for (const std::string& name : keys) {
    if (name.find("[]") != std::string::npos || written.contains(name)) continue;
    // A section that has something to say, or a key that the demo's older text lacks.
    const Result result = headpin("replay " + kDemo + " --set " + name + "=nonsense");
    EXPECT_THAT(result.err, testing::Not(HasSubstr("unknown key"))) << name;
  }
}

TEST_F(Reference, ATrialIsExportedWholeAndPlotted) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  const nlohmann::json rows = json("export --json game.lcmlog -o tables")["rows"];
  const nlohmann::json info = json("info --json game.lcmlog");
  EXPECT_EQ(rows["trackers"], info["channels"]["TRACKER"]["messages"]);
  EXPECT_EQ(rows["buttons"], info["channels"]["MOUSE3D"]["messages"]);
  EXPECT_EQ(rows["events"], info["events"].size());
  EXPECT_EQ(rows["throws"], 1);
  EXPECT_EQ(info["result"]["throws"].size(), 1u);
  const nlohmann::json thrown = info["result"]["throws"][0];
  EXPECT_EQ(thrown["felled_by_ball"], info["result"]["skittles_down"]);
  EXPECT_EQ(thrown["release_speed_mps"], info["result"]["release_speed_mps"]);
  EXPECT_EQ(thrown["known"], "tracked");
  EXPECT_EQ(thrown["samples_left_out"], 0);
  EXPECT_EQ(json("replay --json game.lcmlog")["throws"], info["result"]["throws"]);
  EXPECT_EQ(rows["states"].get<int>() % info["ticks"].get<int>(), 0);
  EXPECT_GT(rows["states"], info["ticks"]);
  EXPECT_EQ(slurp(folder_ / "tables/scenario.toml"), headpin("info game.lcmlog --scenario").out);
  // Of a trial of before some keys were there, as a file it means what that ran under.
  const std::string old = HEADPIN_SOURCE_DIR "/tests/scene/trials/rules-1.lcmlog";
  ASSERT_EQ(headpin("export " + old + " -o old").code, 0);
  EXPECT_EQ(slurp(folder_ / "old/scenario.toml"), headpin("info " + old + " --scenario").out);
  EXPECT_THAT(slurp(folder_ / "old/scenario.toml"), testing::HasSubstr("\nspeed = 0.0"));
  EXPECT_EQ(nlohmann::json::parse(slurp(folder_ / "tables/trial.json"))["complete"], true);
  const std::string states = slurp(folder_ / "tables/states.csv");
  EXPECT_EQ(std::count(states.begin(), states.end(), '\n'), rows["states"].get<int>() + 1);
  EXPECT_THAT(states, HasSubstr(json("replay --json game.lcmlog")["state_hash"]));
  expect_refusal("export game.lcmlog -o tables", 1, "tables");
  EXPECT_EQ(headpin("export game.lcmlog -o tables --force").code, 0);

  ASSERT_EQ(headpin("plot game.lcmlog -o game.svg").code, 0);
  const std::string svg = slurp(folder_ / "game.svg");
  for (const char* says : {"speed [m/s]", "height of the centre of mass [m]", "energy [J]",
                           "contact points", ">release<", ">first_contact<", "</svg>"}) {
    EXPECT_THAT(svg, HasSubstr(says));
  }
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
  EXPECT_THAT(svg, testing::Not(HasSubstr("game_hash")));  // no event of the throw
  ASSERT_EQ(headpin("plot game.lcmlog -o again.svg").code, 0);
  EXPECT_EQ(slurp(folder_ / "again.svg"), svg);
  expect_refusal("plot " + kDemo + " -o OUT.svg", 1, "expected states to plot");
  expect_refusal("plot game.lcmlog -o game.lcmlog --force", 2, "game.lcmlog");
}

TEST_F(Reference, TheManualTellsOfOptionsEnvironmentAndTheInstalledTrial) {
  ASSERT_EQ(headpin("manual written").code, 0);
  const std::string page = slurp(folder_ / "written/man1/headpin.1");
  EXPECT_THAT(page, HasSubstr("\\fB\\-h\\fR, \\fB\\-\\-help\\fR"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-version\\fR"));
  static const std::regex read("getenv\\(\"([A-Z_]+)\"\\)");
  int found = 0;
  for (const char* folder : {"base", "devices", "render", "scene", "study", "sweep", "apps"}) {
    for (const auto& file :
         fs::recursive_directory_iterator(fs::path(HEADPIN_SOURCE_DIR) / folder)) {
      if (file.path().extension() != ".cpp") continue;
      const std::string code = slurp(file.path());
      for (std::sregex_iterator one(code.begin(), code.end(), read), end; one != end; ++one) {
        EXPECT_THAT(page, HasSubstr("\\fB" + (*one)[1].str() + "\\fR")) << file.path();
        ++found;
      }
    }
  }
  EXPECT_GE(found, 8);
  for (const auto& file : fs::directory_iterator(folder_ / "written/man1")) {
    EXPECT_THAT(slurp(file.path()), testing::Not(HasSubstr("assets/trials"))) << file.path();
  }
  EXPECT_THAT(slurp(folder_ / "written/man1/headpin-info.1"),
              HasSubstr("headpin info /usr/share/headpin/trials/demo.lcmlog"));
}

// Who meets an old trial finds what its rules lack; the key itself says only where that is told.
TEST_F(Reference, EveryNumberOfTheRulesIsTold) {
  const std::string page = slurp(kDocs / "rules.md");
  const auto newest = scene::Scenario{}.collision.rules;
  for (std::int64_t number = 1; number <= newest; ++number) {
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | ", number)));
  }
  EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | today's rules |", newest)));
  EXPECT_THAT(slurp(kDocs / "scenario.md"),
              HasSubstr(fmt::format("1 to {0} | `{0}` | rules of the simulation step and the game; "
                                    "see docs/rules.md |",
                                    newest)));
}

}  // namespace
}  // namespace headpin
