#include <cstdio>
#include <cstdlib>

#include "tests/support/pair_campaign.h"

// The whole campaign on pairs of shapes: what non_colliding.h promises, type by type.
//
//   pairs_check [PAIRS [SEED]]   PAIRS of each two forms, 1000000 if not said
//
// Exit code 1 when a promise does not hold; the first pair that broke it is shown.
int main(int count, char** arguments) {
  using namespace headpin::engine::test;
  const auto number = [&](int k, long long otherwise) {
    if (count <= k) return otherwise;
    char* end = nullptr;
    const long long n = std::strtoll(arguments[k], &end, 10);
    if (*end != '\0' || n < 1) {
      std::fprintf(stderr, "pairs_check: expected a number from 1, found '%s'\n", arguments[k]);
      std::exit(2);
    }
    return n;
  };
  if (count > 3) {
    std::fprintf(stderr, "usage: pairs_check [PAIRS [SEED]]\n");
    return 2;
  }
  const long long pairs = number(1, 1'000'000), seed = number(2, 1);
  std::printf("%-10s %-10s %8s %8s %7s %7s %6s %6s %6s %6s %6s %7s\n", "a", "b", "pairs", "shallow",
              "capped", "phantom", "lost", "other", "deep", "kept", "loose", "worst");
  std::int64_t faults = 0;
  for (std::size_t i = 0; i < kForms.size(); ++i) {
    for (std::size_t j = i; j < kForms.size(); ++j) {
      const Tally t = try_pairs(kForms[i], kForms[j], pairs, static_cast<std::uint64_t>(seed));
      faults += t.faults();
      std::printf("%-10s %-10s %8ld %8ld %7ld %7ld %6ld %6ld %6ld %6ld %6ld %7.3g\n",
                  name(kForms[i]), name(kForms[j]), t.pairs, t.shallow, t.capped, t.phantoms,
                  t.lost, t.disagreed, t.deep, t.deep_kept, t.loose, t.worst);
      if (!t.example.empty()) std::printf("    %s\n", t.example.c_str());
      std::fflush(stdout);
    }
  }
  return faults > 0 ? 1 : 0;
}
