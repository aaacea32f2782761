#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace headpin::render {

/// What determines the bits of a picture, apart from the draw list.
struct Fingerprint {
  std::string renderer;                  ///< Renderer::description(): context, driver, Mesa
  std::vector<std::string> processor;    ///< processor features that Mesa's compiler may use
  std::vector<std::string> environment;  ///< LP_*, GALLIUM_* and MESA_* as NAME=value, sorted
  std::uint64_t picture = 0;             ///< hash of test_picture()

  bool operator==(const Fingerprint&) const = default;
};

}  // namespace headpin::render
