// Rows that share the part of a throw before the first touch come to what each comes to alone.

#include "sweep/shared_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sweep/runner.h"

namespace headpin::sweep {
namespace {

const std::vector<Trial>& trials() {
  static const std::vector<Trial> all{
      read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog"),
      read_trial(HEADPIN_SOURCE_DIR "/tests/scene/trials/rules-5.lcmlog")};
  return all;
}

// Responses and materials alone, then a heavier ball and another trial in between.
TEST(SharedStart, GivesEachRowWhatItComesToAlone) {
  const std::vector<std::string> keys{"elasticity", "friction", "response", "ball.mass"};
  struct One {
    std::size_t trial;
    std::vector<std::string> values;
  };
  const auto row = [](std::size_t trial, const std::string& elasticity, const std::string& friction,
                      const std::string& response, const std::string& mass) {
    return One{trial, {elasticity, friction, response, mass}};
  };
  const std::vector<One> rows{
      row(0, "0.0", "0.9", "paper", "2.0"),   row(0, "0.9", "0.1", "coulomb", "2.0"),
      row(0, "0.5", "0.5", "paper", "2.0"),   row(0, "0.5", "0.5", "paper", "3.0"),
      row(0, "0.6", "0.2", "coulomb", "3.0"), row(0, "0.1", "0.2", "coulomb", "2.0"),
      row(1, "0.6", "0.2", "coulomb", "6.0"), row(1, "0.8", "0.4", "coulomb", "6.0"),
      row(1, "0.9", "0.9", "paper", "6.0")};
  Replayer shared(keys, trials());
  std::vector<int> ticks;
  for (const One& one : rows) {
    ticks.push_back(0);
    Replayer alone(keys, trials());
    const std::vector<std::string> cells =
        shared.run(one.trial, one.values, [&] { ++ticks.back(); });
    EXPECT_EQ(cells, alone.run(one.trial, one.values, [] {}));
    EXPECT_EQ(cells.back(), "");
  }
  // The second row of a start simulates it, the third has it; the ball is thrown in the middle of the trial.
  EXPECT_EQ(ticks[1], ticks[0]);
  EXPECT_LT(ticks[2], 0.6 * ticks[0]);
  EXPECT_EQ(ticks[3], ticks[0]);
  EXPECT_EQ(ticks[5], ticks[2]);
  EXPECT_LT(ticks[8], 0.7 * ticks[6]);
}

// A ball that leaves near the floor is looked for touches before the first one: they have the law of their row.
TEST(SharedStart, GivesTouchesTheLawOfTheirRow) {
  const std::vector<std::string> keys{"response", "elasticity", "release.spin"};
  Replayer shared(keys, trials());
  for (const std::string spin : {"0.0", "200.0"}) {
    for (const std::string response : {"coulomb", "paper"}) {
      for (const std::string elasticity : {"0.0", "0.5"}) {
        Replayer alone(keys, trials());
        const std::vector<std::string> values{response, elasticity, spin};
        EXPECT_EQ(shared.run(1, values, [] {}), alone.run(1, values, [] {})) << response << spin;
      }
    }
  }
}

TEST(SharedStart, IsThatOfRowsThatDifferInWhatActsAtTouchesAlone) {
  const std::vector<std::string> keys{"material.ball.friction", "ball.mass", "collision.response"};
  EXPECT_EQ(text_of_others(3, keys, {"a", "b", "c"}), text_of_others(3, keys, {"d", "b", "e"}));
  EXPECT_NE(text_of_others(3, keys, {"a", "b", "c"}), text_of_others(3, keys, {"a", "d", "c"}));
  EXPECT_NE(text_of_others(3, keys, {"a", "b", "c"}), text_of_others(4, keys, {"a", "b", "c"}));
}

// The hand is a body of the state. In the other trial its player walks.
TEST(SharedStart, HandsMoveAlikeWhereTheirVelocitiesAreKnown) {
  for (const bool walks : {false, true}) {
    std::vector<devices::Sample> samples = trials()[0].samples;
    for (devices::Sample& sample : samples) {
      auto* const button = std::get_if<devices::MouseSample>(&sample);
      if (button) button->left_thumb = walks;
    }
    const auto hash_with = [&](const std::shared_ptr<scene::HandVelocities>& known) {
      scene::Session session = scene::make_session(trials()[0].scenario);
      session.player.velocities = known;
      devices::ReplaySource source(samples);
      while (session.now() < trials()[0].summary.end) scene::advance(session, source);
      return session.state_hash;
    };
    const std::uint64_t alone = hash_with(nullptr);
    const auto known = std::make_shared<scene::HandVelocities>();
    EXPECT_EQ(hash_with(known), alone);
    EXPECT_EQ(hash_with(known), alone);
    int found = 0;
    const auto find = [&] {
      ++found;
      return Twist{};
    };
    known->at(Time{7'000'000}, find);
    known->at(Time{7'000'000}, find);
    EXPECT_LE(found, 1);
  }
}

}  // namespace
}  // namespace headpin::sweep
