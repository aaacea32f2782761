#include "sweep/design.h"

#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "sweep/rows.h"
#include "tests/support/folder.h"

namespace headpin::sweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Design of(const std::string& text) {
  return parse_design("trials = ['a.lcmlog']\n" + text, "sweep.toml");
}

TEST(SweepDesign, StepsOfARangeHaveNoDigitsOfRounding) {
  const Design design = of("[grid]\nelasticity = {from = 0, to = 1, steps = 11}\n");
  EXPECT_THAT(design.grid[0].values,
              ElementsAre("0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"));
}

TEST(SweepDesign, RowsAreEveryCombinationTheLastKeyFastestAndTrialsInnermost) {
  const Design design = parse_design(
      "trials = ['a.lcmlog', 'b.lcmlog']\n[grid]\nfriction = [0, 0.5]\nball.mass = [5, 6, 7]\n",
      "sweep.toml");
  ASSERT_EQ(row_count(design), 12);
  const Rows rows(design, {"A", "B"});
  EXPECT_THAT(rows.keys(), ElementsAre("friction", "ball.mass"));
  EXPECT_THAT(rows.at(0).values, ElementsAre("0", "5"));
  EXPECT_EQ(rows.at(1).trial, 1u);
  EXPECT_THAT(rows.at(1).values, ElementsAre("0", "5"));
  EXPECT_THAT(rows.at(2).values, ElementsAre("0", "6"));
  EXPECT_THAT(rows.at(11).values, ElementsAre("0.5", "7"));
  EXPECT_THAT(cells_of(rows, rows.at(11)), ElementsAre(rows.at(11).key, "b", "0.5", "7"));
}

TEST(SweepDesign, AKeyIsOfTheTrialsBytesTheKeysAndTheValuesInAnyOrder) {
  const Rows one(of("[grid]\nfriction = [0, 0.5]\nball.mass = [5, 6]\n"), {"A"});
  const Rows turned(of("[grid]\nball.mass = [6, 5]\nfriction = [0.5, 0]\n"), {"A"});
  const Rows other(of("[grid]\nfriction = [0, 0.5]\nball.mass = [5, 6]\n"), {"B"});
  std::set<std::string> keys, same, others;
  for (std::int64_t i = 0; i < 4; ++i) {
    keys.insert(one.at(i).key);
    same.insert(turned.at(i).key);
    others.insert(other.at(i).key);
    EXPECT_EQ(one.at(i).key.size(), 16u);
  }
  EXPECT_EQ(keys.size(), 4u);
  EXPECT_EQ(keys, same);
  for (const std::string& key : others) EXPECT_FALSE(keys.contains(key));
}

// The scenario's key would win, and the column of the option would have values that no row has.
TEST(SweepDesign, AnOptionThatHasNoEffectBesideOtherKeysIsRefused) {
  bool versions = true;
  const auto says = [&](const std::string& text) -> std::string {
    const Design design = of(text);  // a sweep that is there has it
    try {
      require_effects(design, versions, "sweep.toml");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(says("[grid]\nshape = ['true']\ncollision.shape = ['ellipsoid', 'true']\n"),
            "sweep.toml: 'shape' sets collision.shape, which is a key of this design too; expected "
            "one of them");
  for (const std::string key : {"response", "detection", "iterations"}) {
    EXPECT_THAT(says(fmt::format("[grid]\n{0} = [1]\ncollision.{0} = [1]\n", key)),
                HasSubstr("'" + key + "' sets collision." + key));
  }
  EXPECT_THAT(
      says("[grid]\niterations = [1]\n[random]\ncollision.iterations = {from = 1, to = 9}\n"),
      HasSubstr("'iterations' sets collision.iterations"));
  const std::string some =
      "[grid]\nfriction = [0, 1]\n[grid.material]\nskittle.friction = [0.5]\nball.friction = [0.5]\n"
      "lane.friction = [0.5]\n";
  EXPECT_EQ(says(some), "accepted");  // it is that of the walls
  EXPECT_THAT(says(some + "wall.friction = [0.5]\n"),
              HasSubstr("'friction' sets material.skittle.friction, material.ball.friction"));
  for (const std::string key : {"elasticity", "friction", "shape", "collision.shape"}) {
    const std::string what = key.substr(key.rfind('.') + 1);
    const std::string red = fmt::format("[grid]\n{} = [1]\nversion.red.{} = [1]\n", key, what);
    EXPECT_EQ(says(red), "accepted");  // it is that of the blue version
    EXPECT_THAT(says(fmt::format("{}version.blue.{} = [1]\n", red, what)),
                HasSubstr(fmt::format(
                    "'{0}' sets version.red.{1}, version.blue.{1}, which are each", key, what)));
    versions = false;  // nothing has the values of versions
    EXPECT_EQ(says(fmt::format("{}version.blue.{} = [1]\n", red, what)), "accepted");
    versions = true;
  }
  versions = false;
  EXPECT_THAT(says("[grid]\nshape = ['true']\ncollision.shape = ['true']\n"),
              HasSubstr("'shape' sets collision.shape"));
}

// The profile sets all values of the display, so it is set before one of them.
TEST(SweepDesign, TheDisplaysProfileIsSetBeforeItsValuesInAnyOrder) {
  const auto set = [](const std::vector<std::string>& keys,
                      const std::vector<std::string>& values) {
    return condition_of(keys, values).set;
  };
  EXPECT_THAT(set({"hmd.width", "ball.mass", "hmd.profile"}, {"640", "6", "'flight-helmet'"}),
              ElementsAre("hmd.profile='flight-helmet'", "hmd.width=640", "ball.mass=6"));
  EXPECT_THAT(set({"hmd.profile", "hmd.width"}, {"'flight-helmet'", "640"}),
              ElementsAre("hmd.profile='flight-helmet'", "hmd.width=640"));
}

// McKay, Beckman and Conover (1979): each of the n parts of each range is drawn from once.
TEST(SweepDesign, ALatinHypercubeDrawsEachPartOfEachRangeOnce) {
  const Rows rows(of("[random]\ndraws = 200\nball.mass = {from = 4, to = 8}\nfriction = {from = "
                     "0, to = 1}\n"),
                  {"A"});
  ASSERT_EQ(rows.size(), 200);
  std::set<int> masses, frictions;
  double together = 0.0;
  for (std::int64_t i = 0; i < 200; ++i) {
    const Row row = rows.at(i);
    const double mass = std::stod(row.values[0]), friction = std::stod(row.values[1]);
    masses.insert(static_cast<int>((mass - 4.0) / 4.0 * 200.0));
    frictions.insert(static_cast<int>(friction * 200.0));
    together += (mass - 6.0) / 4.0 * (friction - 0.5) / 200.0;
  }
  EXPECT_EQ(masses.size(), 200u);
  EXPECT_EQ(frictions.size(), 200u);
  EXPECT_NEAR(12.0 * together, 0.0, 4.0 / std::sqrt(200.0));  // correlation: they are independent
}

TEST(SweepDesign, UniformDrawsHaveTheMeanOfTheirRangeAndDependOnTheSeed) {
  const std::string text =
      "[random]\nmethod = 'uniform'\ndraws = 3000\nball.mass = {from = 4, to = 8}\n";
  const Rows rows(of(text + "seed = 5\n"), {"A"}), again(of(text + "seed = 5\n"), {"A"}),
      other(of(text + "seed = 6\n"), {"A"});
  double sum = 0.0;
  for (std::int64_t i = 0; i < 3000; ++i) sum += std::stod(rows.at(i).values[0]);
  EXPECT_NEAR(sum / 3000.0, 6.0, 4.0 * 4.0 / std::sqrt(12.0 * 3000.0));
  EXPECT_EQ(rows.at(77).values, again.at(77).values);
  EXPECT_NE(rows.at(77).values, other.at(77).values);
}

TEST(SweepDesign, WhatCannotBeIsRefusedWithFileAndLine) {
  const auto refuses = [](const std::string& text, const std::string& says) {
    EXPECT_THAT(complaint([&] { parse_design(text, "s.toml"); }), HasSubstr(says)) << text;
  };
  const std::string begin = "trials = ['a.lcmlog']\n";
  refuses("", "s.toml: expected trials");
  refuses("trials = []", "s.toml:1: trials must be a list of files, found []");
  refuses("trials = 'a'", "s.toml:1: trials must be");
  refuses("trials = [3]", "s.toml:1: trials must be");
  refuses(begin + "grids = 3", "s.toml:2: unknown key 'grids'; the nearest is grid");
  refuses(begin + "colour = 3", "s.toml:2: unknown key 'colour'; known here: grid, random, trials");
  refuses(begin + "grid = 3", "s.toml:2: grid must be a table");
  refuses(begin + "[grid]\nfriction = 3", "s.toml:3: friction must be a list of values or {from");
  refuses(begin + "[grid]\nfriction = []", "s.toml:3: friction must be");
  refuses(begin + "[grid]\nfriction = [0, 0]", "s.toml:3: friction must be a list of different");
  refuses(begin + "[grid]\nfriction = {from = 0, to = 1}", "friction.steps must be a whole number");
  refuses(begin + "[grid]\nfriction = {from = 0, to = 1, steps = 1}", "found 1");
  refuses(begin + "[grid]\nfriction = {from = 1, to = 0, steps = 3}", "friction.to must be above");
  refuses(begin + "[grid]\nfriction = {from = 0, to = inf, steps = 3}", "a finite number");
  refuses(begin + "[grid]\nfriction = {from = 0, to = 1, step = 3}", "unknown key 'friction.step'");
  refuses(begin + "[grid]\nfriction = {from = 0, too = 1, steps = 3}",
          "s.toml:3: unknown key 'friction.too'; known here: from, to, steps");
  refuses(begin + "[grid]\nfriction = {from = 0, steps = 3}",
          "s.toml:3: friction.to must be a finite number, found {from = 0, steps = 3}");
  refuses(begin + "[random]\nmethod = 'sobol'\nball.mass = {from = 4, to = 8}",
          "s.toml:3: method must be 'latin-hypercube' or 'uniform'");
  refuses(begin + "[random]\ndraws = 0\nball.mass = {from = 4, to = 8}", "s.toml:3: draws must be");
  refuses(begin + "[random]\ndraws = 3\n", "random must be a table with ranges");
  refuses(begin + "[random]\nball.mass = [4, 8]", "s.toml:3: ball.mass must be a range");
  refuses(begin + "[grid]\nball.mass = [4]\n[random]\nball.mass = {from = 4, to = 8}",
          "s.toml:5: expected each key once, found 'ball.mass' twice");
  refuses(begin +
              "[grid]\na = {from = 0, to = 1, steps = 100000}\nb = {from = 0, to = 1, steps = "
              "100000}\nc = {from = 0, to = 1, steps = 100000}",
          "at most 10000000 rows");
  refuses(begin + "[grid",
          "s.toml:2: not TOML: column 6: '[grid': the text ends within the table header");
  refuses(begin + std::string(100'000, '['), "s.toml");
}

// Cut, doubled and with bytes changed: read, or refused by a message that names the file.
TEST(SweepDesign, AnyTextIsReadOrRefused) {
  const std::string good =
      "trials = ['a.lcmlog', 'b.lcmlog']\n[grid]\nelasticity = {from = 0, to = 1, steps = 5}\n"
      "shape = ['ellipsoid', 'true']\n[random]\ndraws = 3\nmethod = 'uniform'\nseed = 4\n"
      "ball.mass = {from = 5, to = 7}\n";
  Random random(3);
  int read = 0, refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (std::uint64_t n = random.next() % 4; n > 0; --n) {
      const std::size_t at = random.next() % text.size();
      switch (random.next() % 3) {
        case 0:
          text[at] = static_cast<char>(random.next() % 256);
          break;
        case 1:
          text = text.substr(0, at) + text.substr(at + (random.next() % 9) % (text.size() - at));
          break;
        default:
          text.insert(at, text.substr(random.next() % text.size(), random.next() % 20));
      }
    }
    const std::string says = complaint([&] {
      const Design design = parse_design(text, "s.toml");
      const Rows rows(design, std::vector<std::string>(design.trials.size(), "A"));
      rows.at(rows.size() - 1);
    });
    if (says.empty()) {
      ++read;
      continue;
    }
    ++refused;
    EXPECT_THAT(says, testing::StartsWith("s.toml")) << text;
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 100);
}

// They were left out, and the sweep had the trial's own value.
TEST(SweepDesign, AKeyWithAnEmptyTableIsRefused) {
  for (const char* table : {"[grid]\nfriction = {}\n", "[grid]\nball.mass = {}\n", "[grid.lane]\n",
                            "[random]\nball.mass = {from = 4, to = 8}\nball.radius = {}\n"}) {
    EXPECT_THAT(complaint([&] { of(table); }), HasSubstr(".from must be a finite number, found {}"))
        << table;
  }
}

// Rows had the same key and the same values.
TEST(SweepDesign, StepsThatAreTheSameValueAreRefused) {
  const std::string begin = "[grid]\nfriction = {from = 0.1, to = ";
  EXPECT_THAT(complaint([&] { of(begin + "0.1000000000001, steps = 5}\n"); }),
              HasSubstr("friction must be a range whose steps differ within 12 digits, found {"));
  EXPECT_EQ(of(begin + "0.10000000001, steps = 5}\n").grid[0].values.size(), 5u);
}

}  // namespace
}  // namespace headpin::sweep
