// replay --from: a trial is entered at its last snapshot, to the bit.

#include <cmath>

#include "devices/log/event_log.h"
#include "scene/record/messages.h"
#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

using testing::HasSubstr;

/// A session of one minute, with two throws in each of two versions.
class ReplayFrom : public TrialCommands {
 protected:
  ReplayFrom() {
    EXPECT_EQ(headpin("synthesize -o played.lcmlog --participant 7 --throws 2").code, 0);
    whole_ = json("replay played.lcmlog -o session.lcmlog --json");
  }

  /// Copies the session's log; `change` may change the bytes of each snapshot's message.
  template <typename F>
  void copy_to(const std::string& name, F change) const {
    devices::FileWindow file((folder_ / "session.lcmlog").string());
    devices::LogReader log(file);
    std::vector<std::uint8_t> out;
    while (const auto event = log.next()) {
      std::vector<std::uint8_t> data(event->data.begin(), event->data.end());
      if (event->channel == scene::kSnapshotChannel) change(data);
      if (!data.empty()) devices::append({event->number, event->time, event->channel, data}, out);
    }
    std::ofstream(folder_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(out.data()), static_cast<std::streamsize>(out.size()));
  }

  nlohmann::json whole_;
};

TEST_F(ReplayFrom, TheLogHasASnapshotEveryTenSecondsThatTheEndDoesNotCount) {
  const nlohmann::json info = json("info session.lcmlog --json");
  EXPECT_EQ(info["channels"]["SNAPSHOT"]["messages"],
            std::floor(whole_["simulated_s"].get<double>() / 10.0));
  EXPECT_EQ(info["complete"], true);
  copy_to("without.lcmlog", [](auto& data) { data.clear(); });
  EXPECT_EQ(json("info without.lcmlog --json")["complete"], true);
  EXPECT_FALSE(json("info without.lcmlog --json")["channels"].contains("SNAPSHOT"));
}

TEST_F(ReplayFrom, EndsAsTheWholeReplayDoes) {
  for (const auto& [from, entered] :
       {std::pair("0", 0.0), {"9.9", 0.0}, {"10", 10.0}, {"55.5", 50.0}}) {
    const nlohmann::json part =
        json(std::string("replay session.lcmlog --verify --json --from ") + from);
    EXPECT_EQ(part["simulated_from_s"], entered) << from;
    for (const char* key : {"state_hash", "game_hash", "skittles_down", "release_speed_mps",
                            "impact_speed_mps", "games", "simulated_s"}) {
      EXPECT_EQ(part[key], whole_[key]) << from << " " << key;
    }
    EXPECT_TRUE(part["throws_without_counterpart"].empty()) << from;
    EXPECT_EQ(part["unverified_ticks"], 0) << from;
  }
  EXPECT_THAT(headpin("replay session.lcmlog --from 25.5").out,
              HasSubstr("25.5 s, entered at 20 s"));
}

TEST_F(ReplayFrom, WithoutAUsableSnapshotStartsBeforeIt) {
  copy_to("without.lcmlog", [](auto& data) { data.clear(); });
  copy_to("cut.lcmlog", [](auto& data) { data.resize(data.size() / 2); });
  copy_to("damaged.lcmlog", [n = 0](auto& data) mutable {
    if (++n >= 2) data[data.size() / 2] ^= 1;  // the first one stays
  });
  for (const auto& [name, entered] : {std::pair("without", 0.0), {"cut", 0.0}, {"damaged", 10.0}}) {
    const nlohmann::json part =
        json(std::string("replay ") + name + ".lcmlog --verify --json --from 25");
    EXPECT_EQ(part["simulated_from_s"], entered) << name;
    EXPECT_EQ(part["game_hash"], whole_["game_hash"]) << name;
  }
}

// Before that time everything is as it was; from then on the other condition holds, also in the versions
// that begin later.
TEST_F(ReplayFrom, AnotherConditionHoldsFromThenOn) {
  const std::string other = " --friction 0.4 --json";
  const nlohmann::json all = json("replay session.lcmlog" + other),
                       first = json("replay session.lcmlog --from 0" + other),
                       second = json("replay session.lcmlog --from 25" + other);
  EXPECT_EQ(first["game_hash"], all["game_hash"]);
  EXPECT_NE(second["game_hash"], all["game_hash"]);
  EXPECT_NE(second["game_hash"], whole_["game_hash"]);
  EXPECT_EQ(second["games"][0], whole_["games"][0]);  // red was over
  EXPECT_EQ(second["versions"]["blue"]["friction"]["ball"], 0.4);
  // The red ball is the first that differs, when it moves again.
  const Result differs = headpin("replay session.lcmlog --from 25 --friction 0.4 --verify");
  EXPECT_EQ(differs.code, 1);
  const std::size_t time = differs.err.find(" (");
  ASSERT_NE(time, std::string::npos) << differs.err;
  EXPECT_GE(std::stod(differs.err.substr(time + 2)), 25.0) << differs.err;
  EXPECT_THAT(differs.err, HasSubstr("first difference in the ball"));
}

TEST_F(ReplayFrom, RefusesWhatHasNoMeaning) {
  for (const auto& [words, why] : {std::pair("--from 300", "expected a time of the trial, at most"),
                                   {"--from 5 -o x.lcmlog", "--from excludes -o"},
                                   {"--from 5 --each-throw", "--each-throw excludes"},
                                   {"--from 5 --set rates.physics_hz=120", "rates.physics_hz"},
                                   {"--from 5 --set game.rules=ninepins", "game.rules"},
                                   {"--from 5 --set game.frames=4", "game.frames"},
                                   {"--from 5 --set game.balls=3", "game.balls"},
                                   {"--from 5 --set lane.head_pin=5", "lane.head_pin"},
                                   {"--from -1", "--from"}}) {
    const Result result = headpin(std::string("replay session.lcmlog ") + words);
    EXPECT_EQ(result.code, 2) << words;
    EXPECT_THAT(result.err, HasSubstr(why)) << words;
  }
}

}  // namespace
}  // namespace headpin
