#pragma once

namespace headpin::render {

/// A number for each edge of an eye's picture.
struct Edges {
  double outer = 0.0, inner = 0.0;  ///< at the temple and at the nose
  double up = 0.0, down = 0.0;

  bool operator==(const Edges&) const = default;
};

/// Display and lenses of a head-mounted display, the same for both eyes but mirrored.
struct Optics {
  int width = 360;                   ///< pixels per eye
  int height = 240;                  ///< pixels per eye
  double horizontal_fov_deg = 75.0;  ///< per eye (Uno & Slater 1997, section 3)
  double vertical_fov_deg = 40.0;    ///< per eye
  double outer_deg = 0.0;       ///< axis to the edge at the temple; 0: half of horizontal_fov_deg
  double inner_deg = 0.0;       ///< axis to the edge at the nose; likewise
  double up_deg = 0.0;          ///< axis to the upper edge; 0: half of vertical_fov_deg
  double down_deg = 0.0;        ///< axis to the lower edge; likewise
  double eye_distance = 0.064;  ///< between the eyes' centres [m]
  double outward_deg = 0.0;     ///< how far each eye's axis is turned outward
  double near = 0.05;           ///< [m]
  double far = 40.0;            ///< [m]
  /// Width of the picture that is scaled to the display; 0: that of the display.
  int relay_width = 0;
  int relay_height = 0;  ///< likewise
  double lens_k1 = 0.0;  ///< lens distortion (render/display.h)
  double lens_k2 = 0.0;

  /// Angles from an eye's axis to the edges of its picture, whichever values give them.
  Edges edges_deg() const;

  /// Mean size of a pixel [arcmin], the larger of width and height.
  double pixel_arcmin() const;

  /// Width of a pixel over its height on the display, as the lens shows it in its middle: 1.405 for
  /// the default display.
  double pixel_aspect() const;
};

}  // namespace headpin::render
