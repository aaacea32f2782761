// What a condition takes.

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "scene/stage/condition_fields.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

std::string complaint_under(const Condition& condition) {
  Scenario scenario;
  return complaint([&] { apply(condition, scenario); });
}

TEST(ConditionTest, RefusesAValueOutOfRange) {
  EXPECT_EQ(complaint_under({.elasticity = 1.1}), "elasticity: expected 0 to 1, found 1.1");
  EXPECT_EQ(complaint_under({.friction = -0.5}), "friction: expected 0 to 1, found -0.5");
  EXPECT_EQ(complaint_under({.friction = std::nan("")}), "friction: expected 0 to 1, found nan");
  EXPECT_EQ(complaint_under({.iterations = 4}), "iterations: expected 5 to 20, found 4");
  EXPECT_EQ(complaint_under({.elasticity = 0.0, .friction = 1.0, .iterations = 20}), "");
}

TEST(ConditionTest, RefusesAnUnknownName) {
  EXPECT_EQ(
      complaint_under({.response = "newton"}),
      fmt::format("response: expected one of {}, found newton", fmt::join(response_names(), ", ")));
  EXPECT_NE(complaint_under({.set = {"collision.shape='cube'"}}), "");
}

TEST(ConditionTest, ValuesNeedToFitTogetherAlone) {
  EXPECT_EQ(complaint_under({.set = {"rig.head_station=2", "rig.hand_station=1"}}), "");
  EXPECT_EQ(complaint_under({.set = {"lane.head_pin=18.288", "room.ahead=20"}}), "");
  EXPECT_EQ(complaint_under({.set = {"room.ahead=20", "lane.head_pin=18.288"}}), "");
  const std::string alone = complaint_under({.set = {"rig.head_station=2"}});
  EXPECT_NE(alone, "");
  EXPECT_EQ(complaint_under({.set = {"ball.mass=5", "rig.head_station=2", "ball.radius=0.1"}}),
            alone);
}

/// Whether the names of each choice are all that there are.
struct ListedChoices {
  template <typename T>
  void field(std::string_view name, const std::optional<T>&, const NameList& allowed,
             const std::string&) {
    if constexpr (Choice<T>) {
      const auto all = scene::names_of<T>();
      EXPECT_EQ(std::set(allowed.begin(), allowed.end()), std::set(all.begin(), all.end())) << name;
      ++seen;
    }
  }
  template <typename T>
  void field(std::string_view, const std::optional<T>&, const Range&, const std::string&) {}
  int seen = 0;
};

TEST(ConditionTest, TakesEveryNameOfAChoice) {
  const Condition usual;
  ListedChoices choices;
  visit_values(choices, usual);
  EXPECT_EQ(choices.seen, 2);  // shape and detection
}

}  // namespace
}  // namespace headpin::scene
