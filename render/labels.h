#pragma once

#include <cstdint>
#include <vector>

namespace headpin::render {

/// The object and the depth at the centre of each pixel.
struct Labels {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> id;  ///< DrawItem::id, or 0 without an object; rows from the top
  std::vector<float> depth;       ///< along the eye's -z [m], infinite without an object
};

}  // namespace headpin::render
