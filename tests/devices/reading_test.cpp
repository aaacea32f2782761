// What the numbers of a recording mean, and what a user says instead.

#include "devices/recordings/reading.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

Quat turn(double w, double x, double y, double z) {
  return Quat(w, x, y, z).normalized();
}

void expect_same_turn(const Quat& a, const Quat& b) {
  EXPECT_LT((a.coeffs() - b.coeffs()).norm(), 1e-12)
      << a.coeffs().transpose() << " and " << b.coeffs().transpose();
}

TEST(Reading, AxesOfAnyLengthAreRefusedButThree) {
  for (const std::string& letters : {std::string("RS"), std::string("RSPR"),
                                     std::string(100'000, 'R'), std::string(100'000, 'A')}) {
    EXPECT_THAT(complaint([&] { Axes(letters, "x"); }),
                HasSubstr("x: axes '" + letters.substr(0, 20) + "': expected where"));
  }
}

TEST(Reading, AgainHasTheNumbersOfTheFileInTheOtherUnit) {
  const Reading cm{.unit_m = 0.01}, mm{.unit_m = 0.001};
  const Pose read{Quat::Identity(), Vec3(0.5, 1.5, -2.0)};  // 50, 150, -200 in the file
  EXPECT_LT((Again(cm, mm, "x")(read).p - Vec3(0.05, 0.15, -0.2)).norm(), 1e-12);
  EXPECT_LT((Again(mm, cm, "x")(read).p - Vec3(5, 15, -20)).norm(), 1e-12);
  const Reading s, ms{.time_unit_s = 1e-3};
  EXPECT_EQ(Again(s, ms, "x")(Time{2'500'000}), Time{2500});
  EXPECT_EQ(Again(ms, s, "x")(Time{2500}), Time{2'500'000});
  // Without another unit to the last microsecond, also of Unix times.
  EXPECT_EQ(Again(ms, ms, "x")(Time{1'700'000'000'123'457}), Time{1'700'000'000'123'457});
}

// The file has 1, 2, 3, 4; the order says which of them is w.
TEST(Reading, AgainHasTheFourNumbersOfAQuaternionInTheOtherOrder) {
  Reading wxyz, xyzw, zyxw;
  wxyz.quaternion = "wxyz";
  xyzw.quaternion = "xyzw";
  zyxw.quaternion = "zyxw";
  const auto again = [](const Reading& was, const Reading& is, const Quat& q) {
    return Again(was, is, "x")(Pose{q, Vec3::Zero()}).q;
  };
  const Quat as_wxyz = turn(1, 2, 3, 4), as_xyzw = turn(4, 1, 2, 3), as_zyxw = turn(4, 3, 2, 1);
  expect_same_turn(again(wxyz, xyzw, as_wxyz), as_xyzw);
  expect_same_turn(again(xyzw, wxyz, as_xyzw), as_wxyz);
  expect_same_turn(again(wxyz, zyxw, as_wxyz), as_zyxw);
  expect_same_turn(again(zyxw, xyzw, as_zyxw), as_xyzw);
  expect_same_turn(again(zyxw, zyxw, as_zyxw), as_zyxw);
  expect_same_turn(quaternion_of({1, 2, 3, 4}, "zyxw").normalized(), as_zyxw);
}

TEST(Reading, WhatAUserSaysStandsInPlaceOfWhatTheFileSays) {
  Reading file;
  file.unit_m = 0.01;
  file.quaternion = "wxyz";
  file.own_units = file.own_orders = true;
  file.without_unit = {true, false, true};
  file.other_units_m = {0.001};
  EXPECT_EQ(with({}, file, "x"), file);

  const Reading unit = with({.unit_m = 1.0}, file, "x");
  EXPECT_EQ(unit.unit_m, 1.0);
  EXPECT_FALSE(unit.own_units);
  EXPECT_THAT(unit.without_unit, testing::Each(false));
  EXPECT_THAT(unit.other_units_m, testing::IsEmpty());
  EXPECT_TRUE(unit.own_orders);

  const Reading order = with({.quaternion = "xyzw"}, file, "x");
  EXPECT_EQ(order.quaternion, "xyzw");
  EXPECT_FALSE(order.own_orders);
  EXPECT_TRUE(order.own_units);

  EXPECT_EQ(with({.axes = "RSA"}, file, "x").turning, "RSA");
  EXPECT_EQ(with({.axes = "RSA", .turning = "RSP"}, file, "x").turning, "RSP");
  EXPECT_EQ(with({.time_unit_s = 1e-3}, file, "x").time_unit_s, 1e-3);
  EXPECT_TRUE(with({.inverted = true}, file, "x").inverted);
  file.quaternion.clear();
  EXPECT_THAT(complaint([&] { with({.quaternion = "xyzw"}, file, "x"); }),
              HasSubstr("x: expected quaternions to read as xyzw; found other rotations, or none"));
}

}  // namespace
}  // namespace headpin::devices
