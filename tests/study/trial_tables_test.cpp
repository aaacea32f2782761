#include "study/trial_tables.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"

namespace headpin::study {
namespace {

TrialTexts small_trial() {
  TrialTexts texts;
  texts.trackers =
      "device_time_s,host_time_s,sequence,station,frame,x_m,y_m,z_m,qw,qx,qy,qz,status,stylus\n"
      "0.016667,0.02,1,2,T,0.1,-0.2,0.3,1,0,0,0,,0\n"
      "0,0.008,7,1,T,1.9,-0.5,-0.6,0.6,0.8,0,0,,1\n"
      "0.033333,0.04,2,2,,0.1,-0.2,0.35,1,0,0,0,D,0\n";
  texts.buttons = "device_time_s,left_thumb,trigger\n0.02,0,1\n0.03,1,0\n";
  texts.events =
      "time_s,tick,kind,bodies,value,detail\n0.01,-1,marker,a;b,2.5,\"said, \"\"so\"\"\"\n0.02,4,impact,ball,1,\n";
  texts.scenario = "";
  texts.header = R"({"participant": "p1", "seed": 18446744073709551615})";
  return texts;
}

TEST(TrialTablesTest, GiveSamplesInTheOrderOfTheirArrival) {
  const TablesTrial trial = trial_of_tables(small_trial(), "f");
  EXPECT_EQ(trial.header.participant, "p1");
  EXPECT_EQ(trial.header.seed, 18446744073709551615u);
  ASSERT_EQ(trial.samples.size(), 5u);
  const auto& head = std::get<devices::TrackerSample>(trial.samples[0]);
  EXPECT_EQ(head.station, 1);
  EXPECT_EQ(head.sequence, 7);
  EXPECT_EQ(head.X_TS.q.x(), 0.8);
  EXPECT_EQ(head.buttons, 1);
  const auto& press =
      std::get<devices::MouseSample>(trial.samples[2]);  // as early, and another table
  EXPECT_TRUE(press.trigger);
  EXPECT_FALSE(press.right_thumb);
  const auto& last = std::get<devices::TrackerSample>(trial.samples[4]);
  EXPECT_EQ(last.status, 'D');
  EXPECT_EQ(last.host_time, Time{40000});
  ASSERT_EQ(trial.events.size(), 1u);  // a replay makes the other
  EXPECT_THAT(trial.events[0].bodies, testing::ElementsAre("a", "b"));
  EXPECT_EQ(trial.events[0].value, 2.5);
  EXPECT_EQ(trial.events[0].detail.text(), "said, \"so\"");
}

// Cut and mangled, each table is read or refused with its name; nothing else happens.
TEST(TrialTablesTest, DamagedTextsAreReadOrRefused) {
  const TrialTexts whole = small_trial();
  Random random(9);
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    TrialTexts texts = whole;
    std::string* const parts[] = {&texts.trackers, &*texts.buttons, &*texts.events, &*texts.header};
    std::string& text = *parts[random.next() % 4];
    if (random.next() % 4 == 0) text.resize(random.next() % text.size());
    for (int i = 0; i < 3 && !text.empty(); ++i) {
      text[random.next() % text.size()] = "0,;\"\n\t-.e9\xff\0T"[random.next() % 14];
    }
    try {
      trial_of_tables(texts, "folder");
    } catch (const std::invalid_argument& error) {
      ++refused;
      EXPECT_THAT(error.what(), testing::StartsWith("folder/"));
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 3000);
}

}  // namespace
}  // namespace headpin::study
