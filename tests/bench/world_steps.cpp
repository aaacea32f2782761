/// Steps of one scene and nothing else, to count their instructions:
///
///   valgrind --tool=callgrind world_steps SCENE [STEPS [RULES]]

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "engine/workspace.h"
#include "tests/support/bowling.h"

int main(int argc, char** argv) {
  using namespace headpin::engine;
  const std::string_view scene = argc > 1 ? argv[1] : "";
  RackOptions o;
  if (scene == "awake" || scene == "asleep") {
    o.ball = false;
  } else if (scene == "racks") {
    o.racks = 8;
  } else if (scene != "paper" && scene != "coulomb") {
    std::fprintf(stderr, "SCENE: expected awake, asleep, paper, coulomb or racks\n");
    return 2;
  }
  o.parameters.response = scene == "coulomb" ? "coulomb" : "paper";
  o.parameters.sleep = scene == "asleep";
  if (argc > 3) o.parameters.rules = std::atoi(argv[3]);
  Bowling b = bowling(o);
  Workspace workspace;
  for (int i = 0, steps = argc > 2 ? std::atoi(argv[2]) : 480; i < steps; ++i) {
    step(b.world, workspace);
  }
  std::printf("%016llx, %d down\n", static_cast<unsigned long long>(state_hash(b.world)),
              skittles_down(b));
}
