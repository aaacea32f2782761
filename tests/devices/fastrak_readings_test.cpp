#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/motion.h"
#include "devices/fastrak/readings.h"
#include "tests/devices/fastrak_line.h"

namespace headpin::devices {
namespace {

// Each reading is held against the motion that the others show. A single wrong one, which is the end
// of one way and the begin of the next, passed for motion that excuses a fault of every form.
TEST(FastrakReadingsTest, OneWrongReadingDoesNotExcuseTheRest) {
  FastrakEmulatorOptions options;
  options.receivers = 1;
  options.faults = parse_faults("noise=0");
  ChangedLine line(options);
  int in_ascii = 0;
  line.change = [&in_ascii](const std::string& sent, std::string& reading) {
    if (sent != "P") return;
    constexpr std::size_t kAscii = 47, kQuaternion = 54;  // bytes
    if (reading.size() == kAscii && ++in_ascii == 6) reading.replace(24, 7, "-123.00");
    if (reading.size() == kQuaternion) std::rotate(&reading[24], &reading[31], &reading[52]);
  };
  FastrakDemands demands;
  EXPECT_EQ(examine_readings(line, demands), 1);
  EXPECT_EQ(in_ascii, 9);  // eight in the factory's form, one in centimetres
  const auto unmet = std::ranges::find(demands, false, &FastrakDemand::met);
  ASSERT_NE(unmet, demands.end());
  EXPECT_THAT(unmet->what, testing::StartsWith("as a quaternion the pose that"));
}

// What every pair of readings may explain passed as agreement, however far the receiver had gone.
TEST(FastrakReadingsTest, ReceiversThatAlwaysMoveFarTellNothing) {
  FastrakEmulatorOptions options;
  options.receivers = 1;
  options.faults = parse_faults("noise=0");
  const auto moves = [&options](const FastrakMotion& motion) {
    ChangedLine line(options, motion);
    FastrakDemands demands;
    examine_readings(line, demands);
    for (const FastrakDemand& demand : demands) EXPECT_TRUE(demand.met) << demand.found;
    return std::ranges::any_of(demands, &FastrakDemand::receivers_move);
  };
  EXPECT_TRUE(moves([](int station, Time time) {
    FastrakTruth truth = still_motion(station, time);
    truth.X_TS.q = rotation(Vec3(0.0, 0.0, 12.0 * seconds(time)));
    return truth;
  }));
  EXPECT_TRUE(moves([](int station, Time time) {
    FastrakTruth truth = still_motion(station, time);
    truth.X_TS.p = Vec3(0.1, 0.5 * std::sin(20.0 * seconds(time)), 0.1);  // back and forth
    return truth;
  }));
  EXPECT_FALSE(moves(still_motion));
  options.receivers = 2;
  EXPECT_FALSE(moves(circling_motion));  // as `emulate` does by default
}

// --- Reading by reading ----------------------------------------------------------------------

// Reading 0 is in the factory's form; those of the seven forms follow, each before another in the
// factory's: form f has reading 2 f + 1, between 2 f and 2 f + 2.
constexpr int kQuaternionForm = 2, kLastForm = 6;

/// A receiver whose pose at each reading is known, and what a unit says of it.
struct ReadUnit {
  std::function<Pose(int reading)> pose = [](int) { return Pose{Quat::Identity(), kThere}; };
  std::function<void(int reading, std::string& heard)> spoils = [](int, std::string&) {};
  static inline const Vec3 kThere{0.3, 0.0, 0.4};  // half a metre away

  FastrakDemands demands(double noise = 0.0, const std::string& before = "") const {
    FastrakEmulatorOptions options;
    options.receivers = 1;
    options.faults.noise = noise;
    int reading = 0;
    ChangedLine line(options, [&](int, Time) { return FastrakTruth{pose(reading)}; });
    line.ask(before, Time{50'000});
    line.change = [&](const std::string& sent, std::string& heard) {
      if (sent == "P") spoils(reading++, heard);
    };
    FastrakDemands all;
    EXPECT_EQ(examine_readings(line, all), 1);
    EXPECT_EQ(reading, 15);
    return all;
  }
};

/// What is demanded and not met.
std::vector<std::string> unmet_of(const FastrakDemands& demands) {
  std::vector<std::string> all;
  for (const FastrakDemand& one : demands) {
    if (!one.met) all.push_back(one.what);
  }
  return all;
}

bool receivers_move(const FastrakDemands& demands) {
  return std::ranges::any_of(demands, &FastrakDemand::receivers_move);
}

Pose beside(double x, double turned = 0.0) {
  return {rotation(Vec3(turned, 0.0, 0.0)), ReadUnit::kThere + Vec3(0.0, x, 0.0)};
}

constexpr std::string_view kAsAQuaternion =
    "as a quaternion the pose that it is in ASCII, inches and angles";
constexpr std::string_view kInCentimetres =
    "in centimetres the pose that it is in ASCII, inches and angles";

TEST(FastrakReadingTest, AUnitThatWasLeftInCentimetresIsAskedForInches) {
  const FastrakDemands demands = ReadUnit().demands(0.0, "u");
  EXPECT_THAT(unmet_of(demands), testing::IsEmpty());
  EXPECT_FALSE(receivers_move(demands));
}

TEST(FastrakReadingTest, ARecordOfAnotherStationIsNotTheFirstOne) {
  ReadUnit unit;
  unit.spoils = [](int reading, std::string& heard) {
    if (reading == 1) heard.at(1) = '2';
  };
  EXPECT_THAT(unmet_of(unit.demands()),
              testing::ElementsAre("a set of 47 bytes, 47 for each station"));
}

// Half a metre away: 2 mm, and a fiftieth of the distance.
TEST(FastrakReadingTest, AReadingMayBeOffByAFiftiethOfTheDistance) {
  const auto off_by = [](double x) {
    ReadUnit unit;
    unit.pose = [x](int reading) { return beside(reading == 1 ? x : 0.0); };
    return unmet_of(unit.demands());
  };
  EXPECT_THAT(off_by(0.011), testing::IsEmpty());
  EXPECT_THAT(off_by(0.013), testing::ElementsAre(kInCentimetres));
}

// 0.03, ten times the unit's noise of 0.025 degrees, and what the receiver turns in between.
TEST(FastrakReadingTest, AReadingMayBeTurnedByTheNoiseAndTheMotion) {
  const auto turned_by = [](double angle, double in_between) {
    ReadUnit unit;
    unit.pose = [=](int reading) {
      return beside(0.0, reading == 1 ? angle : reading == 0 ? -in_between : 0.0);
    };
    return unmet_of(unit.demands());
  };
  EXPECT_THAT(turned_by(0.033, 0.0), testing::IsEmpty());
  EXPECT_THAT(turned_by(0.036, 0.0), testing::ElementsAre(kInCentimetres));
  EXPECT_THAT(turned_by(0.05, 0.1), testing::IsEmpty());  // 0.1 from the middle
  EXPECT_THAT(turned_by(0.2, 0.1), testing::ElementsAre(kInCentimetres));
}

// Its noise grows with the cube of the distance, to 0.45 degrees at 2 m.
TEST(FastrakReadingTest, AReceiverThatIsFarAwayMayBeNoisy) {
  ReadUnit unit;
  unit.pose = [](int) { return Pose{Quat::Identity(), Vec3(1.9, 0.0, 0.0)}; };
  EXPECT_THAT(unmet_of(unit.demands(1.0)), testing::IsEmpty());
}

// Inches for centimetres put a receiver off by 0.6 of its distance.
TEST(FastrakReadingTest, MoreThanHalfTheDistanceTellsNothing) {
  const auto moves = [](double way) {
    ReadUnit unit;
    unit.pose = [way](int reading) {
      return beside(reading % 4 == 0 ? 0.5 * way : reading % 4 == 2 ? -0.5 * way : 0.0);
    };
    const FastrakDemands demands = unit.demands();
    EXPECT_THAT(unmet_of(demands), testing::IsEmpty());
    return receivers_move(demands);
  };
  EXPECT_FALSE(moves(0.29));
  EXPECT_TRUE(moves(0.33));
}

/// Whether the last form's reading, off by so much while the receiver is back for the next one, is
/// taken for its motion: before, it went and turned so much from one reading to the next, which is
/// called its usual way.
bool is_excused(const Pose& off, const std::vector<Pose>& ways) {
  ReadUnit unit;
  unit.pose = [&](int reading) {
    if (reading == 2 * kLastForm + 1) return off;
    const auto form = static_cast<std::size_t>(reading / 2);
    return form < ways.size() && reading % 2 == 0 ? ways[form] : beside(0.0);
  };
  const FastrakDemands demands = unit.demands();
  EXPECT_EQ(receivers_move(demands), unmet_of(demands).empty());
  return unmet_of(demands).empty();
}

// A single wrong reading ends one way and begins another, so the third longest one counts.
TEST(FastrakReadingTest, TheThirdLongestWayExcusesAReadingOfTwiceAsMuch) {
  const Pose home = beside(0.0), away = beside(0.2), turned = beside(0.0, 0.3);
  const Pose off = beside(0.35), rolled = beside(0.0, 0.5);
  EXPECT_FALSE(is_excused(off, {}));
  EXPECT_FALSE(is_excused(off, {home, home, home, home, away}));  // there and back
  EXPECT_TRUE(is_excused(off, {home, away, home, home, away}));
  EXPECT_FALSE(is_excused(beside(0.45), {home, away, home, home, away}));
  EXPECT_FALSE(is_excused(rolled, {home, home, home, home, turned}));
  EXPECT_TRUE(is_excused(rolled, {home, turned, home, home, turned}));
  EXPECT_FALSE(is_excused(beside(0.0, 0.7), {home, turned, home, home, turned}));
}

TEST(FastrakReadingTest, TwoWaysAreNoUsualOnes) {
  ReadUnit unit;
  unit.spoils = [](int reading, std::string& heard) {
    if (reading <= 8) heard.pop_back();  // the last two forms remain
  };
  unit.pose = [](int reading) { return beside(reading == 10 ? 0.2 : reading == 13 ? 0.35 : 0.0); };
  EXPECT_THAT(unmet_of(unit.demands()).back(),
              testing::StartsWith("as an extended quaternion the"));
}

// Without its neighbours a reading is held against nothing, and shows no way either.
TEST(FastrakReadingTest, AReadingThatDoesNotComeIsSaidOnceAndNotCompared) {
  const std::string set = "a set of 47 bytes, 47 for each station";
  const auto with = [](int first, int last) {
    ReadUnit unit;
    unit.spoils = [=](int reading, std::string& heard) {
      if (reading >= first && reading <= last) heard.pop_back();
      if (reading == 2 * kQuaternionForm + 1) std::rotate(&heard[24], &heard[31], &heard[52]);
    };
    return unit.demands();
  };
  const auto compared = [](const FastrakDemands& demands) {
    return std::ranges::count_if(
        demands, [](const FastrakDemand& one) { return one.what.ends_with("inches and angles"); });
  };
  const FastrakDemands first = with(0, 0), second = with(2, 2), three = with(0, 2);
  EXPECT_THAT(unmet_of(first), testing::ElementsAre(set, kAsAQuaternion));
  EXPECT_EQ(compared(first), 6);
  EXPECT_THAT(unmet_of(second), testing::ElementsAre(set, kAsAQuaternion));
  EXPECT_EQ(compared(second), 5);
  EXPECT_THAT(unmet_of(three), testing::ElementsAre(set, set, set, kAsAQuaternion));
  EXPECT_EQ(compared(three), 5);
}

}  // namespace
}  // namespace headpin::devices
