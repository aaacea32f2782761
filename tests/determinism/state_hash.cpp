/// Plays whole games and prints the hash of each: builds that promise equal bits print equal lines.

#include <cstdio>

#include "tests/support/bowling.h"

int main() {
  using namespace headpin::engine;
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (const int rate_hz : {120, 240}) {
      for (const double offset : {-0.07, 0.0, 0.04}) {
        RackOptions o;
        o.parameters.response = response;
        o.parameters.rate_hz = rate_hz;
        o.ball_offset = offset;
        o.racks = 2;
        Bowling b = bowling(o);
        std::uint64_t all = 0;
        while (b.world.tick < 5 * rate_hz) {
          step(b.world);
          all = all * 31 + state_hash(b.world);
        }
        std::printf("%-7s %3d Hz %+.2f m  %016llx  %d down\n", response.data(), rate_hz, offset,
                    static_cast<unsigned long long>(all), skittles_down(b));
      }
    }
  }
}
