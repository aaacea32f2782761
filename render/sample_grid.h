#pragma once

/// Where the samples of a picture lie.
namespace headpin::render {

/// A square grid that is turned against the pixels, so that its points lie at different places across
/// and up each pixel: an edge nearly level or nearly upright passes them one after another. With n
/// of 2 or more along it, point (i, j) of the grid lies at ((n i + j) / (n^2 + 1), (n j - i) / (n^2 + 1))
/// pixels, turned by atan 1/n, and each pixel has n^2 + 1 of them; with 1, one in its middle.
struct SampleGrid {
  int n = 1;  ///< 1..8

  int turn() const { return n > 1 ? 1 : 0; }
  int a_pixel() const { return n * n + turn(); }

  /// Of the grid's own rows and columns, what holds a picture of w x h pixels [samples].
  int width(int w, int h) const { return n * w + turn() * (h + n % 2); }
  int height(int w, int h) const { return n * h + turn() * w; }
};

}  // namespace headpin::render
