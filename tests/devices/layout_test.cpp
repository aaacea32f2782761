// Layouts of messages against messages that lcm-gen's code encodes.

#include "devices/log/layout.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <headpin/event_t.hpp>
#include <headpin/snapshot_t.hpp>
#include <headpin/state_t.hpp>
#include <headpin/viewer_draw_t.hpp>
#include <headpin/viewer_load_robot_t.hpp>

#include "devices/base/version.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The message as it is sent, without its fingerprint.
template <typename Lcm>
Bytes bytes_of(const Lcm& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return {bytes.begin() + 8, bytes.end()};
}

template <typename Lcm>
void expect_found(const Lcm& message) {
  const Layouts layouts(schema_text());
  Bytes bytes = bytes_of(message);
  const auto size = static_cast<std::ptrdiff_t>(bytes.size());
  EXPECT_EQ(layouts.end_of(Lcm::getTypeName(), bytes, 0), size) << Lcm::getTypeName();
  bytes.push_back(0);  // what is behind it is not part of it
  EXPECT_EQ(layouts.end_of(Lcm::getTypeName(), bytes, 0), size);
  for (std::size_t less = 0; less < bytes.size() - 1; ++less) {
    EXPECT_EQ(layouts.end_of(Lcm::getTypeName(), std::span(bytes).first(less), 0), -1) << less;
  }
}

TEST(Layouts, FindTheEndOfNumbersTextsAndArrays) {
  expect_found(headpin::event_t{1, 2, "grab", 2, {"ball", ""}, {1, 2, 3}, {}, 0.5, "{}"});
  headpin::snapshot_t snapshot{};
  snapshot.num_bytes = 300;
  snapshot.saved.assign(300, 7);
  expect_found(snapshot);
}

TEST(Layouts, FindTheEndOfStructuresAndOfArraysInTwoDimensions) {
  headpin::state_t state{};
  state.num_bodies = 3;
  state.bodies.resize(3);
  expect_found(state);
  headpin::viewer_draw_t draw{};
  draw.num_links = 2;
  draw.link_name = {"a", "bc"};
  draw.robot_num = {0, 1};
  draw.position = {{1, 2, 3}, {4, 5, 6}};
  draw.quaternion = {{1, 0, 0, 0}, {1, 0, 0, 0}};
  expect_found(draw);
  headpin::viewer_load_robot_t load{};
  load.num_links = 1;
  load.link.resize(1);
  load.link[0].num_geom = 2;
  load.link[0].geom.resize(2);
  load.link[0].geom[1].num_float_data = 5;
  load.link[0].geom[1].float_data.resize(5);
  expect_found(load);
}

TEST(Layouts, RefuseCountsThatCannotBe) {
  const Layouts layouts("struct t { int32_t n; double x[n][3]; string s; }");
  const Bytes none = {0, 0, 0, 0, 0, 0, 0, 1, 0};
  EXPECT_EQ(layouts.end_of("t", none, 0), 9);
  for (const int first : {0x7f, 0x80, 0xff}) {  // huge, negative, minus one and something
    Bytes bytes(100);
    bytes[0] = static_cast<std::uint8_t>(first);
    EXPECT_EQ(layouts.end_of("t", bytes, 0), -1) << first;
  }
  Bytes text = none;
  text[8] = 'x';  // its last byte is no NUL
  EXPECT_EQ(layouts.end_of("t", text, 0), -1);
  text[7] = 0;  // a text has a NUL at least
  EXPECT_EQ(layouts.end_of("t", text, 0), -1);
}

TEST(Layouts, AreOfTheFieldsAlone) {
  const Layouts layouts(
      "package p;\n// struct no { int8_t x; }\nstruct a\n{\n  const int8_t X = 1, Y = 2;\n"
      "  int8_t one;  // double two;\n  boolean two;\n}\nstruct b { a twice[2]; }");
  EXPECT_EQ(layouts.end_of("b", Bytes(9), 0), 4);
  EXPECT_EQ(layouts.end_of("b", Bytes(9), 5), 9);
  EXPECT_THROW(layouts.end_of("no", Bytes(9), 0), std::out_of_range);
}

TEST(Layouts, NameAnUnknownType) {
  EXPECT_EQ(complaint([] { Layouts("struct t { int32_t n; what x[n]; }"); }),
            "t.x: unknown type what");
}

// A dimension that is 0 leaves nothing, whatever the next one says.
TEST(Layouts, MultiplyTheirDimensionsWithoutOverflow) {
  const Layouts layouts("struct t { int32_t n; int32_t m; int32_t k; byte x[n][m][k]; }");
  const auto end_of = [&](std::uint32_t n, std::uint32_t m, std::uint32_t k) {
    Bytes bytes(70'000);
    std::size_t at = 0;
    for (const std::uint32_t number : {n, m, k}) {
      for (int shift = 24; shift >= 0; shift -= 8)
        bytes[at++] = static_cast<std::uint8_t>(number >> shift);
    }
    return layouts.end_of("t", bytes, 0);
  };
  EXPECT_EQ(end_of(2, 3, 4), 12 + 24);
  EXPECT_EQ(end_of(0, 3, 4), 12);
  EXPECT_EQ(end_of(2, 0, 0x7fffffff), 12);
  EXPECT_EQ(end_of(0, 0, 0), 12);
  EXPECT_EQ(end_of(1 << 16, 1 << 24, 1 << 24), -1);  // 2 to the 64 altogether
  EXPECT_EQ(end_of(2, 3, 0xffffffff), -1);
}

TEST(Layouts, CountInSignedNumbersOfAnySize) {
  for (const auto& [type, size] :
       {std::pair{"int8_t", 1}, {"int16_t", 2}, {"int32_t", 4}, {"int64_t", 8}}) {
    const Layouts layouts(std::string("struct t { ") + type + " n; byte x[n]; }");
    Bytes bytes(70'000);
    bytes[static_cast<std::size_t>(size - 1)] = 5;
    EXPECT_EQ(layouts.end_of("t", bytes, 0), size + 5) << type;
    std::fill_n(bytes.begin(), size, std::uint8_t{0xff});  // -1
    EXPECT_EQ(layouts.end_of("t", bytes, 0), -1) << type;
  }
}

TEST(Layouts, MayHaveNoFields) {
  const Layouts layouts("struct none { } struct t { none x; int8_t n; none y[n]; }");
  EXPECT_EQ(layouts.end_of("none", {}, 0), 0);
  EXPECT_EQ(layouts.end_of("t", Bytes{0}, 0), 1);
}

}  // namespace
}  // namespace headpin::devices
