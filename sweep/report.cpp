#include "sweep/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/shell_word.h"
#include "study/report.h"
#include "sweep/colours.h"
#include "sweep/result.h"

namespace headpin::sweep {

namespace {

using study::escaped;

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:76em;margin:2em auto;padding:0 1em 5em;"
    "color:#222}table{border-collapse:collapse}td,th{padding:.1em .6em;text-align:right;"
    "border-bottom:1px solid #ddd;font-variant-numeric:tabular-nums}.panels{display:flex;"
    "flex-wrap:wrap;gap:1em}rect[data-i]{cursor:pointer}rect[data-i]:hover{stroke:#000}"
    "#command{position:fixed;bottom:0;left:0;right:0;background:#222;color:#fff;padding:.6em 1em;"
    "font-family:monospace;overflow-wrap:anywhere}.note{color:#555}.failed td{text-align:left}";

constexpr const char* kScript =
    "document.addEventListener('click',e=>{const i=e.target.dataset&&e.target.dataset.i;"
    "if(i!==undefined)document.getElementById('command').textContent=C[i]})";

/// Results with pictures.
constexpr std::array kShown = {"skittles_down",  "impact_speed_mps", "entry_angle_deg",
                               "ball_speed_mps", "energy_lost_j",    "rest_s",
                               "apart_arcmin"};

std::string shown(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.4g}", value);
}

/// One combination of the axes that are neither x nor y.
using Place = std::vector<std::size_t>;

class Page {
 public:
  Page(const Averages& averages, std::size_t x, std::size_t y) : averages_(averages), x_(x), y_(y) {
    Place place(grid().size());
    for (;;) {
      panels_.push_back(place);
      std::size_t axis = grid().size();
      do {
        if (axis == 0) return;
        --axis;
        place[axis] = is_mapped(axis) ? 0 : (place[axis] + 1) % grid()[axis].values.size();
      } while (place[axis] == 0);
    }
  }

  std::string of(std::size_t column) const {
    double low = INFINITY, high = -INFINITY;
    for (const Point& point : averages_.points()) {
      const double value = mean(point, column);
      if (std::isnan(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const ResultColumn& result = result_columns()[column];
    std::string html =
        fmt::format("<h2>{}</h2>\n<p>{}{}</p>\n", result.name, escaped(result.meaning),
                    *result.unit ? fmt::format(" [{}]", result.unit) : "");
    if (low > high) return html + "<p class=note>none of these rows has this number</p>\n";
    html += scale(low, high) + "<div class=panels>\n";
    for (const Place& panel : panels_) html += map(panel, column, low, high);
    html += "</div>\n<details><summary>slices</summary><div class=panels>\n";
    for (const Place& panel : panels_) html += slices(panel, column, low, high);
    html += "</div></details>\n<details><summary>table</summary>\n";
    for (const Place& panel : panels_) html += table(panel, column);
    return html + "</details>\n";
  }

 private:
  static constexpr double kLeft = 62.0, kTop = 26.0, kWide = 270.0, kHigh = 230.0;

  const std::vector<Axis>& grid() const { return averages_.grid(); }
  bool is_mapped(std::size_t axis) const { return axis == x_ || axis == y_; }
  std::size_t count(std::size_t axis) const { return grid()[axis].values.size(); }

  std::size_t number_of(const Point& point) const {
    return static_cast<std::size_t>(&point - averages_.points().data());
  }

  const Point& at(Place place, std::size_t i, std::size_t j) const {
    place[x_] = i;
    if (y_ != x_) place[y_] = j;
    return averages_.at(place);
  }

  std::string title_of(const Place& panel) const {
    std::string title;
    for (std::size_t axis = 0; axis < panel.size(); ++axis) {
      if (is_mapped(axis)) continue;
      title += fmt::format("{}{} = {}", title.empty() ? "" : ", ", grid()[axis].key,
                           grid()[axis].values[panel[axis]]);
    }
    return title;
  }

  static std::string text(double x, double y, const char* anchor, const std::string& words) {
    return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor,
                       escaped(words));
  }

  std::string begin(const Place& panel) const {
    return fmt::format("<svg width='{0}' height='{1}' viewBox='0 0 {0} {1}' font-size='11'>\n",
                       kLeft + kWide + 16, kTop + kHigh + 44) +
           text(kLeft, 16, "start", title_of(panel));
  }

  /// Names of some values of x along the bottom, and its key.
  std::string below() const {
    std::string svg;
    const std::size_t n = count(x_), every = (n + 5) / 6;
    for (std::size_t i = 0; i < n; i += every) {
      svg += text(kLeft + kWide * (static_cast<double>(i) + 0.5) / static_cast<double>(n),
                  kTop + kHigh + 16, "middle", grid()[x_].values[i]);
    }
    return svg + text(kLeft + kWide / 2, kTop + kHigh + 36, "middle", grid()[x_].key);
  }

  /// The legend of the colours.
  static std::string scale(double low, double high) {
    std::string svg = "<p><svg width='430' height='18' font-size='12'>\n";
    svg += text(84, 13, "end", shown(low));
    for (int i = 0; i < 50; ++i) {
      svg += fmt::format("<rect x='{}' width='5.3' height='18' fill='{}'/>\n", 90 + 5 * i,
                         colour(i / 49.0));
    }
    return svg + text(346, 13, "start", shown(high)) + "</svg></p>\n";
  }

  std::string map(const Place& panel, std::size_t column, double low, double high) const {
    const std::size_t nx = count(x_), ny = y_ == x_ ? 1 : count(y_);
    const double wide = kWide / static_cast<double>(nx), tall = kHigh / static_cast<double>(ny);
    std::string svg = begin(panel);
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const Point& point = at(panel, i, j);
        const double value = mean(point, column);
        const double x = kLeft + wide * static_cast<double>(i);
        const double y = kTop + kHigh - tall * static_cast<double>(j + 1);
        const double part = high > low ? (value - low) / (high - low) : 0.5;
        svg += fmt::format(
            "<rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{:.2f}' fill='{}' data-i='{}'>"
            "<title>{}</title></rect>\n",
            x, y, wide + 0.3, tall + 0.3, std::isnan(value) ? "#eee" : colour(part),
            number_of(point), escaped(words_of(point, panel, i, j, column)));
        if (point.failed + point.unsolved > 0) {
          svg += fmt::format(
              "<circle cx='{:.2f}' cy='{:.2f}' r='2' fill='#d00' pointer-events='none'/>\n",
              x + wide / 2, y + tall / 2);
        }
      }
    }
    if (y_ != x_) {
      const std::size_t every = (ny + 9) / 10;
      for (std::size_t j = 0; j < ny; j += every) {
        svg += text(kLeft - 6, kTop + kHigh - tall * (static_cast<double>(j) + 0.5) + 4, "end",
                    grid()[y_].values[j]);
      }
      svg += fmt::format(
          "<text transform='translate(12 {:.1f}) rotate(-90)' "
          "text-anchor='middle'>{}</text>\n",
          kTop + kHigh / 2, escaped(grid()[y_].key));
    }
    return svg + below() + "</svg>\n";
  }

  std::string words_of(const Point& point, const Place& panel, std::size_t i, std::size_t j,
                       std::size_t column) const {
    std::string words = fmt::format("{} = {}", grid()[x_].key, grid()[x_].values[i]);
    if (y_ != x_) words += fmt::format(", {} = {}", grid()[y_].key, grid()[y_].values[j]);
    const std::string title = title_of(panel);
    words += fmt::format("{}{}: {}", title.empty() ? "" : ", ", title, shown(mean(point, column)));
    const std::int64_t with = point.count[column];
    if (point.rows > 1 && with == point.rows) words += fmt::format(", the mean of {} rows", with);
    if (with > 0 && with < point.rows) {
      words += fmt::format(", the mean of {} of {} rows", with, point.rows);
    }
    if (point.failed > 0) words += fmt::format(", {} failed", point.failed);
    if (point.unsolved > 0) words += fmt::format(", {} not solved", point.unsolved);
    return words;
  }

  /// The result over x, a line for each of at most five values of y.
  std::string slices(const Place& panel, std::size_t column, double low, double high) const {
    const std::size_t nx = count(x_), ny = y_ == x_ ? 1 : count(y_);
    const std::size_t lines = std::min<std::size_t>(5, ny);
    std::string svg = begin(panel);
    const auto up = [&](double value) {
      const double part = high > low ? (value - low) / (high - low) : 0.5;
      return kTop + kHigh * (1.0 - part);
    };
    for (const double value : {low, (low + high) / 2, high}) {
      svg += fmt::format("<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' stroke='#ddd'/>\n", kLeft,
                         kLeft + kWide, up(value), up(value));
      svg += text(kLeft - 6, up(value) + 4, "end", shown(value));
    }
    for (std::size_t k = 0; k < lines; ++k) {
      const std::size_t j = lines > 1 ? k * (ny - 1) / (lines - 1) : 0;
      const double part = lines > 1 ? static_cast<double>(k) / static_cast<double>(lines - 1) : 0.0;
      const std::string stroke = colour(0.9 * part);
      std::string path;
      bool down = false;
      for (std::size_t i = 0; i < nx; ++i) {
        const double value = mean(at(panel, i, j), column);
        if (!std::isnan(value)) {
          path += fmt::format(
              "{}{:.1f} {:.1f}", down ? "L" : "M",
              kLeft + kWide * (static_cast<double>(i) + 0.5) / static_cast<double>(nx), up(value));
        }
        down = !std::isnan(value);
      }
      svg +=
          fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.6'/>\n", path, stroke);
      if (y_ == x_) continue;
      svg += fmt::format("<text x='{:.1f}' y='{:.1f}' fill='{}' text-anchor='end'>{} {}</text>\n",
                         kLeft + kWide, kTop + 12.0 + 13.0 * static_cast<double>(k), stroke,
                         escaped(grid()[y_].key), escaped(grid()[y_].values[j]));
    }
    return svg + below() + "</svg>\n";
  }

  std::string table(const Place& panel, std::size_t column) const {
    const std::size_t nx = count(x_), ny = y_ == x_ ? 1 : count(y_);
    std::string html = fmt::format("<p>{}</p><table><tr><th>{}</th>", escaped(title_of(panel)),
                                   escaped(grid()[x_].key));
    for (std::size_t j = 0; j < ny; ++j) {
      html += y_ == x_ ? "<th>mean</th>"
                       : fmt::format("<th>{} {}</th>", escaped(grid()[y_].key),
                                     escaped(grid()[y_].values[j]));
    }
    html += "</tr>\n";
    for (std::size_t i = 0; i < nx; ++i) {
      html += fmt::format("<tr><th>{}</th>", escaped(grid()[x_].values[i]));
      for (std::size_t j = 0; j < ny; ++j) {
        html += fmt::format("<td>{}</td>", shown(mean(at(panel, i, j), column)));
      }
      html += "</tr>\n";
    }
    return html + "</table>\n";
  }

  const Averages& averages_;
  std::size_t x_, y_;
  std::vector<Place> panels_;
};

/// A word for a shell, in quotes only if it needs them.
std::string for_a_shell(const std::string& text) {
  const bool plain = text.find_first_not_of(
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=+-") ==
                     std::string::npos;
  if (plain && !text.empty()) return text;
  return base::shell_word(text);
}

/// JSON that is safe in a script inside a page.
std::string in_script(const nlohmann::json& value) {
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

/// Why rows failed: how many for each reason, and the command of the first of them.
std::string failures_of(const Rows& rows, const Averages& averages, const std::string& folder) {
  constexpr std::size_t kMost = 20;
  const std::vector<Failure> failures = averages.failures();
  if (failures.empty()) return "";
  std::string html =
      "<h2>rows that failed</h2>\n<table class=failed><tr><th>rows</th><th>first</th><th>reason</th>"
      "<th>command of the first</th></tr>\n";
  for (std::size_t i = 0; i < std::min(kMost, failures.size()); ++i) {
    const Failure& one = failures[i];
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", one.rows,
                        one.first + 1, escaped(one.reason),
                        escaped(command_of(rows, rows.at(one.first), folder)));
  }
  html += "</table>\n";
  if (failures.size() <= kMost) return html;
  return html + fmt::format(
                    "<p class=note>There are {} more reasons. The column error of a merged table "
                    "has the reason of every row.</p>\n",
                    failures.size() - kMost);
}

}  // namespace

std::string command_of(const Rows& rows, const Row& row, const std::string& folder) {
  const std::filesystem::path trial = rows.design().trials[row.trial];
  std::string command =
      "headpin replay " +
      for_a_shell((std::filesystem::path(folder) / "trials" / trial.filename()).string());
  for (const std::size_t i : order_of(rows.keys())) {
    const std::string &key = rows.keys()[i], &value = row.values[i];
    if (key == "iterations") {  // replay refuses the option in rows with converged detection
      command += " --set " + for_a_shell("collision.iterations=" + value);
    } else if (std::ranges::find(kOptionKeys, key) != kOptionKeys.end()) {
      command += fmt::format(" --{} {}", key, for_a_shell(value));
    } else {
      command += " --set " + for_a_shell(key + "=" + value);
    }
  }
  return command;
}

std::string html_report(const Rows& rows, const Averages& averages, std::size_t x, std::size_t y,
                        const std::string& folder) {
  const Page page(averages, x, y);
  const Design& design = rows.design();
  const std::string chosen = averages.chosen_in_words();
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><title>Sweep</title>\n<style>{}</style>\n"
      "<h1>Sweep of {} trial{}</h1>\n<p>{} of {} rows{}.{}{} A red dot: a row failed or was not "
      "solved. Click a point to see its command.</p>\n",
      kStyle, design.trials.size(), design.trials.size() == 1 ? "" : "s", averages.done(),
      averages.planned(), chosen.empty() ? "" : fmt::format(" with {}", escaped(chosen)),
      design.trials.size() > 1 ? " Points are means over the trials." : "",
      design.draws > 1 ? fmt::format(" Points are means over {} draws.", design.draws) : "");
  html += failures_of(rows, averages, folder);
  for (std::size_t column = 0; column < result_columns().size(); ++column) {
    if (std::ranges::find(kShown, std::string_view(result_columns()[column].name)) !=
        kShown.end()) {
      html += page.of(column);
    }
  }
  nlohmann::json commands = nlohmann::json::array();
  for (const Point& point : averages.points()) {
    commands.push_back(point.first < 0 ? "not simulated yet"
                                       : command_of(rows, rows.at(point.first), folder));
  }
  html += "<div id=command>headpin replay ...</div>\n<script>const C=";
  html += in_script(commands);
  return html += fmt::format(";{}</script>\n", kScript);
}

}  // namespace headpin::sweep
