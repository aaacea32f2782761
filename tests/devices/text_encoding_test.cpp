// Texts in UTF-8 and UTF-16, whole and damaged.

#include "devices/recordings/text_encoding.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

/// Characters below U+0080 in UTF-16, with its mark.
std::string in_utf16(const std::string& ascii, bool little) {
  std::string wide = little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : ascii) {
    wide += little ? c : '\0';
    wide += little ? '\0' : c;
  }
  return wide;
}

TEST(TextEncoding, OfUtf16IsConvertedWhateverItsLength) {
  // A piece of the conversion is 65536 bytes.
  for (const std::size_t length : {0u, 1u, 65535u, 65536u, 65537u, 200'000u}) {
    std::string plain;
    while (plain.size() < length) plain += static_cast<char>('a' + plain.size() % 23);
    for (const bool little : {true, false}) {
      const Utf8Text read = as_utf8(in_utf16(plain, little));
      EXPECT_TRUE(read.whole) << length;
      EXPECT_TRUE(read.text == plain) << length;
    }
  }
}

TEST(TextEncoding, KeepsCharactersOfSeveralBytes) {
  using namespace std::string_literals;
  const std::string metres = "\xc3\xa9\xf0\x9f\x8e\xb3";  // e with an accent, a bowling ball
  EXPECT_EQ(as_utf8("\xff\xfe\xe9\x00\x3c\xd8\xb3\xdf"s).text, metres);
  EXPECT_EQ(as_utf8("\xfe\xff\x00\xe9\xd8\x3c\xdf\xb3"s).text, metres);
  EXPECT_EQ(as_utf8("\xef\xbb\xbf" + metres).text, metres);
  EXPECT_EQ(as_utf8(metres).text, metres);
  EXPECT_TRUE(as_utf8(metres).whole);
}

TEST(TextEncoding, OfDamagedUtf16IsConvertedUpToTheDamage) {
  for (const bool little : {true, false}) {
    const std::string good = in_utf16("time,x\n0,1\n2,3", little);
    const std::string half = little ? std::string("\x00\xdc", 2) : std::string("\xdc\x00", 2);
    for (const std::string& damage : {std::string("4"), half + good.substr(2)}) {
      const Utf8Text read = as_utf8(good + damage);
      EXPECT_FALSE(read.whole);
      EXPECT_EQ(read.text, "time,x\n0,1\n2,3");
      const TemporaryFolder folder;
      spit(folder / "t.csv", good + damage);
      EXPECT_EQ(
          complaint([&] { read_as_utf8(folder / "t.csv", 1000); }),
          (folder / "t.csv").string() + ":3: expected whole characters of UTF-16, found others");
      spit(folder / "t.csv", good);
      EXPECT_EQ(read_as_utf8(folder / "t.csv", 1000), read.text);
    }
  }
}

TEST(TextEncoding, ABeginningEndsWithAWholeLetter) {
  const std::string text = "aä€😀";  // of 1, 2, 3 and 4 bytes
  const auto bytes = [&](std::size_t most) { return beginning(text, most).size(); };
  const std::array<std::size_t, 12> whole = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};
  for (std::size_t most = 0; most < whole.size(); ++most) EXPECT_EQ(bytes(most), whole[most]);
  EXPECT_EQ(beginning(std::string(50, '\x80'), 20).size(), 16u);  // no UTF-8
}

}  // namespace
}  // namespace headpin::devices
