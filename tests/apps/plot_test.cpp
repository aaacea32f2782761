// Plots as PNG and PDF: what librsvg draws is what the SVG says.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <span>

#include "render/image.h"
#include "render/png.h"
#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

using testing::HasSubstr;
using testing::Not;

class PlotFiles : public TrialCommands {
 protected:
  PlotFiles() { EXPECT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0); }
  ~PlotFiles() override { unsetenv("LD_LIBRARY_PATH"); }

  std::string file(const std::string& name) const { return slurp(folder_ / name); }

  /// Whether poppler, which reads PDF, is installed.
  static bool has_poppler() {
    return std::system("command -v pdftoppm pdfinfo pdftotext >/dev/null") == 0;
  }
};

struct PxPoint {
  double x, y;
};

/// The points of each curve of that colour, in the order of the SVG.
std::vector<std::vector<PxPoint>> curves_in(const std::string& svg, const std::string& colour) {
  const std::string begin = "<path d='", end = "' stroke='" + colour + "'/>";
  std::vector<std::vector<PxPoint>> curves;
  std::istringstream lines(svg);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(begin) || !line.ends_with(end)) continue;
    std::string d = line.substr(begin.size(), line.size() - begin.size() - end.size());
    if (d.find('h') != std::string::npos) continue;  // of the legend
    std::ranges::replace_if(
        d, [](char c) { return c == 'M' || c == 'L'; }, ' ');
    std::istringstream numbers(d);
    curves.emplace_back();
    for (PxPoint p{}; numbers >> p.x >> p.y;) curves.back().push_back(p);
  }
  return curves;
}

bool is_coloured(const render::Image& image, int x, int y, std::array<int, 3> colour) {
  constexpr int kRounded = 3;  // in the mixing of colours
  const auto* pixel = image.rgb.data() + 3 * (std::ptrdiff_t{y} * image.width + x);
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(pixel[i] - colour[i]) > kRounded) return false;
  }
  return true;
}

/// The number of points whose pixel has the colour, of a picture with two pixels per px.
///
/// A line is 3 pixels wide and its joints are round, so each pixel that contains a point is within
/// the line: its farthest corner is 1.41 pixels from the point. The ends are not round.
std::size_t drawn_points(const render::Image& image, const std::vector<PxPoint>& curve,
                         std::array<int, 3> colour) {
  std::size_t drawn = 0;
  for (const PxPoint& p : std::span(curve).subspan(1, curve.size() - 2)) {
    drawn += is_coloured(image, static_cast<int>(2.0 * p.x), static_cast<int>(2.0 * p.y), colour);
  }
  return drawn;
}

/// The kinds of chunks of a PNG.
std::set<std::string> chunks_of(const std::string& png) {
  std::set<std::string> kinds;
  for (std::size_t at = 8; at + 8 <= png.size();) {  // after the signature
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      length = 256 * length + static_cast<unsigned char>(png[at + i]);
    }
    kinds.insert(png.substr(at + 4, 4));
    at += 12 + length;  // length, kind, checksum
  }
  return kinds;
}

constexpr std::array<int, 3> kBallBlue{0x1f, 0x6f, 0xb4}, kGrey{0x44, 0x44, 0x44};

TEST_F(PlotFiles, APngHasTheCurvesOfTheSvgInTwiceItsSize) {
  ASSERT_EQ(headpin("plot game.lcmlog -o game.svg").code, 0);
  const nlohmann::json made = json("plot game.lcmlog -o game.png --json");
  EXPECT_EQ(made["output"], "game.png");
  const std::string svg = file("game.svg");
  const render::Image image = render::read_png(folder_ / "game.png");
  EXPECT_THAT(svg, HasSubstr("width='" + std::to_string(image.width / 2) + "' height='" +
                             std::to_string(image.height / 2) + "'"));
  EXPECT_EQ(image.width, 1920);
  // The last curve that is drawn in its panel: nothing lies on it.
  const auto ball = curves_in(svg, "#1f6fb4"), grey = curves_in(svg, "#444444");
  ASSERT_GT(ball.front().size(), 1000U);  // speed, in the first panel
  ASSERT_GT(grey.back().size(), 100U);    // contact points, in the last
  EXPECT_EQ(drawn_points(image, ball.front(), kBallBlue), ball.front().size() - 2);
  EXPECT_EQ(drawn_points(image, grey.back(), kGrey), grey.back().size() - 2);
  EXPECT_TRUE(is_coloured(image, 0, 0, {255, 255, 255}));
  EXPECT_TRUE(is_coloured(image, image.width - 1, image.height - 1, {255, 255, 255}));
}

// A session has more events than there is room for their labels.
TEST_F(PlotFiles, LabelsOfASessionDoNotLieOverEachOther) {
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 3 -o samples.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay samples.lcmlog -o session.lcmlog").code, 0);
  ASSERT_EQ(headpin("plot session.lcmlog -o session.svg").code, 0);
  const std::string svg = file("session.svg");
  constexpr double kLetter = 6.0;  // px, of 11 px high letters, about
  std::map<std::string, double> ends;
  std::size_t labels = 0;
  const std::regex label("<text x='([0-9.]+)' y='([0-9.]+)'[^>]*class='label'>([^<]*)<");
  for (std::sregex_iterator at(svg.begin(), svg.end(), label), end; at != end; ++at, ++labels) {
    const double x = std::stod((*at)[1]),
                 half = 0.5 * kLetter * static_cast<double>((*at)[3].length());
    const auto before = ends.find((*at)[2]);
    if (before != ends.end()) {
      EXPECT_GT(x - half, before->second) << (*at)[3] << " at " << x;
    }
    ends[(*at)[2]] = x + half;
  }
  EXPECT_EQ(ends.size(), 2u);
  EXPECT_GT(labels, 10u);
  // The marks of all events are there.
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = svg.find(what, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_GT(count("class='mark'"), 5 * labels);
}

TEST_F(PlotFiles, APdfIsOnePageOfTheSamePicture) {
  if (!has_poppler()) GTEST_SKIP() << "no pdftoppm (Debian: poppler-utils)";
  ASSERT_EQ(headpin("plot game.lcmlog -o game.svg").code, 0);
  ASSERT_EQ(headpin("plot game.lcmlog -o game.png").code, 0);
  ASSERT_EQ(headpin("plot game.lcmlog -o game.pdf").code, 0);
  const std::string info = shell("pdfinfo game.pdf").out;
  EXPECT_THAT(info, testing::ContainsRegex("Pages: +1\n"));
  EXPECT_THAT(info, testing::ContainsRegex("Page size: +720 x "));  // 960 px of 1/96 inch, in 1/72
  EXPECT_THAT(info, Not(HasSubstr("Date")));
  EXPECT_THAT(shell("pdftotext game.pdf -").out, HasSubstr("height of the centre of mass [m]"));
  ASSERT_EQ(shell("pdftoppm -r 192 -singlefile -png game.pdf read").code, 0);
  const render::Image image = render::read_png(folder_ / "game.png");
  const render::Image read = render::read_png(folder_ / "read.png");
  EXPECT_EQ(read.width, image.width);
  EXPECT_EQ(read.height, image.height);
  const auto ball = curves_in(file("game.svg"), "#1f6fb4");
  // Poppler mixes colours at edges in its own way.
  EXPECT_GT(drawn_points(read, ball.front(), kBallBlue), ball.front().size() * 9 / 10);
}

TEST_F(PlotFiles, HaveNoDateAndTheSameBytesTwice) {
  for (const std::string ending : {".png", ".pdf"}) {
    ASSERT_EQ(headpin("plot game.lcmlog -o once" + ending).code, 0);
    ASSERT_EQ(headpin("plot game.lcmlog -o twice" + ending).code, 0);
    EXPECT_EQ(file("once" + ending), file("twice" + ending)) << ending;
  }
  const std::string pdf = file("once.pdf"), png = file("once.png");
  EXPECT_THAT(pdf, testing::StartsWith("%PDF-"));
  EXPECT_THAT(pdf, testing::EndsWith("%%EOF\n"));
  for (const char* date : {"/CreationDate", "/ModDate"}) EXPECT_THAT(pdf, Not(HasSubstr(date)));
  EXPECT_EQ(chunks_of(png), (std::set<std::string>{"IHDR", "sRGB", "pHYs", "IDAT", "IEND"}));
}

TEST_F(PlotFiles, OfStudiesArePngAndPdfToo) {
  const std::string power = "experiment power --people 18,72 --studies 2 -o ";
  ASSERT_EQ(headpin(power + "power.svg").code, 0);
  ASSERT_EQ(headpin(power + "power.png").code, 0);
  ASSERT_EQ(headpin(power + "power.pdf").code, 0);
  const render::Image image = render::read_png(folder_ / "power.png");
  EXPECT_EQ(image.width, 2 * 620);
  EXPECT_EQ(image.height, 2 * 420);
  std::smatch legend;  // a line of the first term, 4 pixels wide
  const std::string svg = file("power.svg");
  ASSERT_TRUE(std::regex_search(
      svg, legend, std::regex("<line x1=\"476\" x2=\"500\" y1=\"([0-9.]+)\"[^>]*#1f6fb4")));
  EXPECT_TRUE(is_coloured(image, 2 * 488, static_cast<int>(2.0 * std::stod(legend[1])), kBallBlue));
  EXPECT_THAT(file("power.pdf"), testing::StartsWith("%PDF-"));
}

TEST_F(PlotFiles, AnOddNameIsATitleThatCanBeRead) {
  fs::copy_file(folder_ / "game.lcmlog", folder_ / "a\n\x01<&\xff.lcmlog");
  const Result made = shell("for f in a*.lcmlog; do $headpin plot \"$f\" -o odd.png; done");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(render::read_png(folder_ / "odd.png").width, 1920);
}

TEST_F(PlotFiles, WithoutLibrsvgOnlySvgIsDrawnAndThePackageIsNamed) {
  ASSERT_EQ(json("doctor --json")["librsvg"]["works"], true);
  std::ofstream(folder_ / "librsvg-2.so.2") << "";  // found first, and nothing that can be loaded
  setenv("LD_LIBRARY_PATH", folder_.c_str(), 1);
  const std::string missing = "cannot load librsvg-2.so.2 (Debian: librsvg2-2): ";
  expect_refusal("plot game.lcmlog -o OUT.png", 1, "OUT.png: " + missing);
  expect_refusal("plot game.lcmlog -o OUT.pdf", 1, "OUT.pdf: " + missing);
  // Before the studies are simulated: a million of them take hours.
  expect_refusal("experiment power --studies 1000000 -o OUT.pdf", 1, "OUT.pdf: " + missing);
  EXPECT_EQ(headpin("plot game.lcmlog -o game.svg").code, 0);
  const nlohmann::json librsvg = json("doctor --json")["librsvg"];
  EXPECT_EQ(librsvg["works"], false);
  EXPECT_THAT(std::string(librsvg["says"]), testing::StartsWith(missing));
  EXPECT_EQ(librsvg["remedy"], "apt-get install librsvg2-2");

  fs::copy_file(NO_THREADS, folder_ / "librsvg-2.so.2", fs::copy_options::overwrite_existing);
  expect_refusal("plot game.lcmlog -o OUT.png", 1,
                 "OUT.png: librsvg-2.so.2 is too old: expected 2.52 or newer");
}

}  // namespace
}  // namespace headpin
