#include "render/data/quality.h"

#include <array>

namespace headpin::render {

std::span<const Look> looks() {
  static const std::array<Look, 3> all{
      {{"standard", "five samples per pixel, shadows, reflections in the lane", {}},
       {"fast", "one sample per pixel, shadows, no reflections", {.samples = 1, .mirror = false}},
       {"1997",
        "one sample per pixel, light computed per vertex, no shadows, no reflections",
        {.samples = 1,
         .contact = false,
         .shadow = false,
         .mirror = false,
         .light = LightPer::vertex}}}};
  return all;
}

}  // namespace headpin::render
