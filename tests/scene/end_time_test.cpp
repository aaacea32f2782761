// The end of a session in exported files.

#include "scene/record/end_time.h"

#include <limits>

#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

// Tables, XDF and Motion-BIDS say it alike.
TEST(EndTime, IsRefusedWhereItIsNoTimeOfASession) {
  EXPECT_EQ(end_time(7.25, "trial.json"), Time{7'250'000});
  EXPECT_EQ(end_time(0.0, "trial.json"), Time{});
  EXPECT_EQ(end_time(3.9e9, "trial.json"), Time{3'900'000'000'000'000});
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double wrong : {4e9, -1e300, kInfinite, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(complaint([&] { end_time(wrong, "trial.json"); }),
                testing::StartsWith("trial.json: end_s: expected seconds, found "));
  }
}

}  // namespace
}  // namespace headpin::scene
