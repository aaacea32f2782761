#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iterator>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/crew.h"
#include "engine/save.h"
#include "engine/workspace.h"
#include "tests/support/bowling.h"

/// A step that threads share. Run under ThreadSanitizer too (`./dev check threads`).
namespace headpin::engine {
namespace {

/// All that a step leaves: the states, what the next step starts from, what happened and its counts.
void expect_same(const World& a, const World& b) {
  ASSERT_EQ(save(a), save(b)) << "tick " << a.tick;
  ASSERT_EQ(a.events.size(), b.events.size()) << "tick " << a.tick;
  for (std::size_t k = 0; k < a.events.size(); ++k) {
    const ContactEvent &p = a.events[k], &q = b.events[k];
    ASSERT_EQ(std::tie(p.a, p.b, p.first, p.approach_speed),
              std::tie(q.a, q.b, q.first, q.approach_speed));
    ASSERT_EQ(p.impulse_W, q.impulse_W);
    ASSERT_EQ(p.p_W, q.p_W);
  }
  const Statistics &s = a.statistics, &t = b.statistics;
  ASSERT_EQ(std::tie(s.pairs, s.contacts, s.queries.queries, s.queries.iterations, s.queries.capped,
                     s.pulls, s.unfinished_impacts, s.impacts, s.islands, s.solver_iterations,
                     s.unsolved, s.residual, s.deepest_overlap, s.awake),
            std::tie(t.pairs, t.contacts, t.queries.queries, t.queries.iterations, t.queries.capped,
                     t.pulls, t.unfinished_impacts, t.impacts, t.islands, t.solver_iterations,
                     t.unsolved, t.residual, t.deepest_overlap, t.awake));
}

struct Crowd {
  const char* name;
  std::function<void(RackOptions&)> change;
  bool hand = false;  ///< a driven ball goes through it
};

World make(const Crowd& crowd, int threads) {
  RackOptions o;
  o.racks = 100;  // some 2000 pairs: four parts of the work, and more
  o.ball_distance = 0.4;
  o.parameters.threads = threads;
  crowd.change(o);
  World world = bowling(o).world;
  if (!crowd.hand) return world;
  Body hand = ball_body({0.7, 0.7}, 0.1);
  hand.kind = Kind::driven;
  add_body(world, hand, {.X_WB = {Quat::Identity(), {0.02, -0.7, 0.12}}, .v_WB = {0.0, 3.0, 0.0}});
  return world;
}

class AStep : public testing::TestWithParam<Crowd> {};

TEST_P(AStep, HasTheSameBitsWithAnyNumberOfThreads) {
  constexpr int kSteps = 30;
  World alone = make(GetParam(), 1);
  std::vector<World> shared;
  for (const int threads : {2, 3, 8}) shared.push_back(make(GetParam(), threads));
  std::vector<Workspace> workspaces(shared.size() + 1);
  std::int64_t impacts = 0;
  for (int k = 0; k < kSteps; ++k) {
    step(alone, workspaces.back());
    impacts += alone.statistics.impacts;
    for (std::size_t n = 0; n < shared.size(); ++n) {
      step(shared[n], workspaces[n]);
      expect_same(alone, shared[n]);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(impacts, 100);
}

INSTANTIATE_TEST_SUITE_P(
    OfACrowd, AStep,
    testing::Values(
        Crowd{"Awake", [](RackOptions& o) { o.parameters.sleep = false; }},
        Crowd{"ThatSleepsUntilItIsHit", [](RackOptions& o) { o.parameters.sleep_after = 0.02; }},
        Crowd{"UnderTheLawOfToday", [](RackOptions& o) { o.parameters.response = "coulomb"; }},
        Crowd{"WithThePapersDetection",
              [](RackOptions& o) { o.parameters.query = {Query::paper}; }},
        Crowd{"ThatAHandGoesThrough", [](RackOptions& o) { o.parameters.keep_ledger = true; },
              true}),
    [](const auto& test) { return test.param.name; });

TEST(AWorld, SavedWithThreadsGoesOnWithout) {
  const Crowd crowd{"", [](RackOptions&) {}};
  World many = make(crowd, 3);
  Workspace w, v;
  for (int k = 0; k < 20; ++k) step(many, w);
  World one = restore(make(crowd, 1), save(many));
  for (int k = 0; k < 20; ++k) {
    step(many, w);
    step(one, v);
  }
  EXPECT_EQ(state_hash(one), state_hash(many));
}

TEST(AWorld, RefusesNoThreadsAndThousands) {
  EXPECT_THROW(make_world({.threads = 0}), std::invalid_argument);
  EXPECT_THROW(make_world({.threads = 1000}), std::invalid_argument);
}

TEST(ACrew, CallsEachPartOnceAndThrowsTheExceptionOfTheFirst) {
  Crew crew;
  crew.use(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> calls(50);
    crew.share(calls.size(), [&](std::size_t part, std::size_t) { ++calls[part]; });
    ASSERT_THAT(calls, testing::Each(1));
  }
  std::vector<int> calls(50);
  try {
    crew.share(calls.size(), [&](std::size_t part, std::size_t) {
      ++calls[part];
      if (part == 7 || part == 40) throw std::runtime_error(std::to_string(part));
    });
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "7");
  }
  EXPECT_THAT(calls, testing::Each(1));
  crew.share(1, [&](std::size_t, std::size_t) { ++calls[0]; });  // and it goes on
  EXPECT_EQ(calls[0], 2);
}

TEST(ACrew, SharesARangeWithoutGapOrOverlap) {
  for (const int threads : {1, 4}) {
    Crew crew;
    crew.use(threads);
    std::vector<int> calls(3 * Crew::kRange + 1);
    crew.share_range(calls.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) ++calls[k];
    });
    EXPECT_THAT(calls, testing::Each(1)) << threads;
  }
}

TEST(ACrew, CopiedHasThreadsOfItsOwn) {
  Workspace w;
  World world = make({"", [](RackOptions&) {}}, 2);
  step(world, w);
  World other = world;
  Workspace copy = w;
  step(world, w);
  step(other, copy);
  EXPECT_EQ(state_hash(world), state_hash(other));
}

TEST(AWorkspace, ServesWorldsWithOtherNumbersOfThreadsInTurn) {
  Workspace w, alone;
  World world = make({"", [](RackOptions&) {}}, 1), same = world;
  for (const int threads : {8, 2, 1, 3}) {
    world.parameters.threads = threads;
    step(world, w);
    step(same, alone);
    expect_same(same, world);
  }
}

// Threads keep the rounding of the time when they were made, unless they are told.
TEST(AWorkspace, HasThreadsThatRoundAsItsCallerDoes) {
  Workspace w, alone;
  World world = make({"", [](RackOptions&) {}}, 3), same = make({"", [](RackOptions&) {}}, 1);
  step(world, w);
  step(same, alone);
  const std::uint64_t nearest = state_hash(same);
  std::fesetround(FE_UPWARD);
  for (int k = 0; k < 5; ++k) {
    step(world, w);
    step(same, alone);
  }
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(state_hash(world), state_hash(same));
  EXPECT_NE(state_hash(same), nearest);
}

#ifndef __SANITIZE_THREAD__
TEST(AWorkspace, StepsAndEndsInAChildOfFork) {
  Workspace w;
  World world = make({"", [](RackOptions&) {}}, 3);
  step(world, w);
  const pid_t child = fork();
  if (child == 0) {
    alarm(120);  // ends it where it waits for threads that it has not
    step(world, w);
    w = {};
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}
#endif

/// Threads of this process by now.
std::ptrdiff_t threads_by_now() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"),
                       std::filesystem::directory_iterator());
}

// Parts that wait for each other need a thread each: this one, and others that round as it does.
TEST(ACrew, WorksWithAsManyThreadsAsItWasTold) {
  const std::ptrdiff_t before = threads_by_now();
  Crew crew;
  for (const int threads : {4, 3, 5, 2}) {
    crew.use(threads);
    const auto parts = static_cast<std::size_t>(threads);
    for (const int round : {FE_UPWARD, FE_DOWNWARD}) {
      std::vector<std::size_t> who(parts);
      std::vector<int> rounding(parts);
      std::atomic<int> here = 0;
      const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
      std::fesetround(round);
      crew.share(parts, [&](std::size_t part, std::size_t by) {
        who[part] = by;
        rounding[part] = std::fegetround();
        ++here;
        while (here < threads && std::chrono::steady_clock::now() < give_up) {
          std::this_thread::yield();
        }
      });
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(std::set(who.begin(), who.end()).size(), parts);
      EXPECT_LT(*std::max_element(who.begin(), who.end()), parts);
      EXPECT_THAT(rounding, testing::Each(round));
    }
    const std::ptrdiff_t most = before + threads - 1;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (threads_by_now() > most && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::yield();  // those that ended may be listed for a moment
    }
    EXPECT_LE(threads_by_now(), most);
  }
}

/// Until its end the system makes no thread: no stack of the size that threads get now fits the addresses. A limit on
/// addresses or processes is none for stacks that are kept from earlier threads, nor for root.
class NoThreads {
 public:
  NoThreads() {
    pthread_getattr_default_np(&usual_);
    pthread_attr_t vast;
    pthread_attr_init(&vast);
    pthread_attr_setstacksize(&vast, std::size_t{1} << 60);
    pthread_setattr_default_np(&vast);
    pthread_attr_destroy(&vast);
  }
  ~NoThreads() {
    pthread_setattr_default_np(&usual_);
    pthread_attr_destroy(&usual_);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

 private:
  pthread_attr_t usual_;
};

TEST(ACrew, DoesTheWorkAloneWhereTheSystemMakesNoThreads) {
  {
    Crew before;  // leaves stacks that the system keeps
    before.use(4);
    before.share(4, [](std::size_t, std::size_t) {});
  }
  const NoThreads none;
  EXPECT_THROW(std::thread([] {}), std::system_error);
  Crew crew;
  crew.use(4);
  std::vector<std::size_t> who;
  for (int round = 0; round < 3; ++round) {
    crew.share(9, [&](std::size_t, std::size_t by) { who.push_back(by); });
  }
  EXPECT_EQ(who, std::vector<std::size_t>(27, 0));
}

}  // namespace
}  // namespace headpin::engine
