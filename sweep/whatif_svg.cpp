#include "sweep/whatif_svg.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scene/play/score.h"
#include "study/report.h"
#include "sweep/colours.h"

namespace headpin::sweep {

namespace {

using study::escaped;

constexpr const char* kReal = "#d03020";  // the release as it was

std::string begin(double width, double height) {
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 "
      "{0:.0f} {1:.0f}' font-family='sans-serif' font-size='12'>\n<rect width='100%' "
      "height='100%' fill='#fff'/>\n",
      width, height);
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor,
                     escaped(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* stroke) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='{}'/>\n", x1,
                     y1, x2, y2, stroke);
}

/// About five round values from `low` to `high`.
std::vector<double> ticks(double low, double high) {
  if (!(high > low)) return {low};
  const double raw = (high - low) / 5.0, size = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = size * (raw / size > 5.0 ? 10.0 : raw / size > 2.0 ? 5.0 : 2.0);
  std::vector<double> values;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0) {
    values.push_back(k * step + 0.0);
  }
  return values;
}

/// A plot over the moment of the release.
struct Strip {
  double top = 0.0, height = 0.0;
  double low = 0.0, high = 1.0;  ///< of its values

  double up(double value) const {
    return top + height * (1.0 - (high > low ? (value - low) / (high - low) : 0.5));
  }
};

constexpr double kLeft = 64.0, kWide = 600.0;

/// The horizontal position of a moment.
class Moments {
 public:
  explicit Moments(const WhatIf& whatif) : whatif_(whatif) {
    first_ = 1e3 * seconds(whatif.moments.front().shift);
    last_ = 1e3 * seconds(whatif.moments.back().shift);
  }

  double x(double ms) const {
    return kLeft + kWide * (last_ > first_ ? (ms - first_) / (last_ - first_) : 0.5);
  }
  double x(Time shift) const { return x(1e3 * seconds(shift)); }

  std::string frame(const Strip& strip, const std::string& title) const {
    std::string svg = text(kLeft, strip.top - 6, "start", title);
    for (const double value : ticks(strip.low, strip.high)) {
      svg += line(kLeft, strip.up(value), kLeft + kWide, strip.up(value), "#ddd");
      svg += text(kLeft - 6, strip.up(value) + 4, "end", fmt::format("{:.4g}", value));
    }
    return svg + line(x(0.0), strip.top, x(0.0), strip.top + strip.height, kReal);
  }

  std::string below(double y) const {
    std::string svg;
    for (const double ms : ticks(first_, last_)) {
      svg += line(x(ms), y, x(ms), y + 4, "#888") +
             text(x(ms), y + 17, "middle", fmt::format("{:g}", ms));
    }
    return svg + text(kLeft + kWide / 2, y + 36, "middle",
                      "release later than the real one [ms]; the red line is the real one");
  }

  std::string curve(const Strip& strip, const std::vector<double>& values) const {
    std::string path;
    bool down = false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isnan(values[i])) {
        path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", x(whatif_.moments[i].shift),
                            strip.up(values[i]));
      }
      down = !std::isnan(values[i]);
    }
    return fmt::format("<path d='{}' fill='none' stroke='#2c718e' stroke-width='1.5'/>\n", path);
  }

  std::string bars(const Strip& strip) const {
    std::string svg;
    const double wide = kWide / static_cast<double>(whatif_.moments.size());
    for (std::size_t i = 0; i < whatif_.moments.size(); ++i) {
      const Outcome& outcome = whatif_.of_moments[i];
      if (!outcome.released) continue;
      const double y = strip.up(static_cast<double>(outcome.down));
      svg += fmt::format("<rect x='{:.2f}' y='{:.1f}' width='{:.2f}' height='{:.1f}' fill='{}'/>\n",
                         x(whatif_.moments[i].shift) - wide / 2, y - 1, wide,
                         strip.top + strip.height - y + 1,
                         outcome.down >= whatif_.success ? "#2c718e" : "#b8c4cc");
    }
    return svg;
  }

 private:
  const WhatIf& whatif_;
  double first_ = 0.0, last_ = 0.0;
};

/// A strip for values, with some room around them.
Strip strip_for(const std::vector<double>& values, double top, double height) {
  Strip strip{.top = top, .height = height, .low = INFINITY, .high = -INFINITY};
  for (const double value : values) {
    if (std::isnan(value)) continue;
    strip.low = std::min(strip.low, value);
    strip.high = std::max(strip.high, value);
  }
  if (strip.low > strip.high) strip.low = strip.high = 0.0;
  const double room = std::max(0.1, 0.08 * (strip.high - strip.low));
  strip.low -= room;
  strip.high += room;
  return strip;
}

std::string title_of(const WhatIf& whatif) {
  return fmt::format("{}, throw {}: {:.2f} m/s, {} down", whatif.trial, whatif.number,
                     whatif.real.thrown.speed, whatif.real.down);
}

/// What the maps of a picture show: directions to the right, another axis up; and of two more axes
/// each value a column or a row of maps.
struct MapAxes {
  std::size_t up, column, row;  ///< of ReleaseGrid::axes()
  const char* label;            ///< of `up`
  /// Where a throw is on `up`, beside the recorded one.
  std::optional<double> (*place)(const scene::ThrowRow& own, const scene::ThrowRow& recorded);
  std::string (*title)(double of_column, double of_row);
  std::string (*cell)(double of_up);
};

const MapAxes& over_speed() {
  static const MapAxes axes = {
      ReleaseGrid::kSpeedAxis,
      ReleaseGrid::kSpinAxis,
      ReleaseGrid::kHeightAxis,
      "part of the speed",
      [](const scene::ThrowRow& own, const scene::ThrowRow& recorded) {
        return std::optional(execution_of(own)->speed / execution_of(recorded)->speed);
      },
      [](double spin, double height) {
        return fmt::format("{:+.3g} m, {:+.3g} rad/s", height, spin);
      },
      [](double speed) { return fmt::format("{:.4g} of the speed", speed); }};
  return axes;
}

const MapAxes& over_boards() {
  static const MapAxes axes = {
      ReleaseGrid::kBoardsAxis,
      ReleaseGrid::kSpeedAxis,
      ReleaseGrid::kRevsAxis,
      "boards to the left",
      [](const scene::ThrowRow& own, const scene::ThrowRow& recorded) {
        if (!own.path || !recorded.path) return std::optional<double>();
        return std::optional(own.path->release.board - recorded.path->release.board);
      },
      [](double speed, double revs) {
        return fmt::format("{:.3g} of the speed, {:.3g} of the revs", speed, revs);
      },
      [](double boards) { return fmt::format("{:+.3g} boards", boards); }};
  return axes;
}

/// The maps of a grid, side by side; what they do not show is as it was.
class Maps {
 public:
  Maps(const WhatIf& whatif, const MapAxes& axes)
      : whatif_(whatif),
        axes_(axes),
        up_(*whatif.grid.axes()[axes.up]),
        columns_(*whatif.grid.axes()[axes.column]),
        rows_(*whatif.grid.axes()[axes.row]),
        right_(whatif.grid.direction_deg) {}

  std::string svg() const {
    const auto columns = static_cast<double>(columns_.size());
    const auto rows = static_cast<double>(rows_.size());
    const double width = std::max(560.0, kMargin + columns * kEach);
    std::string svg = begin(width, kHead + rows * kTall + 20);
    svg += text(16, 22, "start", title_of(whatif_));
    svg += scale();
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      for (std::size_t column = 0; column < columns_.size(); ++column) svg += map(row, column);
    }
    return svg + "</svg>\n";
  }

 private:
  static constexpr double kMargin = 24.0, kHead = 66.0, kPlot = 210.0, kEach = 290.0, kTall = 290.0;

  double part(std::int64_t down) const {
    return whatif_.rack > 0 ? static_cast<double>(down) / static_cast<double>(whatif_.rack) : 0.0;
  }

  /// The colour of each number of skittles.
  std::string scale() const {
    std::string svg = text(16, 46, "start", "skittles down:");
    const std::int64_t every = whatif_.rack / 12 + 1;
    double x = 112;
    for (std::int64_t down = 0; down <= whatif_.rack; down += every, x += 30) {
      svg += fmt::format("<rect x='{}' y='34' width='12' height='14' fill='{}'/>\n", x,
                         colour(part(down)));
      svg += text(x + 14, 46, "start", fmt::format("{}", down));
    }
    return svg;
  }

  /// The position of a value along an axis, in cells; values between those of the grid are between
  /// cells.
  static double place(const std::vector<double>& axis, double value) {
    if (axis.size() == 1) return 0.5;
    const double n = static_cast<double>(axis.size());
    return (0.5 + (n - 1) * (value - axis.front()) / (axis.back() - axis.front())) / n;
  }

  std::string own_throws(double left, double top) const {
    std::string svg;
    const std::optional<Execution> recorded = execution_of(whatif_.thrown);
    for (const OwnThrow& own : whatif_.own) {
      if (!own.execution || !recorded) continue;
      const std::optional<double> up = axes_.place(own.thrown, whatif_.thrown);
      if (!up) continue;
      const double x = place(right_, own.execution->direction_deg - recorded->direction_deg);
      const double y = place(up_, *up);
      if (std::min(x, y) < 0.0 || std::max(x, y) > 1.0) continue;
      svg += fmt::format(
          "<circle cx='{:.1f}' cy='{:.1f}' r='3.5' fill='none' stroke='#fff' stroke-width='3'/>"
          "<circle cx='{:.1f}' cy='{:.1f}' r='3.5' fill='none' stroke='#000'/>\n",
          left + kPlot * x, top + kPlot * (1.0 - y), left + kPlot * x, top + kPlot * (1.0 - y));
    }
    return svg;
  }

  /// Whether a value is on an axis: in one of its cells, or the only value itself.
  static bool is_on(const std::vector<double>& axis, double value) {
    if (axis.size() == 1) return axis.front() == value;
    return place(axis, value) >= 0.0 && place(axis, value) <= 1.0;
  }

  /// What the other axes are in a map.
  std::array<std::size_t, 7> places_in(std::size_t row, std::size_t column) const {
    auto places = whatif_.grid.unchanged();
    places[axes_.row] = row;
    places[axes_.column] = column;
    return places;
  }

  /// Whether all that a map does not show is as it was.
  bool is_of_real_throw(std::size_t row, std::size_t column) const {
    const auto places = places_in(row, column);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i == ReleaseGrid::kDirectionAxis || i == axes_.up) continue;
      if ((*whatif_.grid.axes()[i])[places[i]] != ReleaseGrid::kUnchanged[i]) return false;
    }
    return true;
  }

  /// A cross at the release as it was, where the map has that place.
  std::string real_throw(double left, double top) const {
    const double unchanged = ReleaseGrid::kUnchanged[axes_.up];
    if (!is_on(right_, 0.0) || !is_on(up_, unchanged)) return "";
    std::string svg;
    const double x = left + kPlot * place(right_, 0.0);
    const double y = top + kPlot * (1.0 - place(up_, unchanged));
    for (const auto& [stroke, wide] : {std::pair("#fff", 4.0), {kReal, 2.0}}) {
      svg += fmt::format(
          "<path d='M{0:.1f} {2:.1f}H{1:.1f}M{3:.1f} {4:.1f}V{5:.1f}' stroke='{6}' "
          "stroke-width='{7}'/>\n",
          x - 6, x + 6, y, x, y - 6, y + 6, stroke, wide);
    }
    return svg;
  }

  std::string cells(std::size_t row, std::size_t column, double left, double top) const {
    std::string svg;
    const double wide = kPlot / static_cast<double>(right_.size());
    const double tall = kPlot / static_cast<double>(up_.size());
    auto places = places_in(row, column);
    for (std::size_t d = 0; d < right_.size(); ++d) {
      places[ReleaseGrid::kDirectionAxis] = d;
      for (std::size_t u = 0; u < up_.size(); ++u) {
        places[axes_.up] = u;
        const Outcome& outcome = whatif_.of_grid[whatif_.grid.number(places)];
        svg += fmt::format(
            "<rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{:.2f}' fill='{}'><title>{}"
            "</title></rect>\n",
            left + wide * static_cast<double>(d), top + kPlot - tall * static_cast<double>(u + 1),
            wide + 0.3, tall + 0.3, outcome.released ? colour(part(outcome.down)) : "#eee",
            escaped(fmt::format("{}, {:+.3g} degrees: {} down", axes_.cell(up_[u]), right_[d],
                                outcome.down)));
      }
    }
    return svg;
  }

  std::string map(std::size_t row, std::size_t column) const {
    const double left = kMargin + 34 + kEach * static_cast<double>(column);
    const double top = kHead + 24 + kTall * static_cast<double>(rows_.size() - 1 - row);
    std::string svg = text(left, top - 8, "start", axes_.title(columns_[column], rows_[row]));
    svg += cells(row, column, left, top);
    const double bottom = top + kPlot;
    for (const double value : ticks(right_.front(), right_.back())) {
      svg += text(left + kPlot * place(right_, value), bottom + 15, "middle",
                  fmt::format("{:g}", value));
    }
    for (const double value : ticks(up_.front(), up_.back())) {
      svg += text(left - 4, top + kPlot * (1.0 - place(up_, value)) + 4, "end",
                  fmt::format("{:g}", value));
    }
    svg += text(left + kPlot / 2, bottom + 31, "middle", "turned to the right [degrees]");
    svg += fmt::format(
        "<text transform='translate({:.1f} {:.1f}) rotate(-90)' text-anchor='middle'>{}</text>\n",
        left - 36, top + kPlot / 2, axes_.label);
    svg += own_throws(left, top);
    return is_of_real_throw(row, column) ? svg + real_throw(left, top) : svg;
  }

  const WhatIf& whatif_;
  const MapAxes& axes_;
  const std::vector<double>&up_, &columns_, &rows_, &right_;
};

}  // namespace

std::string moments_svg(const WhatIf& whatif) {
  const Moments moments(whatif);
  std::vector<double> speeds, directions;
  for (const Outcome& outcome : whatif.of_moments) {
    const bool told = outcome.released && outcome.thrown.v_WB;
    speeds.push_back(told ? outcome.thrown.speed : NAN);
    directions.push_back(told ? scene::degrees_from_y(*outcome.thrown.v_WB) : NAN);
  }
  const Strip down{.top = 60,
                   .height = 150,
                   .low = 0.0,
                   .high = static_cast<double>(std::max<std::int64_t>(1, whatif.rack))};
  const Strip speed = strip_for(speeds, 244, 90), direction = strip_for(directions, 368, 90);
  std::string svg = begin(kLeft + kWide + 20, 512);
  svg += text(16, 22, "start", title_of(whatif));
  if (whatif.window) {
    const double from = moments.x(whatif.window->from), to = moments.x(whatif.window->to);
    svg += fmt::format("<rect x='{:.1f}' y='{}' width='{:.1f}' height='{}' fill='#fff3c4'/>\n",
                       from, down.top, std::max(1.0, to - from), 458 - down.top);
  }
  svg += moments.frame(down, fmt::format("skittles down; dark: at least {}", whatif.success)) +
         moments.bars(down) +
         line(moments.x(0.0), down.top, moments.x(0.0), down.top + down.height, kReal);
  svg +=
      moments.frame(speed, "speed of the ball at the release [m/s]") + moments.curve(speed, speeds);
  svg += moments.frame(direction, "its direction, to the right [degrees]") +
         moments.curve(direction, directions);
  return svg + moments.below(458) + "</svg>\n";
}

std::string map_svg(const WhatIf& whatif) {
  return Maps(whatif, over_speed()).svg();
}

std::string boards_svg(const WhatIf& whatif) {
  return Maps(whatif, over_boards()).svg();
}

}  // namespace headpin::sweep
