#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "sweep/runner.h"

namespace {
thread_local bool fails_once = false;
}  // namespace

// Not inlined: g++ 12 would take new and free for a pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  const bool fails = fails_once;
  fails_once = false;
  void* p = fails ? nullptr : std::malloc(size);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace headpin::sweep {
namespace {

// Its error would stand in the table for good, though the row has none.
TEST(Runner, MemoryThatIsOutIsNotTheErrorOfARow) {
  const std::vector<Trial> trials = {read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog")};
  const std::vector<std::string> keys = {"a key that is too long for a string without memory"};
  Replayer replayer(keys, trials);
  const std::vector<std::string> values = {"1"};
  fails_once = true;
  EXPECT_THROW(replayer.run(0, values, [] {}), std::bad_alloc);
  fails_once = false;
  EXPECT_NE(replayer.run(0, values, [] {}).back(), "");  // there is no such key
}

}  // namespace
}  // namespace headpin::sweep
