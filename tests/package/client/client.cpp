#include <cstdio>

#include "render/eyes.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"

int main() {
  const headpin::scene::Scenario room =
      headpin::scene::parse_scenario("[ball]\nmass = 5.0", "client");
  const auto [left, right] = headpin::render::eyes({}, {});
  std::printf("%zu skittles, ball of %.1f kg, eyes %.3f m apart\n", room.rack.spots.size(),
              room.ball.mass, (right.X_WE.p - left.X_WE.p).norm());
  return room.rack.spots.size() == 10 && room.ball.mass == 5.0 ? 0 : 1;
}
