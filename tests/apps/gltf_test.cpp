// The animated scene of a trial, read back from its bytes.

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "apps/glb.h"
#include "base/math.h"
#include "tests/apps/command_line.h"
#include "tests/apps/rewritten.h"
#include "tests/apps/two_versions.h"

namespace headpin {
namespace {

/// A GLB file: its JSON, and where its binary chunk begins.
struct ReadGlb {
  explicit ReadGlb(std::string file) : bytes(std::move(file)) {
    const auto length = number<std::uint32_t>(12);
    json = nlohmann::json::parse(bytes.substr(20, length));
    binary = 28 + length;
  }
  template <typename T>
  T number(std::size_t at) const {
    T value{};
    std::memcpy(&value, bytes.substr(at, sizeof value).data(), sizeof value);
    return value;
  }
  /// Number `i` of an accessor.
  double value(const nlohmann::json& accessor, std::size_t i) const {
    const nlohmann::json& a = json["accessors"][accessor.get<std::size_t>()];
    const auto view = a["bufferView"].get<std::size_t>();
    const auto begin = json["bufferViews"][view]["byteOffset"].get<std::size_t>();
    return number<float>(binary + begin + 4 * i);
  }
  /// The sampler of a moving node.
  /// @param path  translation or rotation
  const nlohmann::json& sampler(const std::string& name, const std::string& path) const {
    static const nlohmann::json kNone;
    for (const nlohmann::json& channel : json["animations"][0]["channels"]) {
      const nlohmann::json& target = channel["target"];
      if (json["nodes"][target["node"].get<std::size_t>()]["name"] != name) continue;
      if (target["path"] == path) {
        return json["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
      }
    }
    ADD_FAILURE() << name << " has no " << path;
    return kNone;
  }
  std::size_t count(const nlohmann::json& accessor) const {
    return json["accessors"][accessor.get<std::size_t>()]["count"];
  }
  /// How a node is turned at a time, between its keys on the shortest way.
  Quat turn(const std::string& name, double time) const {
    const nlohmann::json& of = sampler(name, "rotation");
    std::size_t next = 1;
    while (next + 1 < count(of["input"]) && value(of["input"], next) < time - 1e-6) ++next;
    const double from = value(of["input"], next - 1);
    const double s = (time - from) / (value(of["input"], next) - from);
    const auto key = [&](std::size_t i) {
      return Quat(value(of["output"], 4 * i + 3), value(of["output"], 4 * i),
                  value(of["output"], 4 * i + 1), value(of["output"], 4 * i + 2));
    };
    return key(next - 1).slerp(s, key(next)).normalized();
  }
  /// The distance of the farthest point of the meshes of this name from their origin [m].
  double reach(const std::string& name) const {
    double most = 0.0;
    for (const nlohmann::json& mesh : json["meshes"]) {
      if (mesh["name"] != name) continue;
      const nlohmann::json& points = mesh["primitives"][0]["attributes"]["POSITION"];
      for (std::size_t i = 0; i < count(points); ++i) {
        const Vec3 p(value(points, 3 * i), value(points, 3 * i + 1), value(points, 3 * i + 2));
        most = std::max(most, p.norm());
      }
    }
    return most;
  }
  /// The place of a moving node at a time, between its keys on a line.
  Vec3 place(const std::string& name, double time) const {
    for (const nlohmann::json& channel : json["animations"][0]["channels"]) {
      const nlohmann::json& target = channel["target"];
      if (json["nodes"][target["node"].get<std::size_t>()]["name"] != name) continue;
      if (target["path"] != "translation") continue;
      const auto which = channel["sampler"].get<std::size_t>();
      const nlohmann::json& sampler = json["animations"][0]["samplers"][which];
      std::size_t next = 1;
      while (value(sampler["input"], next) < time - 1e-6) ++next;
      const double from = value(sampler["input"], next - 1);
      const double s = (time - from) / (value(sampler["input"], next) - from);
      Vec3 p;
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = value(sampler["output"], 3 * next - 3 + k);
        p[static_cast<Eigen::Index>(k)] = a + s * (value(sampler["output"], 3 * next + k) - a);
      }
      return p;
    }
    ADD_FAILURE() << name << " does not move";
    return Vec3::Zero();
  }
  std::string bytes;
  nlohmann::json json;
  std::size_t binary = 0;
};

class Gltf : public CommandLine {
 protected:
  /// Compares the ball in every 50th tick with the table of states.
  void expect_ball_as_in_table(const ReadGlb& glb, double tolerance) const {
    std::istringstream table(slurp(folder_ / "tables/states.csv"));
    int compared = 0;
    for (std::string line; std::getline(table, line);) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      if (cells[4] != "ball" || std::stoi(cells[0]) % 50 != 0) continue;
      const Vec3 p(std::stod(cells[5]), std::stod(cells[6]), std::stod(cells[7]));
      EXPECT_LE((glb.place("ball", std::stod(cells[1])) - p).norm(), tolerance) << line;
      ++compared;
    }
    EXPECT_GT(compared, 20);
  }
};

// float32 rounds places of 20 m by 1 um; a time rounded by 0.5 us moves a ball of 7 m/s by 4 um.
TEST_F(Gltf, TheBallIsWhereTheTableOfStatesHasIt) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  ASSERT_EQ(headpin("export game.lcmlog -o tables").code, 0);
  ASSERT_EQ(headpin("export game.lcmlog --gltf all.glb").code, 0);
  ASSERT_EQ(headpin("export game.lcmlog --gltf thin.glb --tolerance 0.1mm").code, 0);
  const ReadGlb all(slurp(folder_ / "all.glb")), thin(slurp(folder_ / "thin.glb"));
  expect_ball_as_in_table(all, 1e-5);
  expect_ball_as_in_table(thin, 1e-4 + 1e-5);
  EXPECT_LT(thin.bytes.size(), all.bytes.size());
  std::set<std::string> names;
  for (const nlohmann::json& node : all.json["nodes"]) names.insert(node["name"]);
  EXPECT_EQ(names.size(), all.json["nodes"].size());
}

// The forearm that is drawn with the hand reaches 0.33 m and more.
TEST_F(Gltf, NoPointOfTheHandIsFartherOffThanTheTolerance) {
  ASSERT_EQ(headpin("export " + kDemo + " --gltf all.glb").code, 0);
  ASSERT_EQ(headpin("export " + kDemo + " --gltf thin.glb --tolerance 1mm").code, 0);
  const ReadGlb all(slurp(folder_ / "all.glb")), thin(slurp(folder_ / "thin.glb"));
  const double reach = all.reach("hand");
  ASSERT_GT(reach, 0.3);
  const nlohmann::json times = all.sampler("virtual hand", "rotation")["input"];
  double most = 0.0;
  for (std::size_t i = 1; i + 1 < all.count(times); i += 7) {
    const double time = all.value(times, i);
    const double moved =
        (thin.place("virtual hand", time) - all.place("virtual hand", time)).norm();
    const double turned =
        thin.turn("virtual hand", time).angularDistance(all.turn("virtual hand", time));
    most = std::max(most, moved + reach * turned);
  }
  EXPECT_LE(most, 1.01e-3);
  EXPECT_GT(most, 1e-4);
}

TEST_F(Gltf, ATrialThatWasCutIsWrittenAsFarAsItGoesAndSaidToBeIncomplete) {
  std::ofstream(folder_ / "cut.lcmlog") << slurp(kDemo).substr(0, 60000);
  const Result cut = headpin("export cut.lcmlog --gltf cut.glb");
  EXPECT_EQ(cut.code, 0);
  EXPECT_THAT(cut.err, testing::HasSubstr("is incomplete"));
  const ReadGlb glb(slurp(folder_ / "cut.glb"));
  EXPECT_GT(glb.json["asset"]["extras"]["ticks"], 0);
  EXPECT_LT(glb.json["asset"]["extras"]["ticks"], 1682);
}

// Of an older version or another machine: the scene would contradict the states of the same log.
TEST_F(Gltf, ATrialThatIsSimulatedOtherwiseThanItsStatesIsRefused) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "same.lcmlog", [](scene::Trial&) {});
  EXPECT_EQ(headpin("export same.lcmlog --gltf same.glb").code, 0);
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "other.lcmlog",
                [](scene::Trial& trial) { change_states_from(1000, trial); });
  expect_refusal("export other.lcmlog --gltf OUT.glb", 1,
                 "other.lcmlog: tick 1000 (4.166666 s) of the replay differs from the recording");
}

TEST_F(Gltf, EventsThatNoSimulationMakesHaveNodesToo) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "live.lcmlog", add_told_live);
  ASSERT_EQ(headpin("export live.lcmlog --gltf live.glb").code, 0);
  const ReadGlb glb(slurp(folder_ / "live.glb"));
  std::map<std::string, double> times;
  std::size_t events = 0;
  for (const nlohmann::json& node : glb.json["nodes"]) {
    if (!node.contains("extras") || !node["extras"].contains("event")) continue;
    ++events;
    times[node["extras"]["event"]] = node["extras"]["t_s"];
  }
  EXPECT_EQ(times.at("drawn_by"), 0.0);
  EXPECT_EQ(times.at("source_amiss"), 2.5);
  const std::size_t all = json("info live.lcmlog --json")["events"].size();
  EXPECT_EQ(events, all - 2);  // ledger and game_hash say how the recording ended
}

TEST_F(Gltf, SkittlesHaveTheShapeOfTheVersionThatIsPlayed) {
  write_two_versions(folder_ / "versions.lcmlog");
  ASSERT_EQ(headpin("export versions.lcmlog --gltf versions.glb").code, 0);
  const ReadGlb glb(slurp(folder_ / "versions.glb"));
  const auto& nodes = glb.json["nodes"];
  const auto skittle = std::ranges::find_if(
      nodes, [](const nlohmann::json& node) { return node["name"] == "skittle 1"; });
  ASSERT_NE(skittle, nodes.end());
  EXPECT_FALSE(skittle->contains("mesh"));
  ASSERT_EQ((*skittle)["children"].size(), 2u);
  for (std::size_t shape = 0; shape < 2; ++shape) {
    const auto number = (*skittle)["children"][shape].get<std::size_t>();
    const nlohmann::json& node = nodes[number];
    EXPECT_EQ(glb.json["meshes"][node["mesh"].get<std::size_t>()]["name"],
              shape == 0 ? "skittle" : "ellipsoid skittle");
    EXPECT_EQ(node["scale"][0], shape == 0 ? 1.0 : 0.0);
    int channels = 0;
    for (const nlohmann::json& channel : glb.json["animations"][0]["channels"]) {
      if (channel["target"]["node"] != number || channel["target"]["path"] != "scale") continue;
      const auto which = channel["sampler"].get<std::size_t>();
      const nlohmann::json& sampler = glb.json["animations"][0]["samplers"][which];
      EXPECT_NEAR(glb.value(sampler["input"], 1), kTouchesBlue, 0.05);
      EXPECT_EQ(glb.value(sampler["output"], 3), shape == 0 ? 0.0 : 1.0);
      ++channels;
    }
    EXPECT_EQ(channels, 1);
  }
}

TEST_F(Gltf, ExistingFilesAndWrongUseAreRefused) {
  ASSERT_EQ(headpin("export " + kDemo + " --gltf a.glb").code, 0);
  expect_refusal("export " + kDemo + " --gltf a.glb", 1, "exists already");
  expect_refusal("export " + kDemo, 2, "--gltf FILE.glb");
  expect_refusal("export " + kDemo + " -o tables --tolerance 1mm", 2, "--tolerance needs --gltf");
}

// Four bytes have no room for more; a shortened length would make a file that no reader understands.
TEST(GlbLength, OfFourGibibytesIsRefused) {
  EXPECT_EQ(apps::glb_length(0xffff'ffff), 0xffff'ffffu);
  EXPECT_THROW(apps::glb_length(0x1'0000'0000), std::runtime_error);
}

}  // namespace
}  // namespace headpin
