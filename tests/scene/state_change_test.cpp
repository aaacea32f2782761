#include "scene/record/state_change.h"

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/output_file.h"
#include "devices/log/event_log.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

namespace fs = std::filesystem;

devices::Buffer bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return devices::Buffer(std::istreambuf_iterator<char>(file), {});
}

/// Ticks of a world of five bodies: one flies, one turns now and then, one stands and falls asleep,
/// one has never moved, one jumps to any numbers there are.
std::vector<TickState> some_states(int ticks) {
  std::mt19937_64 random(5);
  std::vector<TickState> all;
  TickState s;
  s.bodies.resize(5);
  for (int tick = 1; tick <= ticks; ++tick) {
    s.tick = tick;
    s.time = tick_time(tick, 240);
    s.hash = random();
    s.contacts = tick % 3;
    s.bodies[0].V_WB.v = Vec3(1.0, -0.0, 3.0 - 9.81 * tick / 240.0);
    s.bodies[0].X_WB.p += s.bodies[0].V_WB.v / 240.0;
    if (tick % 50 == 0) s.bodies[1].X_WB.q = rotation(Vec3(0.1 * tick, 0.2, 0.3));
    s.bodies[2].asleep = tick > 100 && tick < 300;
    for (double* number : {&s.bodies[4].X_WB.p.x(), &s.bodies[4].V_WB.w.z()}) {
      do *number = std::bit_cast<double>(random());
      while (!std::isfinite(*number));
    }
    s.bodies[4].V_WB.v.y() = tick % 2 ? 0.0 : -0.0;
    all.push_back(s);
  }
  return all;
}

fs::path record(const std::vector<TickState>& states, States how, const char* name) {
  const fs::path path = fresh_folder(name) / "trial.lcmlog";
  Recorder recorder(base::OutputFile(path, {}), TrialHeader{}, {.states = how});
  for (const TickState& state : states) recorder.write(state);
  recorder.close();
  return path;
}

/// The bits of everything.
devices::Buffer bits(const TickState& state) {
  devices::Buffer bytes;
  encode(state, bytes);
  return bytes;
}

void expect_equal(const std::vector<TickState>& found, std::span<const TickState> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(bits(found[i]), bits(expected[i])) << "tick " << expected[i].tick;
  }
}

TEST(StateChangeTest, AreReadBackToTheLastBit) {
  const std::vector<TickState> states = some_states(1000);
  const Trial trial = read_trial(record(states, States::changes, "changes"));
  expect_equal(trial.states, states);
  EXPECT_TRUE(trial.complete);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_EQ(trial.header.format_version, 2);
  EXPECT_EQ(trial.channels.at("STATE").messages, 5);  // at 1/240 s, then every second
  EXPECT_EQ(trial.channels.at("STATE_CHANGE").messages, 995);
}

// A program that knows no changes reads such a trial as ever.
TEST(StateChangeTest, AreNotInATrialOfWholeStates) {
  const std::vector<TickState> states = some_states(300);
  const Trial trial = read_trial(record(states, States::all, "all"));
  expect_equal(trial.states, states);
  EXPECT_EQ(trial.header.format_version, 1);
  EXPECT_FALSE(trial.channels.contains("STATE_CHANGE"));
}

TEST(StateChangeTest, AreNotToldOverAHoleOrBetweenDifferentWorlds) {
  std::vector<TickState> states = some_states(60);
  states.erase(states.begin() + 20);
  states[40].bodies.pop_back();
  states[50].tick = std::numeric_limits<std::int64_t>::max();
  const Trial trial = read_trial(record(states, States::changes, "holes"));
  ASSERT_EQ(trial.states.size() + static_cast<std::size_t>(trial.skipped.misdated), states.size());
  EXPECT_EQ(trial.skipped.misdated, 1);
  states.erase(states.begin() + 50);
  expect_equal(trial.states, states);
  EXPECT_EQ(trial.channels.at("STATE").messages, 6);  // first, hole, one less, five again, max, on
}

TEST(StateChangeTest, OfALogCutAnywhereAreReadUpToTheCut) {
  const std::vector<TickState> states = some_states(300);
  const devices::Buffer whole = bytes_of(record(states, States::changes, "cut"));
  std::vector<std::size_t> ends;  // of events
  devices::LogReader reader(whole);
  while (const auto event = reader.next()) {
    ends.push_back(static_cast<std::size_t>(event->data.data() - whole.data()) +
                   event->data.size());
  }
  for (std::size_t cut = ends[0]; cut < whole.size(); cut += 53) {
    const Trial trial = read_log(std::span(whole).first(cut));
    const auto events =
        static_cast<std::size_t>(std::ranges::upper_bound(ends, cut) - ends.begin());
    ASSERT_EQ(trial.skipped.baseless, 0);
    expect_equal(trial.states, std::span(states).first(events - 1));  // one is the header
  }
}

/// The trial with one message, of the state with this index, changed by `damage`.
template <typename Damage>
Trial damaged(const std::vector<TickState>& states, std::size_t index, const Damage& damage) {
  devices::Buffer bytes = bytes_of(record(states, States::changes, "damaged"));
  devices::LogReader reader(bytes);
  std::size_t data = 0;
  for (std::size_t event = 0; event <= index + 1; ++event) {
    data = static_cast<std::size_t>(reader.next()->data.data() - bytes.data());
  }
  damage(bytes.data() + data);
  return read_log(bytes);
}

TEST(StateChangeTest, WhoseBaseIsLostAreCountedUntilTheNextWholeOne) {
  const std::vector<TickState> states = some_states(600);  // whole ones: ticks 1, 241, 481
  const Trial trial = damaged(states, 99, [](std::uint8_t* data) { data[0] ^= 1; });
  EXPECT_EQ(trial.skipped.undecodable, 1);
  EXPECT_EQ(trial.skipped.baseless, 240 - 100);
  std::vector<TickState> left(states.begin(), states.begin() + 99);
  left.insert(left.end(), states.begin() + 240, states.end());
  expect_equal(trial.states, left);
  ASSERT_FALSE(trial.trouble.empty());
  EXPECT_EQ(trial.trouble.back().kind, "baseless");
}

// What comes behind it does not depend on its time, nor on its tick.
TEST(StateChangeTest, WithAWrongTimeOrTickAloneIsPassedOver) {
  const std::vector<TickState> states = some_states(600);
  for (const std::size_t index : {99u, 240u}) {          // a change, a whole one
    for (const std::size_t field : {8u + 2, 16u + 4}) {  // time, tick
      const Trial trial = damaged(states, index, [&](std::uint8_t* d) { d[field] ^= 0x10; });
      EXPECT_EQ(trial.skipped.misdated, 1);
      EXPECT_EQ(trial.skipped.baseless, 0);
      std::vector<TickState> left = states;
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(index));
      expect_equal(trial.states, left);
    }
  }
}

TEST(StateChangeTest, ThatCannotBeIsRefused) {
  devices::Buffer whole;
  encode(StateChange{Time{1}, 1, 2, 3, {{2, true, {1}}, {5, false, {}}}}, whole);
  ASSERT_TRUE(decode(kStateChangeChannel, whole));
  const std::size_t count = 8 + 3 * 8 + 4, first = count + 4;
  const auto with = [&](std::size_t size, std::size_t at, std::uint8_t byte) {
    devices::Buffer bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(first + size));
    bytes[count + 3] = static_cast<std::uint8_t>(size);
    bytes[at] = byte;
    return decode(kStateChangeChannel, bytes);
  };
  EXPECT_TRUE(with(28, first, 5));
  EXPECT_TRUE(with(14, first, 5));           // the first body alone
  EXPECT_FALSE(with(27, first, 5));          // ends within the second
  EXPECT_FALSE(with(28, first, 13));         // body 6 before body 5
  EXPECT_FALSE(with(28, first + 14, 5));     // the same body twice
  EXPECT_FALSE(with(28, first + 27, 0x80));  // a number without an end
}

}  // namespace
}  // namespace headpin::scene
