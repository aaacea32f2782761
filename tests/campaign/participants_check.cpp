#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/people/participant.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/totals.h"

// How fast virtual participants throw and what they fell.
//
//   participants_check FOLDER [COUNT [FIRST [THROWS [still]]]]
//
// Lets participants FIRST to FIRST + COUNT - 1 (1 and 1000 if not said) play THROWS throws of each
// version of paper-experiment (10 if not said, and no more than the game has: a strike ends a frame);
// with "still" none draws back from what flies at it; writes FOLDER/participants.csv, a row a throw, FOLDER/approaches.csv, a row a thing
// that flew at one, and
// FOLDER/participants.svg, their distributions beside published speeds.
//
// Exit code 1 when one gave up or threw more often.
namespace {

using namespace headpin;
using namespace headpin::scene;

/// What came of one throw.
struct PlayedThrow {
  std::string version;
  int throw_number = 0;
  double speed = 0.0, impact = NAN;
  int frame_ball = 1, down = 0;
};

/// Collects throws from the events of a session.
class ThrowRows : public Observer {
 public:
  void tick(const Session& session) override {
    for (const scene::Event& event : session.events) add(event);
  }
  std::vector<PlayedThrow> rows;
  std::vector<scene::Event> approaches;

 private:
  void add(const scene::Event& event) {
    if (event.kind == kind::version) version_ = event.detail.text(), number_ = 0;
    if (event.kind == kind::release) {
      rows.push_back({.version = version_, .throw_number = ++number_, .speed = event.value});
    }
    if (event.kind == kind::passed_player) approaches.push_back(event);
    if (rows.empty()) return;
    if (event.kind == kind::first_contact) rows.back().impact = event.value;
    if (event.kind == kind::delivery) {
      rows.back().down = static_cast<int>(event.value);
      rows.back().frame_ball = static_cast<int>(event.detail.value_or(BallOfFrame{}).ball);
    }
  }
  std::string version_;
  int number_ = 0;
};

/// Shares of values by bin.
std::vector<double> histogram(const std::vector<double>& values, double low, double width,
                              std::size_t bins) {
  std::vector<double> shares(bins, 0.0);
  for (const double v : values) {
    const double bin = std::floor((v - low) / width);
    if (bin < 0.0 || bin >= static_cast<double>(bins)) continue;
    shares[static_cast<std::size_t>(bin)] += 1.0 / static_cast<double>(values.size());
  }
  return shares;
}

struct Bars {
  std::string name, colour;
  std::vector<double> shares;
};
/// A published range.
struct Band {
  double low, high;
  std::string name;
};

constexpr double kPlotWidth = 760, kPlotHeight = 210, kPlotLeft = 60;

/// One panel of bars beside each other.
std::string panel(double top, const std::string& title, double low, double width, double label_step,
                  const std::vector<Bars>& all, const std::vector<Band>& bands) {
  double most = 0.0;
  for (const Bars& bars : all) {
    for (const double share : bars.shares) most = std::max(most, share);
  }
  most = std::ceil(20.0 * most) / 20.0;
  const std::size_t bins = all.front().shares.size();
  const double bin = kPlotWidth / static_cast<double>(bins), bottom = top + kPlotHeight;
  const auto x_of = [&](double value) { return kPlotLeft + (value - low) / width * bin; };
  std::string svg =
      fmt::format("<text x='{}' y='{}' font-weight='bold'>{}</text>\n", kPlotLeft, top - 28, title);
  double row = 12.0;
  for (const Band& band : bands) {
    svg += fmt::format(
        "<rect x='{:.1f}' y='{}' width='{:.1f}' height='{}' fill='#9a9a9a' opacity='0.25'/>\n"
        "<text x='{:.1f}' y='{}' font-size='11'>{}</text>\n",
        x_of(band.low), top, x_of(band.high) - x_of(band.low), kPlotHeight, x_of(band.low) + 2.0,
        top + row, band.name);
    row += 14.0;
  }
  const double share_wide = 0.9 * bin / static_cast<double>(all.size());
  double key = kPlotLeft;
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (std::size_t i = 0; i < bins; ++i) {
      const double high = all[k].shares[i] / most * kPlotHeight;
      svg += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>\n",
                         kPlotLeft + static_cast<double>(i) * bin + 0.05 * bin +
                             static_cast<double>(k) * share_wide,
                         bottom - high, share_wide, high, all[k].colour);
    }
    svg += fmt::format(
        "<rect x='{}' y='{}' width='10' height='10' fill='{}'/>"
        "<text x='{}' y='{}' font-size='12'>{}</text>\n",
        key, top - 19, all[k].colour, key + 14, top - 10, all[k].name);
    key += 24.0 + 7.0 * static_cast<double>(all[k].name.size());
  }
  for (double v = low; v < low + width * static_cast<double>(bins) + 1e-9; v += label_step) {
    const double centre = label_step == width ? x_of(v) + 0.5 * bin : x_of(v);
    if (label_step == width && v > low + width * (static_cast<double>(bins) - 0.5)) break;
    svg += fmt::format("<text x='{:.1f}' y='{}' font-size='12' text-anchor='middle'>{:g}</text>\n",
                       centre, bottom + 16, label_step == width ? std::round(v + 0.5 * width) : v);
  }
  svg += fmt::format(
      "<line x1='{0}' y1='{1}' x2='{2}' y2='{1}' stroke='black'/>\n"
      "<text x='{3}' y='{4}' font-size='12' text-anchor='end'>{5:.0f} %</text>\n",
      kPlotLeft, bottom, kPlotLeft + kPlotWidth, kPlotLeft - 6, top + 10, 100.0 * most);
  return svg;
}

std::string picture(const std::vector<PlayedThrow>& rows, long long people,
                    const Versions& versions_of) {
  std::map<std::string, std::vector<double>> speeds, impacts, firsts;
  for (const PlayedThrow& row : rows) {
    speeds[row.version].push_back(row.speed);
    if (std::isfinite(row.impact)) impacts[row.version].push_back(row.impact);
    if (row.frame_ball == 1) firsts[row.version].push_back(row.down);
  }
  const std::array<std::pair<const char*, const char*>, 2> versions = {
      {{"red", "#c23b22"}, {"blue", "#1f6fb4"}}};
  const auto bars = [&](std::map<std::string, std::vector<double>>& of, double low, double width,
                        std::size_t bins) {
    std::vector<Bars> all;
    for (const auto& [version, colour] : versions) {
      all.push_back({fmt::format("{} ({} balls)", version, of[version].size()), colour,
                     histogram(of[version], low, width, bins)});
    }
    return all;
  };
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='860' height='960' font-family='sans-serif'>\n"
      "<rect width='860' height='960' fill='white'/>\n"
      "<text x='60' y='26' font-size='16'>{} virtual participants, {} throws; friction {:g} in "
      "red, {:g} in "
      "blue</text>\n",
      people, rows.size(), versions_of.red.friction, versions_of.blue.friction);
  svg += panel(90, "ball as it leaves the hand [m/s]", 2.0, 0.25, 1.0, bars(speeds, 2.0, 0.25, 36),
               {{6.4, 6.6, "measured in virtual reality"}, {8.0, 9.4, "good players, real balls"}});
  svg += panel(390, "ball at the first skittle [m/s]", 2.0, 0.25, 1.0, bars(impacts, 2.0, 0.25, 36),
               {{7.2, 8.0, "good players, real balls"}});
  svg += panel(690, "skittles down by the first ball of a frame (none published)", -0.5, 1.0, 1.0,
               bars(firsts, -0.5, 1.0, 11), {});
  return svg + "</svg>\n";
}

long long number_of(int count, char** arguments, int k, long long otherwise) {
  if (count <= k) return otherwise;
  char* end = nullptr;
  const long long n = std::strtoll(arguments[k], &end, 10);
  if (*end == '\0' && n >= 1) return n;
  std::fprintf(stderr, "participants_check: expected a number from 1, found '%s'\n", arguments[k]);
  std::exit(2);
}

}  // namespace

int main(int count, char** arguments) {
  const bool still = count == 6 && std::string(arguments[5]) == "still";
  if (count < 2 || count > (still ? 6 : 5)) {
    std::fprintf(stderr, "usage: participants_check FOLDER [COUNT [FIRST [THROWS [still]]]]\n");
    return 2;
  }
  const long long people = number_of(count, arguments, 2, 1000);
  const long long first = number_of(count, arguments, 3, 1);
  const int throws = static_cast<int>(number_of(count, arguments, 4, 10));
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  set_up_for_participants(scenario);
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  const std::string folder = arguments[1];
  std::filesystem::create_directories(folder);
  std::ofstream csv(folder + "/participants.csv");
  csv << "participant,version,throw,ball_of_frame,release_mps,impact_mps,skittles_down\n";
  std::ofstream flights(folder + "/approaches.csv");
  flights << "participant,time_s,body,time_to_contact_s,closest_m,head_away_mps2,hand_away_mps2\n";
  std::vector<PlayedThrow> all;
  long long faults = 0, approaches = 0, moved = 0;
  double simulated = 0.0, spent = 0.0;
  for (long long seed = first; seed < first + people; ++seed) {
    Session session = make_session(stage);
    Person person = draw_person(static_cast<std::uint64_t>(seed));
    person.draws_back = !still;
    Participant participant({person, throws}, scenario);
    Stopwatch stopwatch;
    ThrowRows rows;
    const std::array<Observer*, 3> observers = {&stopwatch, &participant, &rows};
    run(session, participant, stopwatch, observers,
        [&](const Session&) { return participant.finished(); });
    simulated += seconds(session.now());
    spent += stopwatch.spent_s();
    for (const nlohmann::json& one : approaches_of(rows.approaches)) {
      ++approaches;
      moved += one["moved"] == true;
      flights << fmt::format("{},{:.3f},{},{:.3f},{:.3f},{:.2f},{:.2f}\n", seed,
                             one["time_s"].get<double>(), one["body"].get<std::string>(),
                             one["time_to_contact_s"].get<double>(), one["closest_m"].get<double>(),
                             one["head_away_mps2"].get<double>(),
                             one["hand_away_mps2"].get<double>());
    }
    if (participant.gave_up() || participant.throws() > 2 * throws) {
      ++faults;
      fmt::print("participant {}: {} throws{}, {:.1f} s\n", seed, participant.throws(),
                 participant.gave_up() ? ", gave up" : "", seconds(session.now()));
    }
    for (const PlayedThrow& row : rows.rows) {
      csv << fmt::format("{},{},{},{},{:.3f},{:.3f},{}\n", seed, row.version, row.throw_number,
                         row.frame_ball, row.speed, row.impact, row.down);
    }
    all.insert(all.end(), rows.rows.begin(), rows.rows.end());
  }
  std::ofstream(folder + "/participants.svg") << picture(all, people, scenario.version);
  const auto n = static_cast<double>(people);
  fmt::print("{} participants, {} throws, {:.0f} s of play and {:.2f} s of work each\n", people,
             all.size(), simulated / n, spent / n);
  fmt::print("{} things flew at them, out of the way of {} of which they moved\n", approaches,
             moved);
  return faults > 0 ? 1 : 0;
}
