#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/draw_list.h"
#include "render/eyes.h"
#include "render/labels.h"

/// Optical flow: how far what a pixel shows moves in the picture.
namespace headpin::render {

/// Both components of a pixel whose flow is unknown; above the 1e9 of the Middlebury format.
inline constexpr float kUnknownFlow = 1e10F;

/// A view, and the objects that are drawn in it.
struct DrawnView {
  const View& view;
  std::span<const DrawItem> items;
};

/// The displacement of each pixel from one moment of a view to a later one [pixels]: x right, y
/// down, rows from the top.
///
/// What is seen at the centre of a pixel moves with its object and is then seen by the later view,
/// also where it is outside of the picture or hidden. It is unknown where nothing is seen, where the
/// object is no longer drawn or has another mesh, and where it is then nearer than the near plane.
///
/// @param seen  the labels of the view `before`
std::vector<std::array<float, 2>> flow(const DrawnView& before, const Labels& seen,
                                       const DrawnView& after);

}  // namespace headpin::render
