// Logs byte by byte: whole, cut and damaged.

#include "devices/log/event_log.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using LogBytes = std::vector<std::uint8_t>;
using testing::ElementsAre;

LogBytes event_of(const std::string& channel, const LogBytes& data, std::int64_t us = 7) {
  LogBytes bytes;
  append({.number = 1, .time = Time{us}, .channel = channel, .data = data}, bytes);
  return bytes;
}

LogBytes joined(const std::vector<LogBytes>& parts) {
  LogBytes all;
  for (const LogBytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// A header whose lengths are whatever the test says.
LogBytes header_of(std::uint32_t channel, std::uint32_t data) {
  LogBytes bytes = event_of("", {});
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[20 + i] = static_cast<std::uint8_t>(channel >> (24 - 8 * i));
    bytes[24 + i] = static_cast<std::uint8_t>(data >> (24 - 8 * i));
  }
  return bytes;
}

/// What a reader makes of a log.
struct FoundInLog {
  std::vector<std::string> channels = {};
  std::int64_t skipped = 0, cut = 0;
  bool operator==(const FoundInLog&) const = default;
};

void PrintTo(const FoundInLog& found, std::ostream* out) {
  for (const std::string& channel : found.channels) *out << channel.substr(0, 9) << ' ';
  *out << found.skipped << " skipped, " << found.cut << " cut";
}

FoundInLog found_by(LogReader reader) {
  FoundInLog found;
  while (const auto event = reader.next()) found.channels.emplace_back(event->channel);
  found.skipped = reader.skipped_bytes();
  found.cut = reader.cut_bytes();
  return found;
}

FoundInLog found_in(const LogBytes& bytes) {
  return found_by(LogReader(std::span<const std::uint8_t>(bytes)));
}

const LogBytes kMagicWord = {0xED, 0xA1, 0xDA, 0x01};

TEST(EventLog, IsReadAsItsBytesStandInTheFormatOfLcm) {
  const LogBytes bytes = {0xED, 0xA1, 0xDA, 0x01,                       //
                          0,    0,    0,    0,    0, 0,    0x01, 0x02,  // number 258
                          0,    0,    0,    0,    0, 0x0f, 0x42, 0x40,  // 1'000'000 us
                          0,    0,    0,    2,    0, 0,    0,    3,     //
                          'a',  'b',  9,    8,    7};
  LogReader reader{std::span<const std::uint8_t>(bytes)};
  const auto event = reader.next();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->number, 258);
  EXPECT_EQ(event->time, Time{1'000'000});
  EXPECT_EQ(event->channel, "ab");
  EXPECT_THAT(event->data, ElementsAre(9, 8, 7));
  LogBytes again;
  append(*event, again);
  EXPECT_EQ(again, bytes);
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.skipped_bytes() + reader.cut_bytes(), 0);
}

TEST(EventLog, CutAnywhereIsReadUpToItsLastWholeEvent) {
  const std::vector<LogBytes> events = {event_of("a", LogBytes(5)), event_of("bb", {}),
                                        event_of(std::string(999, 'c'), LogBytes(40)),
                                        event_of("d", LogBytes(3))};
  const std::vector<std::string> names = {"a", "bb", std::string(999, 'c'), "d"};
  const LogBytes whole = joined(events);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    FoundInLog expected;
    std::size_t end = 0;
    for (std::size_t i = 0; i < events.size() && end + events[i].size() <= size; ++i) {
      end += events[i].size();
      expected.channels.push_back(names[i]);
    }
    expected.cut = static_cast<std::int64_t>(size - end);
    // What stands behind the end of the bytes is not of the log.
    EXPECT_EQ(found_by(LogReader(std::span(whole).first(size))), expected) << size;
  }
}

TEST(EventLog, BytesBetweenItsEventsAreSkippedAndCounted) {
  for (const std::size_t size : {1u, 3u, 4u, 5u, 28u, 100u}) {
    const LogBytes junk(size, 0xED);
    const auto count = static_cast<std::int64_t>(size);
    const LogBytes a = event_of("a", LogBytes(5)), b = event_of("b", LogBytes(6));
    EXPECT_EQ(found_in(joined({junk, a, b})), (FoundInLog{{"a", "b"}, count, 0})) << size;
    EXPECT_EQ(found_in(joined({a, junk, b})), (FoundInLog{{"a", "b"}, count, 0})) << size;
    EXPECT_EQ(found_in(joined({a, junk, b, junk, a})), (FoundInLog{{"a", "b", "a"}, 2 * count, 0}));
    // Fewer than four may be the begin of an event.
    EXPECT_EQ(found_in(joined({a, b, junk})),
              size < 4 ? (FoundInLog{{"a", "b"}, 0, count}) : (FoundInLog{{"a", "b"}, count, 0}))
        << size;
  }
  EXPECT_EQ(found_in(joined({event_of("a", {}), kMagicWord})), (FoundInLog{{"a"}, 0, 4}));
  EXPECT_EQ(found_in(kMagicWord), (FoundInLog{{}, 0, 4}));
}

TEST(EventLog, AHeaderWithImpossibleLengthsIsSkipped) {
  const LogBytes before = event_of("a", {}), after = event_of("b", {});
  for (const auto& [channel, data] : {std::pair{0u, 0u},
                                      {0u, 4u},
                                      {1000u, 0u},
                                      {0xffffffffu, 0u},
                                      {1u, 0x80000000u},
                                      {1u, 0xffffffffu}}) {
    const LogBytes filled =
        joined({header_of(channel, data), LogBytes(channel < 2000 ? channel : 0),
                LogBytes(data < 2000 ? data : 0)});
    const auto size = static_cast<std::int64_t>(filled.size());
    EXPECT_EQ(found_in(joined({before, filled, after})), (FoundInLog{{"a", "b"}, size, 0}))
        << channel << ", " << data;
    // As the last one it is no event that is cut.
    EXPECT_EQ(found_in(joined({before, filled})), (FoundInLog{{"a"}, size, 0}))
        << channel << ", " << data;
  }
  // The longest that can be.
  for (const auto& [channel, data] : {std::pair{1u, 0x7fffffffu}, {999u, 0u}, {1u, 0u}}) {
    EXPECT_EQ(found_in(joined({before, header_of(channel, data)})), (FoundInLog{{"a"}, 0, 28}))
        << channel << ", " << data;
  }
}

// An event that claims more than there is hides those behind it until the next magic word.
TEST(EventLog, AnEventThatDoesNotFitIsSkippedUpToTheNextOne) {
  const LogBytes a = event_of("a", {}), b = event_of("b", {});
  const LogBytes long_one = joined({header_of(1, 1'000'000), {'x'}, LogBytes(9)});
  EXPECT_EQ(found_in(joined({a, long_one, b, a})), (FoundInLog{{"a", "b", "a"}, 38, 0}));
  const LogBytes begun(b.begin(), b.begin() + 20);  // a header that stops in the middle
  EXPECT_EQ(found_in(joined({a, begun, b, a})), (FoundInLog{{"a", "b", "a"}, 20, 0}));
  EXPECT_EQ(found_in(joined({a, begun, a})), (FoundInLog{{"a", "a"}, 20, 0}));
  // An event that ends inside the next one.
  LogBytes too_long = event_of("x", LogBytes(9));
  too_long[27] = 12;
  EXPECT_EQ(found_in(joined({a, too_long, b, a})), (FoundInLog{{"a", "b", "a"}, 38, 0}));
}

TEST(EventLog, DataMayHoldAMagicWordWhereTheEventEndsWell) {
  const LogBytes inner = event_of("inner", {}), outer = event_of("outer", inner);
  const LogBytes a = event_of("a", {}), word = event_of("word", kMagicWord);
  EXPECT_EQ(found_in(joined({outer, a})), (FoundInLog{{"outer", "a"}, 0, 0}));
  EXPECT_EQ(found_in(outer), (FoundInLog{{"outer"}, 0, 0}));
  EXPECT_EQ(found_in(joined({a, word})), (FoundInLog{{"a", "word"}, 0, 0}));
  // Behind it stands what is none: it may be damaged, and what is in it an event.
  EXPECT_EQ(found_in(joined({outer, LogBytes(8), a})), (FoundInLog{{"inner", "a"}, 28 + 5 + 8, 0}));
  EXPECT_EQ(found_in(joined({a, outer, LogBytes(8)})), (FoundInLog{{"a", "inner"}, 28 + 5 + 8, 0}));
}

// It is searched in pieces of 64 KiB.
TEST(EventLog, AnEventBehindMuchDamageIsFoundWhereverItBegins) {
  const LogBytes a = event_of("a", {}), b = event_of("b", {});
  for (const std::int64_t border : {65'536, 65'533, 131'072, 131'066}) {
    for (std::int64_t size = border - 6; size <= border + 6; ++size) {
      const LogBytes junk(static_cast<std::size_t>(size), 0xA1);
      EXPECT_EQ(found_in(joined({junk, a, b})), (FoundInLog{{"a", "b"}, size, 0}));
    }
  }
}

TEST(EventLog, AnImpossibleStampBecomesTheNearestPossibleOne) {
  constexpr std::int64_t kFar = 4'000'000'000'000'000;
  for (const auto& [us, read] : {std::pair{kFar, kFar},
                                 {kFar + 1, kFar},
                                 {std::numeric_limits<std::int64_t>::max(), kFar},
                                 {-kFar - 1, -kFar},
                                 {std::int64_t{-5}, std::int64_t{-5}}}) {
    const LogBytes bytes = event_of("a", {}, us);
    EXPECT_EQ(LogReader(std::span<const std::uint8_t>(bytes)).next()->time, Time{read});
  }
}

class EventLogFile : public testing::Test {
 protected:
  std::string write(const LogBytes& bytes) const {
    spit(folder / "a.log", {bytes.begin(), bytes.end()});
    return folder / "a.log";
  }
  const std::filesystem::path folder = fresh_folder("event-log");
};

TEST_F(EventLogFile, IsReadInPiecesAsItsBytesAreAtOnce) {
  std::mt19937 random(3);
  LogBytes bytes(2'500'000);
  std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
  FileWindow file(write(bytes));
  const std::size_t size = bytes.size();
  ASSERT_EQ(file.size(), size);
  std::vector<std::pair<std::size_t, std::size_t>> pieces = {
      {0, 10},         {1'048'570, 6},   {1'048'570, 7},    {5, 10},   {size - 1, 1},
      {size, 5},       {size + 1000, 5}, {0, size},         {1, size}, {2'000'000, 600'000},
      {1'999'990, 20}, {2'499'000, 999}, {2'499'000, 1001}, {0, 0},    {10, 1'500'000}};
  for (int i = 0; i < 200; ++i) pieces.emplace_back(random() % size, random() % 2000);
  for (const auto& [at, most] : pieces) {
    const std::size_t from = std::min(at, size), count = std::min(most, size - from);
    EXPECT_TRUE(std::ranges::equal(file.read(at, most), std::span(bytes).subspan(from, count)))
        << at << ", " << most;
  }
}

TEST_F(EventLogFile, HasTheEventsOfItsBytes) {
  std::vector<LogBytes> parts;
  for (std::size_t i = 0; i < 60; ++i) {
    parts.push_back(event_of("e" + std::to_string(i), LogBytes(i * 997)));
    if (i % 7 == 0) parts.push_back(LogBytes(i, 0xDA));
  }
  parts.push_back(LogBytes(parts[0].begin(), parts[0].begin() + 25));
  const LogBytes bytes = joined(parts);
  ASSERT_GT(bytes.size(), 1'100'000u);
  FileWindow file(write(bytes));
  const FoundInLog found = found_by(LogReader(file));
  EXPECT_EQ(found, found_in(bytes));
  EXPECT_EQ(found.channels.size(), 60u);
}

TEST_F(EventLogFile, ThatIsCutWhileItIsReadEndsThere) {
  const LogBytes a = event_of("a", {}), bytes = joined({a, event_of("b", LogBytes(2'000'000)), a});
  for (const std::size_t left : {std::size_t{0}, std::size_t{2}, a.size() + 2, a.size() + 10,
                                 a.size() + 28, a.size() + 29, a.size() + 1'500'000}) {
    FileWindow file(write(bytes));
    std::filesystem::resize_file(folder / "a.log", left);
    EXPECT_EQ(file.read(left / 2, 3'000'000).size(), left - left / 2);
    EXPECT_EQ(file.read(left, 100).size(), 0u);
    LogReader reader(file);
    std::vector<std::string> channels;
    while (const auto event = reader.next()) channels.emplace_back(event->channel);
    if (left < a.size()) {
      EXPECT_THAT(channels, ElementsAre()) << left;
    } else {
      EXPECT_THAT(channels, ElementsAre("a")) << left;
    }
  }
}

}  // namespace
}  // namespace headpin::devices
