#include "sweep/folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/sha256.h"
#include "study/csv.h"
#include "tests/support/folder.h"

namespace headpin::sweep {
namespace {

namespace fs = std::filesystem;

class SweepFolderTest : public testing::Test {
 protected:
  SweepFolderTest() {
    fs::copy_file(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog", folder_ / "t.lcmlog");
  }

  std::string planned(const std::string& grid) const {
    spit(folder_ / "sweep.toml", "trials = ['t.lcmlog']\n[grid]\n" + grid);
    return complaint([&] { plan(folder_ / "sweep.toml", SweepFolder{folder_ / "sweep"}, [] {}); });
  }

  const TemporaryFolder folder_;
};

// It may have been planned, and simulated, before such a design was refused.
TEST_F(SweepFolderTest, ASweepWhoseDesignIsRefusedTodayOpens) {
  struct Old {
    const char *grid, *refused;
  };
  const std::vector<Old> all = {
      {"shape = ['ellipsoid', 'true']\ncollision.shape = ['true']\n",
       "'shape' sets collision.shape"},
      {"shape = ['ellipsoid', 'true']\nfriction = {}\n", "friction.from must be a finite number"},
      {"friction = {from = 0.1, to = 0.1000000000001, steps = 2}\n",
       "friction must be a range whose steps differ within 12 digits"},
      {"shape = ['ellipsoid', 'true']\n[random]\nfriction = {from = 0.1, to = 0.2}\n"
       "ball.mass = {}\n",
       "ball.mass.from must be a finite number"}};
  for (const Old& old : all) {
    EXPECT_THAT(planned(old.grid), testing::HasSubstr(old.refused));
    ASSERT_EQ(planned("shape = ['ellipsoid', 'true']\n"), "");
    const SweepFolder at{folder_ / "sweep"};
    const std::string text = std::string("trials = ['t.lcmlog']\n[grid]\n") + old.grid;
    const Rows rows(parse_design(text, "sweep.toml", DesignOf::planned_sweep),
                    {base::sha256(slurp(folder_ / "t.lcmlog"))});
    std::string table = study::csv_line(columns_of(rows));
    for (std::int64_t i = 0; i < rows.size(); ++i) {
      table += study::csv_line(cells_of(rows, rows.at(i)));
    }
    spit(at.design(), text);
    spit(at.rows(), table);
    EXPECT_EQ(open_sweep(at.root).rows.size(), 2) << old.grid;
    fs::remove_all(at.root);
  }
}

// Only versions have values of their own: the bundled throw has none, its elasticity counts.
TEST_F(SweepFolderTest, KeysOfVersionsStandForThoseOfBothOnlyInRowsWithVersions) {
  const std::string keys =
      "elasticity = [0.5, 0.7]\nversion.red.elasticity = [0.3]\nversion.blue.elasticity = [0.3]\n";
  const std::string refused = "'elasticity' sets version.red.elasticity, version.blue.elasticity";
  EXPECT_THAT(planned(keys + "version.buttons = [true]\n"), testing::HasSubstr(refused));
  EXPECT_EQ(planned(keys + "version.buttons = [false]\n"), "");
  fs::remove_all(folder_ / "sweep");
  EXPECT_EQ(planned(keys + "version.buttons = [false, true]\n"), "");
  fs::remove_all(folder_ / "sweep");
  EXPECT_EQ(planned(keys), "");
}

// What was expected and what was found looked equal: of a line its end, or its first 40 letters.
TEST_F(SweepFolderTest, OfAnotherLineItIsSaidWhereItDiffers) {
  ASSERT_EQ(planned("shape = ['ellipsoid', 'true']\nfriction = [0.25]\n"), "");
  const SweepFolder at{folder_ / "sweep"};
  const std::string rows = slurp(at.rows());
  const auto said_of = [&](const std::string& text) {
    spit(at.rows(), text);
    return complaint([&] { open_sweep(at.root); });
  };
  std::string crlf;
  for (const char c : rows) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(said_of(crlf),
            at.rows().string() +
                ":1: expected a line that ends with a line feed, found one that ends with a "
                "carriage return and a line feed; `sed -i 's/\\r$//' " +
                at.rows().string() + "` changes all of them back");
  EXPECT_EQ(said_of(rows.substr(0, rows.size() - 1)),
            at.rows().string() + ":3: expected a line feed at its end, found none");
  std::string other = rows;
  other[other.rfind("0.25") + 3] = '6';
  EXPECT_THAT(said_of(other),
              testing::HasSubstr(":3: expected '0.25', as sweep.toml and the trials say, found "
                                 "'0.26'; plan a new sweep"));
  EXPECT_EQ(said_of(rows), "");
}

// Names of trials that differ behind their first 40 letters looked equal.
TEST_F(SweepFolderTest, OfALongCellItIsSaidWhereItDiffers) {
  const std::string name = "participant-17_condition-ellipsoid_m\u00fcdig_run-5_session-02";
  fs::copy_file(folder_ / "t.lcmlog", folder_ / (name + ".lcmlog"));
  spit(folder_ / "sweep.toml", "trials = ['" + name + ".lcmlog']\n[grid]\nfriction = [0.25]\n");
  const SweepFolder at{folder_ / "sweep"};
  plan(folder_ / "sweep.toml", at, [] {});
  std::string rows = slurp(at.rows());
  rows[rows.find("session-02") + 9] = '3';
  spit(at.rows(), rows);
  EXPECT_THAT(complaint([&] { open_sweep(at.root); }),
              testing::HasSubstr(":2: expected '...dig_run-5_session-02,0.25', as"));
  EXPECT_THAT(complaint([&] { open_sweep(at.root); }),
              testing::HasSubstr(" found '...dig_run-5_session-03,0.25';"));
}

}  // namespace
}  // namespace headpin::sweep
