// A recording without samples at the release.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "scene/people/arm_model.h"
#include "scene/people/throw_checks.h"

namespace headpin::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A modelled throw with a trigger, without the samples that are at most so far from its release.
devices::MotionRecording without_samples_near_release(Time near) {
  devices::MotionRecording r = record(ThrowMotion({.seed = 3}, Hand{}), 3);
  const Throw whole = find_throw(r, Hand{});
  r.triggers[1] = {{whole.grab_time, true}, {whole.release_time, false}};
  for (std::size_t i = r.times.size(); i-- > 0;) {
    if (std::chrono::abs(r.times[i] - whole.release_time) > near) continue;
    const auto at = static_cast<std::ptrdiff_t>(i);
    for (auto* track : {&r.head, &r.left_hand, &r.right_hand}) track->erase(track->begin() + at);
    r.times.erase(r.times.begin() + at);
  }
  return r;
}

TEST(AHoleAtTheRelease, MakesTheVelocityOfTheBallLessCertain) {
  EXPECT_EQ(find_throw(without_samples_near_release(Time{-1}), Hand{}).known, Known::tracked);
  const devices::MotionRecording r = without_samples_near_release(Time{30'000});
  const Throw found = find_throw(r, Hand{});
  EXPECT_EQ(found.known, Known::extrapolated);
  EXPECT_GE(found.extrapolated, Time{30'000});
  const std::string by =
      fmt::format("extrapolated by {:.0f} ms", 1e3 * seconds(found.extrapolated));
  const std::vector<std::string> said = doubts(r, found);
  EXPECT_THAT(said, Contains(AllOf(HasSubstr("no samples for 0.0"), HasSubstr("at the release"),
                                   HasSubstr(by + " and less certain"))));
  EXPECT_THAT(said, Not(Contains(HasSubstr("interpolated"))));
}

}  // namespace
}  // namespace headpin::scene
