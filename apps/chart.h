#pragma once

#include <string>
#include <vector>

/// Plots curves over time as SVG: panels above each other with a common time axis. Charts stay our
/// own code: they need little SVG, and no dependency draws plots.
namespace headpin::apps {

/// One curve; entry i is at times[i] of its chart; NaN is not drawn.
struct Curve {
  std::string name;    ///< in the legend; empty for none
  std::string colour;  ///< as CSS has them
  std::vector<double> values;
};

struct Panel {
  std::string title;  ///< with its unit
  std::vector<Curve> curves;
};

/// An event, drawn as a line through all panels.
struct Mark {
  double time = 0.0;  ///< [s]
  std::string label;  ///< empty for a short line at the bottom
};

struct Chart {
  std::string title;
  std::vector<double> times;  ///< [s], increasing
  std::vector<Panel> panels;
  std::vector<Mark> marks;
};

/// The chart as an SVG document; equal charts give equal text.
std::string to_svg(const Chart& chart);

/// Round numbers for an axis from `low` to `high`: 5 or so, the first not above `low`, the last not
/// below `high`.
std::vector<double> axis_ticks(double low, double high);

}  // namespace headpin::apps
