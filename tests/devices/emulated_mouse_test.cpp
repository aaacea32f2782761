// The 3D mouse of an emulated unit: what it publishes, and when.

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/emulated/mouse.h"
#include "devices/emulated/unit.h"
#include "tests/support/folder.h"
#include "tests/support/samples_of_log.h"

namespace headpin::devices {
namespace {

using ToldTriggers = std::vector<std::pair<std::int64_t, bool>>;

class EmulatedMouseTest : public testing::Test {
 protected:
  std::unique_ptr<EmulatedMouse> mouse(std::vector<MouseSample> recorded) const {
    return std::make_unique<EmulatedMouse>(LcmUrl("file://" + log_.string() + "?mode=w"),
                                           std::move(recorded));
  }
  /// The time [ms] and the trigger of each message.
  ToldTriggers told() const {
    ToldTriggers all;
    for (const Sample& sample : test::samples_of(log_.string())) {
      const auto& one = std::get<MouseSample>(sample);
      EXPECT_EQ(one.device_time.count() % 1000, 0);
      all.emplace_back(one.device_time.count() / 1000, one.trigger);
    }
    return all;
  }
  /// The trigger goes down at 0.3 s.
  static std::vector<MouseSample> press() {
    return {MouseSample{}, MouseSample{.device_time = Time{300'000}, .trigger = true}};
  }

  std::filesystem::path log_ = fresh_folder("mouse") / "mouse.log";
};

TEST_F(EmulatedMouseTest, OfATrialPublishesEachChangeOnceAndTenTimesASecondWhatIs) {
  const auto told_mouse = mouse(press());
  for (int at = 0; at <= 500; at += 10) {
    told_mouse->publish(Time{1000 * (5000 + at)}, Time{1000 * at});
  }
  ToldTriggers expected = {{5000, false}, {5100, false}, {5200, false},
                           {5300, true},  {5400, true},  {5500, true}};
  EXPECT_EQ(told(), expected);
  told_mouse->publish(Time{6'000'000}, Time{});  // the trial starts again
  expected.emplace_back(6000, false);
  EXPECT_EQ(told(), expected);
}

TEST_F(EmulatedMouseTest, WithoutATrialPublishesChangesOnly) {
  const auto typed_mouse = mouse({});
  for (int now = 1000; now < 3000; now += 10) {
    typed_mouse->typed.trigger = now >= 2000;
    typed_mouse->publish(Time{1000 * now}, Time{1000 * now});
  }
  EXPECT_EQ(told(), (ToldTriggers{{1000, false}, {2000, true}}));
}

/// A line whose client says nothing.
class MuteLine : public ByteStream {
 public:
  std::size_t read(std::span<std::uint8_t>) override { return 0; }
  std::size_t write(Bytes bytes) override { return bytes.size(); }
  bool closed() const override { return false; }
};

Feed resting_feed() {
  Feed feed;
  feed.motion = still_motion;
  return feed;
}

TEST_F(EmulatedMouseTest, OfATrialSaysNothingBeforeAClientStartsTheStream) {
  Feed feed = resting_feed();
  feed.recorded = true;
  feed.length = Time{1'000'000};
  EmulatedUnit unit({}, std::move(feed), mouse(press()));
  MuteLine line;
  for (int i = 1; i < 1000; ++i) unit.step(Time{1000 * i}, line);
  EXPECT_EQ(told(), ToldTriggers{});
}

TEST(NoSuchButton, SaysWhetherItIsAThumbs) {
  FastrakEmulatorOptions options;
  options.stylus = 0;
  EmulatedUnit unit(options, resting_feed());
  const auto of_thumb = [&](const char* line) {
    try {
      unit.obey(line, Time{});
    } catch (const NoSuchButton& no) {
      return std::string(no.of_thumb ? "a thumb's" : "the trigger");
    }
    return std::string("obeyed");
  };
  EXPECT_EQ(of_thumb("press"), "the trigger");
  EXPECT_EQ(of_thumb("release"), "the trigger");
  EXPECT_EQ(of_thumb("left-thumb down"), "a thumb's");
  EXPECT_EQ(of_thumb("right-thumb up"), "a thumb's");
}

}  // namespace
}  // namespace headpin::devices
