#include "apps/chart.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/streams.h"

namespace headpin::apps {

namespace {

// Of the picture [px].
constexpr double kWidth = 960, kLeft = 70, kRight = 20, kTop = 64, kPanel = 150, kGap = 40,
                 kBottom = 44;

/// As XML has it: with neither control characters nor bytes that are not UTF-8.
std::string escaped(const std::string& text) {
  using Json = nlohmann::json;
  const std::string quoted =
      Json(printable(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  for (const char c : Json::parse(quoted).get<std::string>()) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

/// A straight scale from values to pixels.
struct Scale {
  double low, high, at_low, at_high;
  double operator()(double value) const {
    return at_low + (value - low) / (high - low) * (at_high - at_low);
  }
};

std::string text(double x, double y, const char* place, const std::string& says) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' {}>{}</text>\n", x, y, place, escaped(says));
}

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' class='{}'/>\n", x1, y1,
                     x2, y2, kind);
}

/// The curve as a path, without points inside constant parts. A gap starts a new piece.
std::string path(const std::vector<double>& times, const Curve& curve, const Scale& x,
                 const Scale& y) {
  std::string d;
  bool drawing = false;
  const std::vector<double>& v = curve.values;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!std::isfinite(v[i])) {
      drawing = false;
      continue;
    }
    const bool level = drawing && i + 1 < v.size() && v[i] == v[i - 1] && v[i] == v[i + 1];
    if (level) continue;
    d += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", x(times[i]), y(v[i]));
    drawing = true;
  }
  return fmt::format("<path d='{}' stroke='{}'/>\n", d, curve.colour);
}

struct Range {
  double low = 0.0, high = 0.0;
};

/// The range of all curves; it includes zero.
Range range(const Panel& panel) {
  Range r;
  for (const Curve& curve : panel.curves) {
    for (const double value : curve.values) {
      if (!std::isfinite(value)) continue;
      r.low = std::min(r.low, value);
      r.high = std::max(r.high, value);
    }
  }
  return r;
}

std::string legend(const Panel& panel, double y) {
  std::string out;
  double x = kWidth - kRight;
  for (auto curve = panel.curves.rbegin(); curve != panel.curves.rend(); ++curve) {
    if (curve->name.empty()) continue;
    x -= 7.0 * static_cast<double>(curve->name.size()) + 34.0;
    out += fmt::format("<path d='M{:.1f} {:.1f}h18' stroke='{}'/>\n", x, y - 4, curve->colour);
    out += text(x + 23, y, "", curve->name);
  }
  return out;
}

std::string draw(const Panel& panel, const Chart& chart, const Scale& x, double top) {
  const Range of = range(panel);
  const std::vector<double> ticks = axis_ticks(of.low, of.high);
  const Scale y{ticks.front(), ticks.back(), top + kPanel, top};
  std::string out = text(kLeft, top - 8, "class='title'", panel.title) + legend(panel, top - 8);
  for (const double tick : ticks) {
    out += line(kLeft, y(tick), kWidth - kRight, y(tick), "grid");
    out += text(kLeft - 8, y(tick) + 4, "text-anchor='end'", fmt::format("{:.6g}", tick));
  }
  for (const Mark& mark : chart.marks) {
    const double from = mark.label.empty() ? top + kPanel - 8 : top;
    out += line(x(mark.time), from, x(mark.time), top + kPanel, "mark");
  }
  for (const Curve& curve : panel.curves) out += path(chart.times, curve, x, y);
  return out;
}

/// Labels of the marks above the first panel, on two lines. A label that would overlap another one on both
/// lines is left out; its mark stays.
std::string labels(const Chart& chart, const Scale& x) {
  std::string out;
  double free[2] = {0.0, 0.0};
  for (const Mark& mark : chart.marks) {
    if (mark.label.empty()) continue;
    const double at = x(mark.time), half = 3.4 * static_cast<double>(mark.label.size());
    const int row = at - half >= free[0] ? 0 : 1;
    if (at - half < free[row]) continue;
    free[row] = at + half + 6.0;
    out += text(at, kTop - 24 - 13 * row, "text-anchor='middle' class='label'", mark.label);
  }
  return out;
}

}  // namespace

std::vector<double> axis_ticks(double low, double high) {
  if (!(high > low)) high = low + 1.0;
  const double rough = (high - low) / 4.0;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (const double round : {1.0, 2.0, 5.0}) {
    if (round * decade >= rough) {
      step = round * decade;
      break;
    }
  }
  std::vector<double> ticks;
  const double first = std::floor(low / step);
  const int steps = static_cast<int>(std::ceil(high / step) - first);
  for (int i = 0; i <= steps; ++i) ticks.push_back((first + i) * step);
  return ticks;
}

std::string to_svg(const Chart& chart) {
  const double panels = static_cast<double>(chart.panels.size());
  const double end = kTop + panels * kPanel + (panels - 1.0) * kGap;
  const double last = chart.times.empty() ? 1.0 : chart.times.back();
  const Scale x{0.0, last > 0.0 ? last : 1.0, kLeft, kWidth - kRight};
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.0f} {1:.0f}' width='{0:.0f}' "
      "height='{1:.0f}' font-family='sans-serif' font-size='12' fill='#333'>\n"
      "<style>path{{fill:none;stroke-width:1.5;stroke-linejoin:round}} .grid{{stroke:#e4e4e4}} "
      ".mark{{stroke:#b0b0b0;stroke-dasharray:3 3}} .title{{font-weight:bold}} "
      ".label{{fill:#666;font-size:11px}}</style>\n"
      "<rect width='100%' height='100%' fill='white'/>\n",
      kWidth, end + kBottom);
  out += text(kLeft, 18, "font-size='14' class='title'", chart.title);
  out += labels(chart, x);
  double top = kTop;
  for (const Panel& panel : chart.panels) {
    out += draw(panel, chart, x, top);
    top += kPanel + kGap;
  }
  for (const double tick : axis_ticks(0.0, x.high)) {
    if (tick > x.high) continue;
    out += line(x(tick), end, x(tick), end + 4, "grid");
    out += text(x(tick), end + 18, "text-anchor='middle'", fmt::format("{:.6g}", tick));
  }
  out += text(kWidth - kRight, end + 34, "text-anchor='end'", "time [s]");
  return out + "</svg>\n";
}

}  // namespace headpin::apps
