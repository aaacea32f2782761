#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t*, std::size_t);

// Worlds of the fuzz target, from random bytes instead of a fuzzer's: as many as are asked for, the
// same ones each time.
//
//   worlds_check [FIRST [COUNT]]   seeds FIRST to FIRST + COUNT - 1; 0 and 100000 if not said
//
// Exit code 1 when one does what none may; its seed and what it did are shown.
namespace {

constexpr std::size_t kBytes = 4096;

std::vector<std::uint8_t> bytes_of(long long seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::vector<std::uint8_t> bytes(kBytes);
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
  return bytes;
}

bool holds(long long seed) {
  const std::vector<std::uint8_t> bytes = bytes_of(seed);
  try {
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    return true;
  } catch (const std::exception& error) {
    std::printf("seed %lld: %s\n", seed, error.what());
    return false;
  }
}

long long number(int count, char** arguments, int k, long long least, long long otherwise) {
  if (count <= k) return otherwise;
  char* end = nullptr;
  const long long n = std::strtoll(arguments[k], &end, 10);
  if (end != arguments[k] && *end == '\0' && n >= least) return n;
  std::fprintf(stderr, "worlds_check: expected a number from %lld, found '%s'\n", least,
               arguments[k]);
  std::exit(2);
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 3) {
    std::fprintf(stderr, "usage: worlds_check [FIRST [COUNT]]\n");
    return 2;
  }
  const long long first = number(count, arguments, 1, 0, 0);
  const long long worlds = number(count, arguments, 2, 1, 100'000);
  long long finds = 0;
  for (long long k = 0; k < worlds; ++k) {
    finds += holds(first + k) ? 0 : 1;
    if ((k + 1) % 10'000 == 0 || k + 1 == worlds) {
      std::printf("%lld worlds, %lld finds\n", k + 1, finds);
      std::fflush(stdout);
    }
  }
  return finds > 0 ? 1 : 0;
}
