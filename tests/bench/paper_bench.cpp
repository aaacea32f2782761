#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/non_colliding.h"
#include "engine/polyhedra.h"
#include "tests/bench/report.h"
#include "tests/support/paper_data.h"

// The paper's comparison (section 2.1), again: 7 compound objects of 22 primitives, all 207 pairs
// of primitives of different objects tested in every frame, no bounding volumes in front of either.
//
// Two algorithms of ours are timed, both from the line of centres in every frame: the converged
// one, whose verdicts are those of the baseline, and the capped one, the paper's iteration for at
// most 20 steps and nothing after it, which calls a few pairs a contact that are none.
namespace {

using namespace headpin;
using namespace headpin::engine;

using Frames = std::vector<std::vector<Pose>>;

/// Calls f(part, part, X_AB, number of the pair) for every pair of primitives of different objects.
template <typename F>
void each_pair(const std::vector<Compound>& objects, const std::vector<Pose>& X_W, F&& f) {
  std::size_t pair = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (const Part& a : objects[i].parts) {
      const Pose X_AW = (X_W[i] * a.X_BG).inverse();
      for (std::size_t j = i + 1; j < objects.size(); ++j) {
        for (const Part& b : objects[j].parts) f(a, b, X_AW * (X_W[j] * b.X_BG), pair++);
      }
    }
  }
}

double by_features(const std::vector<Compound>& objects, const Frames& frames, EarlyOut early_out) {
  int meeting = 0;
  for (const std::vector<Pose>& X_W : frames) {
    each_pair(objects, X_W, [&](const Part& a, const Part& b, const Pose& X_AB, std::size_t) {
      meeting += intersect_by_features(std::get<Polyhedron>(a.shape), std::get<Polyhedron>(b.shape),
                                       X_AB, early_out);
    });
  }
  return meeting;
}

constexpr Query kConverged{}, kCapped{.mode = Query::paper, .cap = 20};

double non_colliding(const std::vector<Compound>& objects, const Frames& frames,
                     const Query& query) {
  int meeting = 0;
  for (const std::vector<Pose>& X_W : frames) {
    each_pair(objects, X_W, [&](const Part& a, const Part& b, const Pose& X_AB, std::size_t) {
      KeptNormal n;
      meeting += !closest_points(a.shape, b.shape, X_AB, n, query).separated;
    });
  }
  return meeting;
}

/// The furthest vertex along n, found by looking at every one.
Vec3 furthest(const Polyhedron& s, const Vec3& n) {
  const Vec3* best = &s.vertices().front();
  double most = n.dot(*best);
  for (const Vec3& p : s.vertices()) {
    const double along = n.dot(p);
    if (along <= most) continue;
    most = along;
    best = &p;
  }
  return *best;
}

/// Whether two polyhedra meet, by the paper's iteration for at most 20 steps with a linear search for
/// each furthest point: its cost is in proportion to the number of vertices. Written here again, so
/// that it has nothing of the engine's table of starts and its climb.
bool meet_by_linear_search(const Polyhedron& a, const Polyhedron& b, const Pose& X_AB) {
  Vec3 n = (X_AB * centre(b) - centre(a)).normalized();
  for (int step = 0; step < 20; ++step) {
    const Vec3 D = X_AB * furthest(b, X_AB.q.conjugate() * -n) - furthest(a, n);
    const double gap = n.dot(D), square = D.squaredNorm();
    if (gap > 0.0) return false;
    if (n.cross(D).squaredNorm() <= 1e-12 * square) return true;
    n = (n - 1.5 * gap / square * D).normalized();
  }
  return true;
}

double by_linear_search(const std::vector<Compound>& objects, const Frames& frames) {
  int meeting = 0;
  for (const std::vector<Pose>& X_W : frames) {
    each_pair(objects, X_W, [&](const Part& a, const Part& b, const Pose& X_AB, std::size_t) {
      meeting +=
          meet_by_linear_search(std::get<Polyhedron>(a.shape), std::get<Polyhedron>(b.shape), X_AB);
    });
  }
  return meeting;
}

struct Point {
  double polygons, full, early, vertices, parametric, capped_vertices, capped_parametric,
      linear;  // microseconds a frame
};

constexpr double kLeft = 76, kTop = 52, kWidth = 560, kHeight = 360;  // of the plot [pixels]

/// Place of a number of polygons, from the left [pixels].
double x(double v) {
  const double x0 = std::log10(150.0), x1 = std::log10(5500.0);
  return kLeft + kWidth * (std::log10(v) - x0) / (x1 - x0);
}

/// Place of a time, from the top [pixels].
/// @param v  [us]
double y(double v) {
  const double y0 = std::log10(3.0), y1 = std::log10(200000.0);
  return kTop + kHeight * (1.0 - (std::log10(v) - y0) / (y1 - y0));
}

std::string grid(const std::vector<Point>& points) {
  std::string svg;
  for (const double v : {10.0, 100.0, 1000.0, 10000.0, 100000.0}) {
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#dddddd\"/><text "
        "x=\"{3}\" "
        "y=\"{4:.1f}\" text-anchor=\"end\">{5} {6}</text>\n",
        kLeft, kLeft + kWidth, y(v), kLeft - 8, y(v) + 4, v < 1000 ? v : v / 1000,
        v < 1000 ? "us" : "ms");
  }
  for (const Point& p : points) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#eeeeee\"/><text "
        "x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x(p.polygons), kTop, kTop + kHeight, kTop + kHeight + 18, p.polygons);
  }
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">polygons in all</text>\n",
                     kLeft + kWidth / 2, kTop + kHeight + 40);
  return svg;
}

/// The paper's claim at its two data sets: 2.5 to 8 times faster than the baseline.
std::string claim(const std::vector<Point>& points) {
  std::string upper, lower;
  for (const Point& p : points) {
    if (p.polygons != 419 && p.polygons != 970) continue;
    upper += fmt::format("{:.1f},{:.1f} ", x(p.polygons), y(p.early / 2.5));
    lower = fmt::format("{:.1f},{:.1f} ", x(p.polygons), y(p.early / 8.0)) + lower;
  }
  return fmt::format(
      "<polygon points=\"{}{}\" fill=\"#f2c14e\" fill-opacity=\"0.55\" stroke=\"#c9971c\"/>\n",
      upper, lower);
}

std::string curves(const std::vector<Point>& points) {
  std::string svg;
  struct Line {
    const char* name;
    const char* colour;
    double Point::*value;
    double down;
  };
  const Line lines[] = {{"baseline, every test made", "#8c2d19", &Point::full, 0},
                        {"baseline, early out", "#d1603d", &Point::early, 0},
                        {"non-colliding on vertices", "#1f6f8b", &Point::vertices, 0},
                        {"non-colliding on parametric surfaces", "#3a9d5d", &Point::parametric, 0}};
  for (const Line& line : lines) {
    std::string path;
    for (const Point& p : points) {
      path += fmt::format("{:.1f},{:.1f} ", x(p.polygons), y(p.*line.value));
    }
    svg +=
        fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.5\"/>\n",
                    path, line.colour);
    for (const Point& p : points) {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n",
                         x(p.polygons), y(p.*line.value), line.colour);
    }
    const Point& last = points.back();
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n",
                       x(last.polygons) + 10, y(last.*line.value) + 4, line.colour, line.name);
  }
  for (const Point& p : points) {
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"#1f6f8b\" "
        "font-weight=\"bold\">{:.1f}x</text>\n",
        x(p.polygons), y(p.vertices) - 9, p.early / p.vertices);
  }
  return svg;
}

std::string picture(const std::vector<Point>& points) {
  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 860 480" width="860" height="480" font-family="sans-serif" font-size="13">
<rect width="860" height="480" fill="#ffffff"/>
<text x="{}" y="24" font-size="16" font-weight="bold">Time for one frame: 7 objects, 22 primitives, 207 pairs</text>
<text x="{}" y="42" fill="#555555">both axes logarithmic; no bounding volumes; non-colliding: converged; ratios are baseline with early out / non-colliding on vertices</text>
)",
      kLeft, kLeft);
  svg += grid(points) + claim(points) + curves(points);
  svg += fmt::format(
      "<rect x=\"{0}\" y=\"{1}\" width=\"14\" height=\"12\" fill=\"#f2c14e\" fill-opacity=\"0.55\" "
      "stroke=\"#c9971c\"/><text x=\"{2}\" y=\"{3}\">2.5 to 8 times faster than the baseline with "
      "early out: the paper, at 419 and 970</text>\n",
      kLeft, 458, kLeft + 20, 468);
  return svg + "</svg>\n";
}

/// How the times grow with the number of polygons.
void add_growth(const std::vector<Point>& points, std::vector<bench::Row>& rows) {
  std::vector<double> x, ours, linear, theirs, full;
  for (const Point& p : points) {
    if (p.polygons < 419) continue;
    x.push_back(p.polygons);
    ours.push_back(p.vertices);
    linear.push_back(p.linear);
    theirs.push_back(p.early);
    full.push_back(p.full);
  }
  rows.push_back({"growth exponent, 419 to 4000, converged", "1", bench::growth_exponent(x, ours),
                  "baseline with early out", bench::growth_exponent(x, theirs)});
  rows.push_back({"growth exponent, 419 to 4000, converged", "1", bench::growth_exponent(x, ours),
                  "baseline without", bench::growth_exponent(x, full)});
  rows.push_back({"growth exponent, 419 to 4000, linear search", "1",
                  bench::growth_exponent(x, linear), "baseline without",
                  bench::growth_exponent(x, full)});
  const double from_419_to_970 =
      points[2].full / points[2].linear / (points[1].full / points[1].linear);
  fmt::print(
      "from 419 to 970 polygons the ratio of the baseline without early out to linear search grows "
      "{:.1f} times, "
      "with early out {:.1f} times; the paper's, from 2.5 to 8, 3.2 times\n",
      from_419_to_970, points[2].early / points[2].linear / (points[1].early / points[1].linear));
}

}  // namespace

int main() {
  using headpin::bench::Row;
  std::vector<Row> rows;
  std::vector<Point> points;
  for (const int polygons : {200, 419, 970, 2000, 4000}) {
    const test::PaperData data = test::paper_data(polygons);
    const Frames frames = test::paper_frames(7, 60, 0.9);
    if (by_features(data.polyhedral, frames, EarlyOut::yes) !=
        non_colliding(data.polyhedral, frames, kConverged)) {
      fmt::print(stderr, "paper: the methods disagree at {} polygons\n", polygons);
      return 1;
    }
    const double meeting = non_colliding(data.polyhedral, frames, kConverged);
    const double said_to = non_colliding(data.polyhedral, frames, kCapped);
    const double pairs = 207.0 * static_cast<double>(frames.size());
    fmt::print("{} polygons: capped at {}, {:.3f} % of all pairs are called a contact wrongly\n",
               polygons, kCapped.cap, 100.0 * (said_to - meeting) / pairs);
    const std::vector<double> s = bench::interleaved(
        {{"early", [&] { return by_features(data.polyhedral, frames, EarlyOut::yes); }},
         {"vertices", [&] { return non_colliding(data.polyhedral, frames, kConverged); }},
         {"parametric", [&] { return non_colliding(data.parametric, frames, kConverged); }},
         {"capped vertices", [&] { return non_colliding(data.polyhedral, frames, kCapped); }},
         {"capped parametric", [&] { return non_colliding(data.parametric, frames, kCapped); }},
         {"linear", [&] { return by_linear_search(data.polyhedral, frames); }}},
        polygons > 1000 ? 7 : 21);
    const std::vector<double> full = bench::interleaved(
        {{"full", [&] { return by_features(data.polyhedral, frames, EarlyOut::no); }}},
        polygons > 1000 ? 1 : 5);
    const double us = 1e6 / static_cast<double>(frames.size());
    points.push_back({static_cast<double>(polygons), us * full[0], us * s[0], us * s[1], us * s[2],
                      us * s[3], us * s[4], us * s[5]});
    const Point& p = points.back();
    const std::string at = std::to_string(polygons) + " polygons, ";
    const auto row = [&](const char* what, double ours, const char* peer, double theirs) {
      rows.push_back({at + what, "us", ours, peer, theirs});
    };
    row("converged on vertices", p.vertices, "baseline with early out", p.early);
    row("converged on vertices", p.vertices, "baseline without", p.full);
    row("converged on parametric", p.parametric, "baseline with early out", p.early);
    row("capped on vertices", p.capped_vertices, "baseline with early out", p.early);
    row("capped by linear search", p.linear, "baseline with early out", p.early);
    row("capped by linear search", p.linear, "baseline without", p.full);
    row("capped on parametric", p.capped_parametric, "baseline with early out", p.early);
  }
  add_growth(points, rows);
  bench::publish("paper", rows);
  bench::write_text("out/bench/paper.svg", picture(points));
  fmt::print("written: out/bench/paper.svg\n");
}
