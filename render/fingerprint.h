#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/renderer.h"

/// What determines the bits of a picture, apart from the draw list.
namespace headpin::render {

struct Fingerprint {
  std::string renderer;                  ///< Renderer::description(): context, driver, Mesa
  std::vector<std::string> processor;    ///< processor features that Mesa's compiler may use
  std::vector<std::string> environment;  ///< LP_*, GALLIUM_* and MESA_* as NAME=value, sorted
  std::uint64_t picture = 0;             ///< hash of test_picture()

  bool operator==(const Fingerprint&) const = default;
};

/// A small fixed scene in the renderer's quality: a polished floor with a shadow, lit bodies near
/// and far, some of them thin, and a wall. Renderers with equal test pictures should draw equal
/// frames.
Image test_picture(Renderer& renderer);

Fingerprint fingerprint(Renderer& renderer);

/// The differences of two fingerprints as text, also if only the test pictures differ. Empty if
/// they are equal.
std::string difference(const Fingerprint& then, const Fingerprint& now);

}  // namespace headpin::render
