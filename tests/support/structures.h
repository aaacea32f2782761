#pragma once

#include <string_view>
#include <vector>

#include "engine/workspace.h"
#include "engine/world.h"

/// Bodies on and against each other, which should stand.
namespace headpin::engine {

/// A world without sleep, its bodies and where they were put.
struct Structure {
  World world;
  std::vector<BodyId> bodies = {};
  std::vector<Vec3> start = {};
  Statistics sum = {};  ///< over the steps of `run`
};

void run(Structure& s, double seconds);

/// How far the body that moved most is from where it was put [m].
double moved(const Structure& s);

/// Half a circle of stones under `coulomb`: equal angles, 0.26 as thick as their mean radius of 0.5 m,
/// friction 0.81.
///
/// @param rules  of the step
Structure arch(int stones, int rate_hz, int rules = Parameters{}.rules);

/// Two storeys of playing cards that lean by 0.35 rad, under `coulomb`, friction 0.49: two pairs, a
/// card across, and a pair on it.
Structure card_house(int rate_hz, int rules = Parameters{}.rules);

/// A house of playing cards that lean by 0.35 rad, under `coulomb`, friction 0.49: a pair less in each storey, and
/// cards across between two storeys.
Structure card_house_of(int storeys, int rate_hz, int rules = Parameters{}.rules);

/// The same bodies, put into the world in another order.
Structure in_another_order(const Structure& s, std::uint32_t seed);

/// Boxes 0.2 m wide and 0.1 m high of 1 kg, each up to 5 mm beside the middle, friction 0.49.
Structure boxes_on_each_other(int count, int rate_hz, std::string_view response,
                              int rules = Parameters{}.rules);

/// Skittles above a bin with walls at `half` from its middle [m]: 4 at a height, turned anyhow.
Structure skittles_in_a_bin(int count, double half, std::string_view response,
                            int rules = Parameters{}.rules);

}  // namespace headpin::engine
