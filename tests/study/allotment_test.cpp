// Who gets which conditions: Table 2 of the paper, orders and colours in balance, nobody moved.

#include <map>
#include <set>

#include <gmock/gmock.h>

#include "study/plan.h"
#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

Plan planned(const Design& design, std::uint64_t seed, int people) {
  Plan plan;
  extend(plan, design, seed, people);
  return plan;
}

// Table 2 as it is printed: EFS, changed parameter, number of subjects.
TEST(Allotment, EighteenPeopleFillTableTwo) {
  const std::map<std::pair<std::string, std::string>, int> table = {
      {{"000", "shape"}, 2},    {{"000", "friction"}, 2},   {{"000", "elasticity"}, 2},
      {{"100", "shape"}, 1},    {{"010", "shape"}, 1},      {{"100", "friction"}, 1},
      {{"001", "friction"}, 1}, {{"010", "elasticity"}, 1}, {{"001", "elasticity"}, 1},
      {{"110", "shape"}, 2},    {{"101", "friction"}, 2},   {{"011", "elasticity"}, 2}};
  const Design design = bundled_design();
  EXPECT_EQ(design.block(), 18);
  for (const std::uint64_t seed : {1u, 2u, 77u}) {
    std::map<std::pair<std::string, std::string>, int> rows;
    for (const PlannedParticipant& one : planned(design, seed, 18)) {
      ++rows[{cell_of(design, one), changed_key_of(design, one)}];
    }
    EXPECT_EQ(rows, table);
  }
}

// By the binomial law one share of half of six people is 3; of every odd group one is left over.
TEST(Allotment, OrderAndColourAreBalancedWithinABlockAndAChangedParameter) {
  for (const char* name : {"uno-slater-1997", "elasticity-friction-shape"}) {
    const Design design = bundled_design(name);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Plan plan = planned(design, seed, 4 * design.block());
      for (int block = 0; block < 4; ++block) {
        std::map<std::string, std::array<int, 3>> counts;  // people, changed first, base red
        for (int i = 0; i < design.block(); ++i) {
          const PlannedParticipant& one =
              plan[static_cast<std::size_t>(block * design.block() + i)];
          auto& [people, first, red] = counts[changed_key_of(design, one)];
          ++people;
          first += one.allotted.changed_first;
          red += one.allotted.base_is_red;
        }
        for (const auto& [changed, count] : counts) {
          EXPECT_EQ(count[0], 2 * count[1]) << name << " " << seed << " " << changed;
          EXPECT_EQ(count[0], 2 * count[2]) << name << " " << seed << " " << changed;
        }
      }
      std::map<std::size_t, std::map<std::pair<bool, bool>, int>> combinations;
      for (const PlannedParticipant& one : plan) {
        ++combinations[one.allotted.row][{one.allotted.changed_first, one.allotted.base_is_red}];
      }
      for (const auto& [row, counts] : combinations) {
        for (const auto& [which, count] : counts) EXPECT_EQ(count, design.rows[row].people);
        EXPECT_EQ(counts.size(), 4u);
      }
    }
  }
}

TEST(Allotment, SeedsDiffer) {
  const Design design = bundled_design();
  std::set<std::string> plans;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    plans.insert(to_csv(planned(design, seed, 18), design));
  }
  EXPECT_EQ(plans.size(), 50u);
}

TEST(Allotment, MorePeopleMoveNobody) {
  const Design design = bundled_design();
  const Plan all = planned(design, 7, 100);
  for (const int people : {1, 5, 18, 19, 50, 99}) {
    Plan plan = planned(design, 7, people);
    EXPECT_EQ(plan, Plan(all.begin(), all.begin() + people));
    extend(plan, design, 7, 100);
    EXPECT_EQ(plan, all);
  }
}

TEST(Allotment, APlaceThatBecameFreeIsGivenAgain) {
  const Design design = bundled_design();
  const Plan all = planned(design, 7, 18);
  Plan plan = all;
  plan.erase(plan.begin() + 4);
  extend(plan, design, 7, 18);
  EXPECT_EQ(plan.back().place, all[4].place);
  EXPECT_EQ(plan.back().allotted, all[4].allotted);
}

TEST(Allotment, WhoReplacesADropOutGetsTheSameConditions) {
  const Design design = bundled_design();
  Plan plan = planned(design, 7, 18);
  replace(plan, "p004");
  EXPECT_EQ(plan.back().id, "p019");
  EXPECT_EQ(plan.back().allotted, plan[3].allotted);
  EXPECT_EQ(plan.back().replaces, "p004");
  EXPECT_NE(complaint([&] { replace(plan, "p004"); }), "");
  EXPECT_NE(complaint([&] { replace(plan, "p400"); }), "");
  extend(plan, design, 7, 18);  // p004 is not counted
  EXPECT_EQ(plan.size(), 19u);
  EXPECT_EQ(parse_plan(to_csv(plan, design), "plan.csv", design), plan);
}

}  // namespace
}  // namespace headpin::study
