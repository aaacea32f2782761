#pragma once

#include "render/eyes.h"
#include "render/image.h"
#include "render/renderer.h"

/// From a picture drawn in perspective to the one on a display: relayed to other pixels, drawn in
/// advance against what its lenses do.
namespace headpin::render {

/// The picture on a smaller or larger grid: each pixel is the mean light of the area it covers.
Image area_filtered(const Image& image, int width, int height);

/// Whether pictures are shown as they are drawn.
bool is_plain(const Optics& optics);

/// What has to be drawn for a view of the display: of the relayed size, wider where a lens shows
/// more in the corners than between them, and as fine as its middle needs.
View drawn_view(const View& shown, const Optics& optics);

/// The display's picture out of the drawn one.
///
/// A lens shows what is s from its axis in the direction tan t = T s (1 + k1 s^2 + k2 s^4) /
/// (1 + k1 + k2), where s is 1 and tan t is T at the farther of the left and right edge (Robinett and
/// Rolland 1992). So the edges' middles are seen in the directions that the view gives them.
Image on_display(const Image& drawn, const View& shown, const Optics& optics);

/// Likewise what its pixels' centres see, of labels drawn for label_view().
Labels on_display(const Labels& drawn, const View& shown, const Optics& optics);
View label_view(const View& shown, const Optics& optics);

}  // namespace headpin::render
