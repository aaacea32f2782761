#include "render/data/quality.h"

#include <array>

namespace headpin::render {

std::span<const Look> looks() {
  static const std::array<Look, 3> all{
      {{"standard", "five samples a pixel, shadows, a polished lane", {}},
       {"fast", "one sample a pixel, shadows, no polish", {.samples = 1, .mirror = false}},
       {"1997",
        "one sample a pixel, light worked out at vertices, no shadows, no polish",
        {.samples = 1, .contact = false, .shadow = false, .mirror = false, .light = "vertex"}}}};
  return all;
}

}  // namespace headpin::render
