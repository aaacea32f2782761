#pragma once

#include "render/eyes.h"
#include "render/image.h"
#include "render/labels.h"
#include "render/lens.h"

/// Converts a perspective picture to that of a display: scaled to its pixels, with the inverse of
/// its lens distortion.
namespace headpin::render {

/// The picture on a smaller or larger grid: each pixel is the mean light of the area it covers.
Image area_filtered(const Image& image, int width, int height);

/// Whether pictures are displayed without conversion.
bool is_plain(const Optics& optics);

/// The view to draw for a view of the display: of the scaled size, wider if a lens shows more in
/// the corners, and with the resolution that the middle needs.
View drawn_view(const View& shown, const Optics& optics);

/// Converts the drawn picture to the display's.
///
/// A lens shows what is s from its axis in the direction tan t = T s (1 + k1 s^2 + k2 s^4) /
/// (1 + k1 + k2), where s is 1 and tan t is T at the farther of the left and right edge (Robinett and
/// Rolland 1992). So the edges' middles are seen in the directions that the view gives them.
Image on_display(const Image& drawn, const View& shown, const Optics& optics);

/// Converts labels, which were drawn for label_view(), to the display's pixels.
Labels on_display(const Labels& drawn, const View& shown, const Optics& optics);
View label_view(const View& shown, const Optics& optics);

}  // namespace headpin::render
