/// Whole steps of the bowling scene beside Bullet, ODE and MuJoCo: same bodies, same start, 240 Hz,
/// one core, in turn.
///
///   world_bench [--quick | --pins]   --pins: only how many skittles fall

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <stdexcept>

#include "engine/workspace.h"
#include "tests/bench/peers.h"
#include "tests/bench/report.h"
#include "tests/support/bowling.h"

namespace headpin::bench {
namespace {

using Make = std::function<std::unique_ptr<Contender>(const Scene&)>;

class Ours final : public Contender {
 public:
  /// @param as_peers  with their restitution and friction, and no rolling resistance
  explicit Ours(const Scene& scene, std::string_view response = "paper", bool as_peers = false,
                int threads = 1) {
    engine::RackOptions o;
    o.parameters.threads = threads;
    o.parameters.response = response;
    o.parameters.sleep = scene.sleep;
    o.ball = scene.ball;
    o.ball_offset = scene.ball_offset;
    o.racks = scene.racks;
    bowling_ = engine::bowling(o);
    if (!as_peers) return;
    for (engine::Body& body : bowling_.world.bodies) body.material = {0.8, std::sqrt(0.3)};
    bowling_.world.bodies[bowling_.lane].material.elasticity = 0.25;
  }
  void step() override { engine::step(bowling_.world, workspace_); }
  int skittles_down() const override {
    int down = 0;
    for (const engine::BodyId i : bowling_.skittles) {
      down += engine::upright(bowling_.world.states[i]) < 0.86602540378443864676;
    }
    return down;
  }

 private:
  engine::Bowling bowling_;
  engine::Workspace workspace_;
};

/// Microseconds per step.
struct Times {
  double mean = 0.0, median = 0.0, p99 = 0.0, peak = 0.0;
};

Times run_once(const Make& make, const Scene& scene, double seconds) {
  const std::unique_ptr<Contender> contender = make(scene);
  std::vector<double> steps(static_cast<std::size_t>(std::lround(seconds * 240)));
  for (double& t : steps) {
    const auto start = std::chrono::steady_clock::now();
    contender->step();
    t = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  }
  sink = sink + contender->skittles_down();
  Times out;
  for (const double t : steps) out.mean += t / static_cast<double>(steps.size());
  std::sort(steps.begin(), steps.end());
  out.median = steps[steps.size() / 2];
  out.p99 = steps[steps.size() * 99 / 100];
  out.peak = steps.back();
  return out;
}

struct Entrant {
  std::string name;
  Make make;
};

const Entrant kOurs{"headpin", [](const Scene& s) { return std::make_unique<Ours>(s); }};
const Entrant kTwoThreads{
    "headpin", [](const Scene& s) { return std::make_unique<Ours>(s, "paper", false, 2); }};
const Entrant kBullet{"Bullet", make_bullet};
const Entrant kOde{"ODE", make_ode};
const Entrant kMujoco{"MuJoCo", make_mujoco};

/// Runs in turn, ours first; the median run of each.
std::vector<Times> compare(const std::vector<Entrant>& entrants, const Scene& scene, double seconds,
                           int rounds) {
  std::vector<std::vector<Times>> runs(entrants.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < entrants.size(); ++i) {
      runs[i].push_back(run_once(entrants[i].make, scene, seconds));
    }
  }
  std::vector<Times> out;
  for (const std::vector<Times>& r : runs) {
    const auto middle = [&](double Times::*value) {
      std::vector<double> all;
      for (const Times& t : r) all.push_back(t.*value);
      return median(all);
    };
    out.push_back(
        {middle(&Times::mean), middle(&Times::median), middle(&Times::p99), middle(&Times::peak)});
  }
  return out;
}

void add_rows(std::vector<Row>& rows, const std::string& name, const std::vector<Entrant>& entrants,
              const std::vector<Times>& times) {
  const auto add = [&](const char* what, double Times::*value) {
    for (std::size_t i = 1; i < entrants.size(); ++i) {
      rows.push_back(
          {name + ", " + what, "us", times[0].*value, entrants[i].name, times[i].*value});
    }
  };
  add("mean", &Times::mean);
  add("median", &Times::median);
  add("p99", &Times::p99);
  add("peak", &Times::peak);
}

constexpr int kOffsets = 41;  // of the ball, from -0.1 m in steps of 5 mm

int pins_down(const Make& make, int offset) {
  Scene scene;
  scene.ball_offset = -0.1 + 0.005 * offset;
  const std::unique_ptr<Contender> contender = make(scene);
  for (int i = 0; i < 5 * 240; ++i) contender->step();
  return contender->skittles_down();
}

double pins_down(const Make& make) {
  int down = 0;
  for (int k = 0; k < kOffsets; ++k) down += pins_down(make, k);
  return static_cast<double>(down) / kOffsets;
}

/// Ours under both responses beside the peers: how many fall, and how that is spread.
void table_of_pins() {
  const std::vector<Entrant> entrants{
      {"paper", kOurs.make},
      {"coulomb", [](const Scene& s) { return std::make_unique<Ours>(s, "coulomb"); }},
      {"coulomb, set as peers",
       [](const Scene& s) { return std::make_unique<Ours>(s, "coulomb", true); }},
      kBullet,
      kOde,
      kMujoco};
  std::printf("%-22s %6s   %s\n", "240 Hz, 41 offsets", "mean", "games with 0 to 10 down");
  for (const Entrant& entrant : entrants) {
    std::array<int, 11> games{};
    int down = 0;
    for (int k = 0; k < kOffsets; ++k) {
      const int fell = pins_down(entrant.make, k);
      ++games[static_cast<std::size_t>(fell)];
      down += fell;
    }
    std::printf("%-22s %6.2f  ", entrant.name.c_str(), static_cast<double>(down) / kOffsets);
    for (const int n : games) std::printf(" %2d", n);
    std::printf("\n");
  }
}

void run(bool quick) {
  const int rounds = quick ? 1 : 7;
  const std::vector<Entrant> all{kOurs, kBullet, kOde, kMujoco}, sleepers{kOurs, kBullet, kOde};
  std::vector<Row> rows;
  const auto case_of = [&](const std::string& name, const std::vector<Entrant>& entrants,
                           const Scene& scene, double seconds, int times) {
    const std::vector<Times> t = compare(entrants, scene, seconds, times);
    add_rows(rows, name, entrants, t);
    return t;
  };
  run_once(kOurs.make, {}, 2.0);  // wakes the processor up
  case_of("rack and ball, sleep off", all, {}, 5.0, rounds);
  const std::vector<Times> game =
      case_of("rack and ball, sleep on", sleepers, {.sleep = true}, 5.0, rounds);
  case_of("standing awake", all, {.ball = false}, 5.0, rounds);
  case_of("standing asleep", sleepers, {.ball = false, .sleep = true}, 5.0, rounds);

  // The first two seconds, when everything falls; each skittle in the same way.
  std::vector<double> skittles, ours;
  for (const int racks : {1, 10, 100, 1000}) {
    if (quick && racks > 100) break;
    const Scene scene{.racks = racks};
    const std::vector<Times> t =
        compare(racks > 10 ? std::vector<Entrant>{kOurs, kBullet} : sleepers, scene, 2.0,
                racks < 1000 ? std::min(rounds, 3) : 1);
    skittles.push_back(10.0 * racks);
    ours.push_back(t[0].mean);
    rows.push_back({std::to_string(10 * racks) + " skittles, 2 s, mean", "us", t[0].mean, "Bullet",
                    t[1].mean});
  }
  if (!quick) {  // and whole games, which end lying still
    const std::vector<Times> t = compare({kOurs, kBullet}, {.racks = 100}, 5.0, 3);
    rows.push_back({"1000 skittles, 5 s, mean", "us", t[0].mean, "Bullet", t[1].mean});
  }
  for (const int racks : {100, 1000}) {
    if (quick) break;
    const std::vector<Times> t = compare({kTwoThreads, kOurs}, {.racks = racks}, 2.0, 3);
    rows.push_back({std::to_string(10 * racks) + " skittles, 2 s, two threads, mean", "us",
                    t[0].mean, "one thread", t[1].mean});
  }
  rows.push_back({"growth with skittles, aim 1.08", "exponent", growth_exponent(skittles, ours),
                  "linear", 1.0});
  rows.push_back(
      {"5 s game, sleep on, aim 1000 x real time", "s", 1200e-6 * game[0].mean, "real time", 5.0});
  const double mine = pins_down(kOurs.make);
  rows.push_back({"pins down over 41 offsets", "pins", mine, "Bullet", pins_down(make_bullet)});
  rows.push_back({"pins down over 41 offsets", "pins", mine, "ODE", pins_down(make_ode)});
  rows.push_back({"pins down over 41 offsets", "pins", mine, "MuJoCo", pins_down(make_mujoco)});
  publish("world", rows);
}

}  // namespace
}  // namespace headpin::bench

int main(int argc, char** argv) {
  try {
    const std::string option = argc > 1 ? argv[1] : "";
    if (option == "--pins") {
      headpin::bench::table_of_pins();
    } else {
      headpin::bench::run(option == "--quick");
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "world_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
