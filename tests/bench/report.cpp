#include "tests/bench/report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::bench {

volatile double sink = 0.0;

void write_text(const std::string& path, const std::string& text) {
  namespace fs = std::filesystem;
  fs::create_directories(fs::path(path).parent_path());
  const std::string beside = path + ".tmp";
  {
    std::ofstream out(beside, std::ios::binary);
    out << text;
    if (!out.flush()) throw std::runtime_error("cannot write " + beside);
  }
  fs::rename(beside, path);
}

void publish(const std::string& name, const std::vector<Row>& rows) {
  std::size_t width = 4, peer_width = 4;
  for (const Row& r : rows) {
    width = std::max(width, r.name.size());
    peer_width = std::max(peer_width, r.peer.size());
  }
  fmt::print("{:<{}}  {:>5}  {:>10}  {:<{}}  {:>10}  {:>7}\n", "case", width, "unit", "ours",
             "peer", peer_width, "theirs", "ratio");
  std::string json = "[\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    const double ratio = r.theirs / r.ours;
    fmt::print("{:<{}}  {:>5}  {:>10.5g}  {:<{}}  {:>10.5g}  {:>7.3g}\n", r.name, width, r.unit,
               r.ours, r.peer, peer_width, r.theirs, ratio);
    json += fmt::format(
        R"(  {{"case": "{}", "unit": "{}", "ours": {:.6g}, "peer": "{}", "theirs": {:.6g}, "ratio": {:.6g}}}{})",
        r.name, r.unit, r.ours, r.peer, r.theirs, ratio, i + 1 < rows.size() ? ",\n" : "\n");
  }
  json += "]\n";
  const std::string path = "out/bench/" + name + ".json";
  write_text(path, json);
  fmt::print("written: {}\n", path);
}

std::vector<double> interleaved(const std::vector<Contestant>& contestants, int rounds) {
  std::vector<double> least(contestants.size(), std::numeric_limits<double>::infinity());
  for (const Contestant& c : contestants) sink = sink + c.run();  // warm up
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      sink = sink + contestants[i].run();
      const auto stop = std::chrono::steady_clock::now();
      least[i] = std::min(least[i], std::chrono::duration<double>(stop - start).count());
    }
  }
  return least;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double growth_exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
  const double n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += std::log(x[i]) / n;
    my += std::log(y[i]) / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (std::log(x[i]) - mx) * (std::log(x[i]) - mx);
    xy += (std::log(x[i]) - mx) * (std::log(y[i]) - my);
  }
  return xy / xx;
}

}  // namespace headpin::bench
