#pragma once

/// The positions of the samples of a picture.
namespace headpin::render {

/// A square grid that is rotated against the pixels, so that its points have different positions
/// across and up in each pixel: a nearly horizontal or vertical edge crosses them one by one. With
/// n of 2 or more along it, point (i, j) of the grid lies at ((n i + j) / (n^2 + 1), (n j - i) /
/// (n^2 + 1)) pixels, turned by atan 1/n, and each pixel has n^2 + 1 of them; with 1, one in its
/// middle.
struct SampleGrid {
  int n = 1;  ///< 1..8

  int turn() const { return n > 1 ? 1 : 0; }
  int a_pixel() const { return n * n + turn(); }

  /// Size of the grid, in its own rows and columns, for a picture of w x h pixels [samples].
  int width(int w, int h) const { return n * w + turn() * (h + n % 2); }
  int height(int w, int h) const { return n * h + turn() * w; }
};

}  // namespace headpin::render
