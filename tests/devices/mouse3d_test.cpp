#include "devices/base/mouse3d.h"

#include <gtest/gtest.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

// Hands out what it was given, by device time.
class Given : public Source {
 public:
  explicit Given(std::vector<Sample> samples) : samples_(std::move(samples)) {}
  void poll(Time now, std::vector<Sample>& out) override {
    while (next_ < samples_.size() && device_time(samples_[next_]) <= now) {
      out.push_back(samples_[next_++]);
    }
  }
  bool exhausted() const override { return next_ == samples_.size(); }

 private:
  std::vector<Sample> samples_;
  std::size_t next_ = 0;
};

TrackerSample tracker(int ms, std::int32_t station, bool pressed) {
  TrackerSample s;
  s.device_time = Time{1000 * ms};
  s.host_time = Time{1000 * ms + 5};
  s.station = station;
  s.buttons = pressed ? 1 : 0;
  return s;
}

std::vector<MouseSample> mouse_of(const std::vector<Sample>& samples) {
  std::vector<MouseSample> mouse;
  for (const Sample& s : samples) {
    if (const auto* m = std::get_if<MouseSample>(&s)) mouse.push_back(*m);
  }
  return mouse;
}

TEST(StylusMouseTest, EachChangeOfTheSwitchIsOneMouseSampleBehindItsRecord) {
  StylusMouse source(std::make_unique<Given>(std::vector<Sample>{
      tracker(1, 1, false), tracker(2, 2, true), tracker(3, 1, true), tracker(4, 2, false)}));
  std::vector<Sample> out;
  source.poll(10ms, out);
  ASSERT_EQ(out.size(), 6u);
  const auto mouse = mouse_of(out);
  ASSERT_EQ(mouse.size(), 2u);
  EXPECT_TRUE(mouse[0].trigger && !mouse[1].trigger);
  EXPECT_EQ(mouse[0].device_time, Time{1500});  // halfway from the record before
  EXPECT_EQ(mouse[0].host_time, Time{2005});
  EXPECT_TRUE(std::holds_alternative<MouseSample>(out[2]));
  EXPECT_FALSE(mouse[0].left_thumb || mouse[0].right_thumb);
  EXPECT_TRUE(source.exhausted());
}

TEST(StylusMouseTest, OneStationMayBeSingledOut) {
  StylusMouse source(std::make_unique<Given>(std::vector<Sample>{
                         tracker(1, 1, true), tracker(2, 2, false), tracker(3, 2, true)}),
                     2);
  std::vector<Sample> out;
  source.poll(10ms, out);
  ASSERT_EQ(mouse_of(out).size(), 1u);
  EXPECT_EQ(mouse_of(out)[0].device_time, Time{2500});
}

// What happened while nothing was heard happened as it was heard again, or little before.
TEST(StylusMouseTest, AcrossAGapAPressIsNotTakenForAnOldOne) {
  StylusMouse source(
      std::make_unique<Given>(std::vector<Sample>{tracker(1, 1, false), tracker(5000, 1, true)}));
  std::vector<Sample> out;
  source.poll(6s, out);
  ASSERT_EQ(mouse_of(out).size(), 1u);
  EXPECT_EQ(mouse_of(out)[0].device_time, Time{5'000'000 - 12'500});
}

TEST(StylusMouseTest, AMouseWithItsOwnLineIsLeftAlone) {
  MouseSample thumb;
  thumb.device_time = 1ms;
  thumb.left_thumb = true;
  StylusMouse source(std::make_unique<Given>(
      std::vector<Sample>{thumb, tracker(2, 2, true), tracker(3, 2, false)}));
  std::vector<Sample> out;
  source.poll(10ms, out);
  EXPECT_EQ(mouse_of(out).size(), 1u);
}

// From the truth through unit, wire and driver to the trigger: never lost, and known to half the
// 8.3 ms between two records, early as often as late.
TEST(StylusMouseTest, ThePressArrivesThroughTheFastrak) {
  FastrakEmulatorOptions options;
  auto [unit_end, host_end] = memory_streams();
  FastrakEmulator unit(options, [](int station, Time t) {
    FastrakTruth truth = still_motion(station, t);
    truth.pressed = t >= 5s && t < 6s;
    return truth;
  });
  Clocks clocks;
  StylusMouse source(std::make_unique<FastrakDriver>(std::move(host_end), clocks));
  std::vector<Sample> out;
  for (Time now{}; now < 8s; now += 1ms) {
    serve(unit, *unit_end, now);
    source.poll(now, out);
  }
  const auto mouse = mouse_of(out);
  ASSERT_EQ(mouse.size(), 2u);
  EXPECT_TRUE(mouse[0].trigger);
  EXPECT_LT(std::chrono::abs(mouse[0].device_time - 5s), 5200us);  // and a millisecond's estimate
  EXPECT_LT(std::chrono::abs(mouse[1].device_time - 6s), 5200us);
}

}  // namespace
}  // namespace headpin::devices
