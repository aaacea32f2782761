#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/renderer.h"

/// What decides about the bits of a picture beside what is drawn.
namespace headpin::render {

struct Fingerprint {
  std::string renderer;                  ///< Renderer::description(): context, driver, Mesa
  std::vector<std::string> processor;    ///< features that Mesa's compiler finds and may use
  std::vector<std::string> environment;  ///< LP_*, GALLIUM_* and MESA_* as NAME=value, sorted
  std::uint64_t picture = 0;             ///< hash of test_picture()

  bool operator==(const Fingerprint&) const = default;
};

/// A small fixed scene in the renderer's own quality: a polished floor with a shadow, lit bodies
/// near and far, thin ones among them, a wall. Where it comes out alike, so do others.
Image test_picture(Renderer& renderer);

Fingerprint fingerprint(Renderer& renderer);

/// What two of them say differently, for people; what cannot be told apart but by the picture is
/// said to be so. Empty when they are equal.
std::string difference(const Fingerprint& then, const Fingerprint& now);

}  // namespace headpin::render
