// Logs of VRPN as bytes: messages at their limits.

#include "devices/recordings/vrpn_log.h"

#include <bit>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The bytes of a log, the most significant of a number first.
class VrpnBytes {
 public:
  VrpnBytes() : bytes(24) {}

  void add(std::uint64_t number, int size) {
    for (int i = size - 1; i >= 0; --i) {
      bytes.push_back(static_cast<std::uint8_t>(number >> (8 * i)));
    }
  }
  void add_head(int type, int sender, int us, int size) {
    for (const int field : {type, sender, 1'700'000'000, us, size, 0}) {
      add(static_cast<std::uint32_t>(field), 4);
    }
  }
  /// @param said  the length of the name, as it is written
  void add_name(int type, int number, const std::string& name, std::size_t said) {
    add_head(type, number, 0, static_cast<int>(4 + name.size()));
    add(said, 4);
    bytes.insert(bytes.end(), name.begin(), name.end());
  }
  void add_report(int us) {
    add_head(3, 7, us, 64);
    add(0, 8);
    for (const double v : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) {
      add(std::bit_cast<std::uint64_t>(v), 8);
    }
  }

  std::vector<std::uint8_t> bytes;
};

VrpnBytes log_of_tracker(const std::string& name = "Tracker0", std::size_t said = 8) {
  VrpnBytes log;
  log.add_name(-1, 7, name, said);
  log.add_name(-2, 3, "vrpn_Tracker Pos_Quat", 21);
  return log;
}

TEST(VrpnLog, ALogIsReadUpToItsLastWholeMessage) {
  VrpnBytes log = log_of_tracker();
  const std::size_t before = log.bytes.size();
  for (int i = 0; i < 3; ++i) log.add_report(10'000 * i);
  const std::size_t report = 24 + 64;
  for (std::size_t whole = 1; whole <= 3; ++whole) {
    for (const std::size_t more : {0u, 1u, 23u, 24u, 25u, 87u}) {
      if (whole == 3 && more > 0) continue;
      std::vector<std::string> notes;
      const auto tracks =
          parse_vrpn(std::span(log.bytes).first(before + whole * report + more), "x", 1.0, notes);
      ASSERT_EQ(tracks.size(), 1u);
      EXPECT_EQ(tracks[0].second.samples().size(), whole) << more;
      if (more == 0) {
        EXPECT_THAT(notes, ElementsAre());
      } else {
        EXPECT_THAT(notes, ElementsAre(fmt::format("the log ends within a message: {} bytes at its "
                                                   "end are left out",
                                                   more)));
      }
    }
  }
}

TEST(VrpnLog, AMessageMayHaveNoData) {
  VrpnBytes log = log_of_tracker();
  log.add_head(4, 7, 0, 0);
  log.add_report(5000);
  log.add_head(4, 7, 0, 0);
  std::vector<std::string> notes;
  const auto tracks = parse_vrpn(log.bytes, "x", 1.0, notes);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].second.samples().size(), 1u);
  EXPECT_THAT(notes, ElementsAre());

  const std::size_t at = log.bytes.size();
  log.add_head(4, 7, 0, -1);
  EXPECT_EQ(complaint([&] { parse_vrpn(log.bytes, "x", 1.0, notes); }),
            fmt::format("x: byte {}: expected the length of a message, found -1", at));
}

// A NUL behind the name is usual, but not needed.
TEST(VrpnLog, ANameEndsWithItsMessageWhateverLengthItSays) {
  for (const std::size_t said : {8u, 9u, 12u, 4'000'000'000u}) {
    VrpnBytes log = log_of_tracker("Tracker0", said);
    log.add_report(0);
    std::vector<std::string> notes;
    EXPECT_EQ(parse_vrpn(log.bytes, "x", 1.0, notes).at(0).first, "Tracker0:0") << said;
  }
}

}  // namespace
}  // namespace headpin::devices
