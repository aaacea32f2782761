// Where two sessions first differ.

#include "scene/record/first_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/scene/log_fixture.h"

namespace headpin::scene {
namespace {

using Lacks = FirstDifference::Lacks;
using test::header;
using test::state;
using testing::ElementsAre;

SharedBodies same_bodies() {
  return shared_bodies(header().body_names, header().body_names);
}

/// The states of these ticks, one by one.
NextState states_of(std::vector<TickState> states) {
  return [states = std::move(states), next = std::size_t{0}]() mutable {
    return next < states.size() ? std::optional(states[next++]) : std::nullopt;
  };
}

TEST(FirstDifferenceTest, FindsNothingInEqualStates) {
  EXPECT_FALSE(compare(state(3), state(3), same_bodies()));
}

// -0.0 == 0.0, but the bits are others, and 1 / x tells them apart.
TEST(FirstDifferenceTest, FindsABodyByOneBit) {
  TickState other = state(3);
  ASSERT_EQ(other.bodies[1].V_WB.v.x(), 0.0);
  other.bodies[1].V_WB.v.x() = -0.0;
  const auto difference = compare(state(3), other, same_bodies());
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->tick, 3);
  EXPECT_EQ(difference->time, state(3).time);
  EXPECT_EQ(difference->body, "skittle_1");
  EXPECT_EQ(difference->lacks, Lacks::neither);
}

TEST(FirstDifferenceTest, FindsABodyThatOnlySleeps) {
  TickState other = state(3);
  other.bodies[2].asleep = true;
  EXPECT_EQ(compare(state(3), other, same_bodies())->body, "skittle_2");
}

// A hash covers what a trial does not store of a state.
TEST(FirstDifferenceTest, NamesNoBodyWhereOnlyTheHashDiffers) {
  TickState other = state(3);
  ++other.hash;
  EXPECT_EQ(compare(state(3), other, same_bodies())->body, "");
}

// A session with fewer bodies has other hashes and other numbers of bodies.
TEST(FirstDifferenceTest, ComparesTheBodiesThatBothHave) {
  TickState other = state(3);
  ++other.hash;
  other.bodies = {other.bodies[2], other.bodies[0], other.bodies[0]};
  const std::vector<std::string> names = {"skittle_2", "ball", "post"};
  const SharedBodies shared = shared_bodies(header().body_names, names);
  EXPECT_THAT(shared.names, ElementsAre("ball", "skittle_2"));
  EXPECT_THAT(shared.only_in_a, ElementsAre("skittle_1"));
  EXPECT_THAT(shared.only_in_b, ElementsAre("post"));
  EXPECT_FALSE(compare(state(3), other, shared));
  other.bodies[0].X_WB.p.z() += 1e-12;
  EXPECT_EQ(compare(state(3), other, shared)->body, "skittle_2");
}

TEST(FirstDifferenceTest, FindsTheFirstOfManyTicks) {
  TickState other = state(3);
  other.bodies[0].X_WB.p.x() += 1e-12;
  TickState later = state(4);
  later.bodies[1].X_WB.p.x() += 1e-12;
  const auto difference = compare(states_of({state(2), state(3), state(4)}),
                                  states_of({state(2), other, later}), same_bodies());
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->tick, 3);
  EXPECT_EQ(difference->body, "ball");
}

TEST(FirstDifferenceTest, FindsATickThatOneSessionLacks) {
  const auto missing = [](std::vector<TickState> a, std::vector<TickState> b) {
    const auto difference =
        compare(states_of(std::move(a)), states_of(std::move(b)), same_bodies());
    return difference ? std::pair(difference->tick, difference->lacks)
                      : std::pair(std::int64_t{-1}, Lacks::neither);
  };
  EXPECT_EQ(missing({state(1), state(2)}, {state(1), state(2)}), std::pair(-1L, Lacks::neither));
  EXPECT_EQ(missing({state(1), state(2)}, {state(1)}), std::pair(2L, Lacks::b));
  EXPECT_EQ(missing({state(1)}, {state(1), state(2)}), std::pair(2L, Lacks::a));
  EXPECT_EQ(missing({state(1), state(2), state(3)}, {state(1), state(3)}), std::pair(2L, Lacks::b));
  EXPECT_EQ(missing({state(1), state(3)}, {state(1), state(2), state(3)}), std::pair(2L, Lacks::a));
}

}  // namespace
}  // namespace headpin::scene
