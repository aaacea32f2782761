#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Counts every allocation of this program. Not inlined: g++ 12 would take new and free for a pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace headpin::engine {
namespace {

TEST(Step, AllocatesNothingOnceWarm) {
  Bowling b = bowling({});
  Workspace workspace;
  const std::vector<State> placed = b.world.states;
  const auto play = [&] {  // allocations of the steps alone: putting bodies somewhere may allocate
    for (BodyId i = 1; i < placed.size(); ++i) set_state(b.world, i, placed[i]);
    const long before = allocations;
    run(b.world, workspace, 3.0);
    return allocations - before;
  };
  play();
  EXPECT_EQ(play(), 0);
  const long warm = allocations;
  const auto something = std::make_unique<int>(1);
  EXPECT_EQ(allocations, warm + 1);  // the counter counts
}

}  // namespace
}  // namespace headpin::engine
