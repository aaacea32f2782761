// Saved sessions: what is restored goes on to the bit, and hostile bytes are refused.

#include <algorithm>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

#include "base/hash.h"
#include "devices/base/sources.h"
#include "scene/people/participant.h"
#include "scene/play/save.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// One tick: what the session got, and what came of it.
struct Tick {
  std::vector<devices::Sample> samples;
  std::uint64_t game_hash = 0;
  std::vector<std::string> events;
};

std::vector<std::string> shown_events(const std::vector<Event>& events) {
  std::vector<std::string> words;
  for (const Event& e : events) {
    words.push_back(e.kind + " " + (e.bodies.empty() ? "" : e.bodies.front()) + " " +
                    std::to_string(e.value) + " " + e.detail.text());
  }
  return words;
}

/// Hands out the samples of recorded ticks.
struct Ticks : devices::Source {
  const std::vector<Tick>& ticks;
  std::size_t next;

  Ticks(const std::vector<Tick>& recorded, std::size_t first) : ticks(recorded), next(first) {}
  void poll(Time, std::vector<devices::Sample>& out) override {
    const std::vector<devices::Sample>& samples = ticks[next++].samples;
    out.insert(out.end(), samples.begin(), samples.end());
  }
  bool exhausted() const override { return next == ticks.size(); }
};

/// A session that somebody plays, saved before some of its ticks.
struct SavedOften {
  Scenario scenario;
  std::vector<Tick> ticks;
  std::map<std::size_t, Bytes> saved;  ///< by the number of ticks before
};

Scenario bundled(const std::string& name) {
  return load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/" + name + ".toml");
}

SavedOften played_by_somebody(const Scenario& scenario, int throws, int saves) {
  SavedOften played{scenario, {}, {}};
  set_up_for_participants(played.scenario);
  // Twice: the number of its ticks is known after the first.
  std::set<std::size_t> wanted;
  for (int round = 0; round < 2; ++round) {
    Session session = make_session(played.scenario);
    Participant participant({draw_person(7), throws}, played.scenario);
    played.ticks.clear();
    while (!participant.finished() && session.now() < Time{600'000'000}) {
      if (wanted.contains(played.ticks.size())) played.saved[played.ticks.size()] = save(session);
      advance(session, participant);
      participant.tick(session);
      played.ticks.push_back(
          {session.samples, session.game_hash.value(), shown_events(session.events)});
    }
    Random random(36);
    for (int i = 0; i < saves; ++i) {
      wanted.insert(
          static_cast<std::size_t>(index_below(random, static_cast<int>(played.ticks.size()))));
    }
  }
  return played;
}

/// Restores each saved session and follows it.
void goes_on(const SavedOften& played, std::size_t most) {
  ASSERT_GT(played.saved.size(), 5u);
  for (const auto& [first, bytes] : played.saved) {
    Session session = restore(make_session(played.scenario), bytes);
    ASSERT_EQ(save(session), bytes) << first;
    Ticks source(played.ticks, first);
    const std::size_t end = std::min(played.ticks.size(), first + most);
    for (std::size_t tick = first; tick < end; ++tick) {
      advance(session, source);
      ASSERT_EQ(session.game_hash.value(), played.ticks[tick].game_hash)
          << "from " << first << " at " << tick;
      ASSERT_EQ(shown_events(session.events), played.ticks[tick].events)
          << "from " << first << " at " << tick;
    }
  }
}

constexpr int kSaves = cases(500);
constexpr std::size_t kOneSecond = 240;

TEST(SavedSession, GoesOnToTheBitAndWithTheSameEventsInTwoVersions) {
  const SavedOften played = played_by_somebody(bundled("paper-experiment"), 2, kSaves);
  goes_on(played, kOneSecond);
}

TEST(SavedSession, GoesOnToTheBitAndWithTheSameEventsInAGame) {
  const SavedOften played =
      played_by_somebody(bundled("regulation-ten-pin"), kThorough ? 4 : 1, kSaves);
  goes_on(played, kOneSecond);
}

// With the wear of the throws before, and of the one on its way.
TEST(SavedSession, GoesOnToTheBitAndWithTheSameEventsOnALaneWithWear) {
  constexpr int kThrows = 6;  // with fewer, no ball may roll where another has rolled
  Scenario scenario = bundled("house-oil");
  scenario.game.stray_fells = StrayFells::counted;  // so that balls roll where others have rolled
  scenario.lane.oil.wear = 0.5;
  const SavedOften worn = played_by_somebody(scenario, kThrows, kSaves / 4);
  goes_on(worn, kOneSecond);
  scenario.lane.oil.wear = 0.0;
  const SavedOften fresh = played_by_somebody(scenario, kThrows, 0);
  EXPECT_NE(worn.ticks.back().game_hash, fresh.ticks.back().game_hash);
  EXPECT_EQ(worn.ticks[2 * kOneSecond].game_hash, fresh.ticks[2 * kOneSecond].game_hash);
}

TEST(SavedSession, GoesOnToTheBitOnALaneWithWearInTwoVersions) {
  Scenario scenario = bundled("paper-experiment");
  scenario.lane.oil.zones = {{1, 39, 0.0, 5.0, 0.04}};
  scenario.lane.oil.wear = 0.5;
  goes_on(played_by_somebody(scenario, 2, kSaves / 4), kOneSecond);
}

TEST(SavedSession, GoesOnToTheEnd) {
  goes_on(played_by_somebody(bundled("paper-experiment"), 1, 8), 1'000'000);
}

SavedOften one_throw() {
  SavedOften played{Scenario{}, {}, {}};
  devices::ReplaySource source(test::straight_throw(played.scenario));
  Session session = make_session(played.scenario);
  for (std::size_t tick = 0; tick < 480; ++tick) {
    if (tick % 80 == 40) played.saved[tick] = save(session);
    advance(session, source);
    played.ticks.push_back(
        {session.samples, session.game_hash.value(), shown_events(session.events)});
  }
  return played;
}

TEST(SavedSession, IsRefusedByAnotherScenario) {
  const SavedOften played = one_throw();
  Scenario other = played.scenario;
  other.material.ball.friction = 0.125;
  EXPECT_THAT([&] { restore(make_session(other), played.saved.begin()->second); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::HasSubstr("was made of other bodies or parameters")));
}

TEST(SavedSession, OfTwoVersionsIsRefusedByAGameOfOne) {
  const SavedOften played = played_by_somebody(bundled("paper-experiment"), 1, 8);
  EXPECT_THROW(restore(make_session(Scenario{}), played.saved.rbegin()->second),
               std::invalid_argument);
}

TEST(SavedSession, CutOffOrChangedIsRefused) {
  const SavedOften played = one_throw();
  const Session made = make_session(played.scenario);
  const Bytes& whole = played.saved.rbegin()->second;
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(restore(made, cut), std::invalid_argument) << size;
  }
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Bytes changed = whole;
    changed[static_cast<std::size_t>(index_below(random, static_cast<int>(whole.size())))] ^=
        static_cast<std::uint8_t>(1 << index_below(random, 8));
    EXPECT_THROW(restore(made, changed), std::invalid_argument);
  }
}

/// Gives bytes the checksum that fits them.
void seal(Bytes& bytes) {
  Fnv hash;
  for (std::size_t i = 0; i + 8 < bytes.size(); ++i) hash.add(bytes[i]);
  for (std::size_t k = 0; k < 8; ++k) {
    bytes[bytes.size() - 8 + k] = static_cast<std::uint8_t>(hash.value() >> (8 * k));
  }
}

// With a checksum that fits, a changed number is another session or is refused; it never leads
// outside of what is there.
TEST(SavedSession, ChangedWithAChecksumThatFitsIsRefusedOrGoesOn) {
  const SavedOften played = one_throw();
  const Session made = make_session(played.scenario);
  Random random(11);
  int refused = 0, gone_on = 0;
  for (const auto& [first, whole] : played.saved) {
    for (int i = 0; i < cases(2000); ++i) {
      Bytes changed = whole;
      const auto at =
          static_cast<std::size_t>(index_below(random, static_cast<int>(whole.size()) - 8));
      changed[at] = index_below(random, 3) == 0
                        ? static_cast<std::uint8_t>(255)
                        : static_cast<std::uint8_t>(index_below(random, 256));
      seal(changed);
      try {
        Session session = restore(made, changed);
        Ticks source(played.ticks, first);
        for (int tick = 0; tick < 3; ++tick) advance(session, source);
        ++gone_on;
      } catch (const std::invalid_argument&) {
        ++refused;
      } catch (const std::runtime_error&) {  // its state becomes non-finite
        ++gone_on;
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(gone_on, 100);
}

TEST(SavedSession, OfATickThatNoSessionReachesIsRefused) {
  Session session = make_session(Scenario{});
  session.tick = session.world.tick = 4'000'000'000'000'000'000;
  EXPECT_THROW(restore(make_session(Scenario{}), save(session)), std::invalid_argument);
}

TEST(SavedSession, WithALawOfOnesOwnIsNotSaved) {
  Session session = make_session(Scenario{});
  session.hashes = false;
  EXPECT_THROW(save(session), std::logic_error);
}

}  // namespace
}  // namespace headpin::scene
