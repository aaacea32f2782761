#include "scene/watch/recorded_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/record/events.h"
#include "scene/stage/condition.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A headset whose left eye sees 52 degrees to the temple and 42 to the nose; its right eye 54 and 44.
constexpr const char* kViews =
    R"({"device":"generic-webxr","views":[
      {"eye":"left","offset":[-0.031,0,0],"left":-52,"right":42,"down":-50,"up":44,"width":1680,"height":1760},
      {"eye":"right","offset":[0.033,0,0],"left":-44,"right":54,"down":-50,"up":44,"width":1680,"height":1760}]})";

std::vector<Event> told(const std::string& detail) {
  Event event;
  event.kind = kind::played_with;
  event.detail = detail;
  return {event};
}

Scenario with(const std::vector<Event>& events) {
  Scenario scenario;
  scenario.hmd = hmd_of_profile("flight-helmet-lens");
  Condition condition;
  condition.set = recorded_display(events);
  apply(condition, scenario);
  return scenario;
}

TEST(RecordedDisplay, HasTheMeanOfBothEyes) {
  const render::Optics optics = with(told(kViews)).hmd.optics;
  EXPECT_EQ(optics.width, 1680);
  EXPECT_EQ(optics.height, 1760);
  EXPECT_DOUBLE_EQ(optics.outer_deg, 53.0);
  EXPECT_DOUBLE_EQ(optics.inner_deg, 43.0);
  EXPECT_DOUBLE_EQ(optics.up_deg, 44.0);
  EXPECT_DOUBLE_EQ(optics.down_deg, 50.0);
  EXPECT_DOUBLE_EQ(optics.horizontal_fov_deg, 96.0);
  EXPECT_DOUBLE_EQ(optics.vertical_fov_deg, 94.0);
  EXPECT_DOUBLE_EQ(optics.eye_distance, 0.064);
  EXPECT_EQ(optics.lens_k1, 0.0);
}

TEST(RecordedDisplay, WithoutPixelsTheyAreSquare) {
  std::string views = kViews;
  for (std::size_t at = 0; (at = views.find(R"(,"width":1680,"height":1760)")) != views.npos;) {
    views.erase(at, 27);
  }
  const render::Optics optics = with(told(views)).hmd.optics;
  EXPECT_EQ(std::max(optics.width, optics.height), 1000);
  EXPECT_NEAR(optics.pixel_aspect(), 1.0, 1e-3);
}

TEST(RecordedDisplay, TheLastHeadsetCounts) {
  std::vector<Event> events = told(R"({"views":[]})");
  EXPECT_THAT([&] { recorded_display(events); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no event played_with")));
  events.push_back(told(kViews)[0]);
  events.push_back(told(R"({"device":"mouse"})")[0]);
  events.push_back(told("not JSON")[0]);
  EXPECT_EQ(with(events).hmd.optics.width, 1680);
}

TEST(RecordedDisplay, ImpossibleViewsAreRefused) {
  for (const auto& [number, other] : {std::pair{"-52", "52"},
                                      {"42", "1e9"},
                                      {"\"up\":44", "\"up\":null"},
                                      {"1680", "0"},
                                      {"[-0.031,0,0]", "[]"},
                                      {"\"left\":-44", "\"left\":\"x\""}}) {
    std::string views = kViews;
    views.replace(views.find(number), std::string_view(number).size(), other);
    EXPECT_THROW(recorded_display(told(views)), std::invalid_argument) << other;
  }
}

}  // namespace
}  // namespace headpin::scene
