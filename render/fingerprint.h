#pragma once

#include <string>

#include "render/data/fingerprint.h"
#include "render/renderer.h"

/// Whether two renderers draw the same bits.
namespace headpin::render {

/// A small fixed scene in the renderer's quality: a polished floor with a shadow, lit bodies near
/// and far, some of them thin, and a wall. Renderers with equal test pictures should draw equal
/// frames.
Image test_picture(Renderer& renderer);

Fingerprint fingerprint(Renderer& renderer);

/// The differences of two fingerprints as text, also if only the test pictures differ. Empty if
/// they are equal.
std::string difference(const Fingerprint& then, const Fingerprint& now);

}  // namespace headpin::render
