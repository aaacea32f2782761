#include "study/power_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "study/report.h"

namespace headpin::study {

namespace {

constexpr double kLeft = 60.0, kRight = 460.0, kTop = 40.0, kBottom = 360.0;
constexpr double kLegend = 506.0, kLine = 24.0;  // where names begin, from one name to the next

double up(double share) {
  return kBottom - share * (kBottom - kTop);
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     text);
}

struct Size {
  double width = 620.0, height = 420.0;
};

/// The least size [px] that has room for plot and legend.
Size size_of(const std::vector<TermPower>& terms) {
  constexpr double kLetter = 8.0, kMargin = 16.0;  // a letter's width, but for rare ones
  Size size;
  for (const TermPower& term : terms) {
    const double length = kLetter * static_cast<double>(term.term.size());
    size.width = std::max(size.width, kLegend + length + kMargin);
  }
  size.height = std::max(size.height, kTop + kLine * static_cast<double>(terms.size()) + kMargin);
  return size;
}

}  // namespace

std::string power_svg(const std::vector<Power>& all) {
  constexpr auto kColours =
      std::to_array({"#1f6fb4", "#b42d2d", "#2d8a4e", "#c9a227", "#7a4fb4", "#444444"});
  const double least = std::log(all.front().people), most = std::log(all.back().people);
  const auto across = [&](int people) {
    const double span = most > least ? (std::log(people) - least) / (most - least) : 0.5;
    return kLeft + span * (kRight - kLeft);
  };
  const Size size = size_of(all.front().terms);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-size=\"12\" font-family=\"sans-serif\">\n<rect width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" fill=\"white\"/>\n",
      size.width, size.height);
  svg += text_at(kLeft, 20, "start",
                 fmt::format("Share of {} simulated studies that find a term at 5 % (virtual "
                             "participants)",
                             all.front().studies));
  for (int tenth = 0; tenth <= 10; tenth += 2) {
    const double y = up(0.1 * tenth);
    svg += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n",
                       kLeft, kRight, y, y);
    svg += text_at(kLeft - 8, y + 4, "end", fmt::format("{:.1f}", 0.1 * tenth));
  }
  for (const Power& power : all) {
    svg += text_at(across(power.people), kBottom + 20, "middle", fmt::format("{}", power.people));
  }
  svg += text_at(0.5 * (kLeft + kRight), kBottom + 42, "middle", "participants");
  for (std::size_t i = 0; i < all.front().terms.size(); ++i) {
    const char* const colour = kColours[i % kColours.size()];
    std::string points, circles;
    for (const Power& power : all) {
      const double x = across(power.people), y = up(power.terms[i].found);
      points += fmt::format("{:.1f},{:.1f} ", x, y);
      circles +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x, y, colour);
    }
    const char* dash = i < kColours.size() ? "none" : "6 3";
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
        "stroke-dasharray=\"{}\"/>\n",
        points, colour, dash);
    svg += circles;
    const double y = kTop + kLine * static_cast<double>(i);
    svg += fmt::format(
        "<line x1=\"476\" x2=\"500\" y1=\"{0}\" y2=\"{0}\" stroke=\"{1}\" "
        "stroke-width=\"2\" stroke-dasharray=\"{2}\"/>\n",
        y, colour, dash);
    svg += text_at(kLegend, y + 4, "start", escaped(all.front().terms[i].term));
  }
  return svg + "</svg>\n";
}

}  // namespace headpin::study
