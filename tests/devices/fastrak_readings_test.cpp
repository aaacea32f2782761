#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/emulator.h"
#include "devices/fastrak/motion.h"
#include "devices/fastrak/readings.h"

namespace headpin::devices {
namespace {

/// A unit in simulated time, whose readings a test changes.
class ChangedReadings : public FastrakLine {
 public:
  explicit ChangedReadings(const FastrakEmulatorOptions& options,
                           FastrakMotion motion = still_motion)
      : emulator_(options, std::move(motion)) {}

  void put(std::string_view text) override {
    emulator_.receive(Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), now_);
  }
  std::string wait(Time span, std::size_t enough = std::string::npos) override {
    for (const Time end = now_ + span; now_ < end && heard_.size() < enough;) {
      now_ += Time{500};
      const Bytes out = emulator_.due(now_);
      heard_.append(reinterpret_cast<const char*>(out.data()), out.size());
      emulator_.taken(out.size());
    }
    std::string told = heard_.substr(0, enough);
    heard_.erase(0, told.size());
    if (sent() == "P" && change) change(told);
    return told;
  }
  void flush() override { heard_.clear(); }

  std::function<void(std::string& reading)> change;

 private:
  FastrakEmulator emulator_;
  Time now_{};
  std::string heard_;
};

// Each reading is held against the motion that the others show. A single wrong one, which is the end
// of one way and the begin of the next, passed for motion that excuses a fault of every form.
TEST(FastrakReadingsTest, OneWrongReadingDoesNotExcuseTheRest) {
  FastrakEmulatorOptions options;
  options.receivers = 1;
  options.faults = parse_faults("noise=0");
  ChangedReadings line(options);
  int in_ascii = 0;
  line.change = [&in_ascii](std::string& reading) {
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
    ChangedReadings line(options, motion);
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

}  // namespace
}  // namespace headpin::devices
