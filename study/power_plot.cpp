#include "study/power_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "study/report.h"

namespace headpin::study {

namespace {

constexpr double kLeft = 60.0, kRight = 460.0, kTop = 40.0, kBottom = 360.0;

double up(double share) {
  return kBottom - share * (kBottom - kTop);
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     text);
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
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"620\" height=\"420\" font-size=\"12\" "
      "font-family=\"sans-serif\">\n<rect width=\"620\" height=\"420\" fill=\"white\"/>\n";
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
    std::string points;
    for (const Power& power : all) {
      points += fmt::format("{:.1f},{:.1f} ", across(power.people), up(power.terms[i].found));
    }
    const char* dash = i < kColours.size() ? "none" : "6 3";
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
        "stroke-dasharray=\"{}\"/>\n",
        points, kColours[i % kColours.size()], dash);
    const double y = kTop + 24.0 * static_cast<double>(i);
    svg += fmt::format(
        "<line x1=\"476\" x2=\"500\" y1=\"{0}\" y2=\"{0}\" stroke=\"{1}\" "
        "stroke-width=\"2\" stroke-dasharray=\"{2}\"/>\n",
        y, kColours[i % kColours.size()], dash);
    svg += text_at(506, y + 4, "start", escaped(all.front().terms[i].term));
  }
  return svg + "</svg>\n";
}

}  // namespace headpin::study
