// XML of headers in other files: characters, their limits, how much there may be.

#include "devices/recordings/plain_xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

TEST(PlainXml, ANumberOfACharacterIsThatCharacterInUtf8) {
  const auto read = [](const std::string& number) {
    return parse_xml("<a>&#" + number + ";</a>").text;
  };
  EXPECT_EQ(read("1"), "\x01");
  EXPECT_EQ(read("127"), "\x7f");
  EXPECT_EQ(read("128"), "\xc2\x80");
  EXPECT_EQ(read("xe9"), "\xc3\xa9");
  EXPECT_EQ(read("x7ff"), "\xdf\xbf");
  EXPECT_EQ(read("x800"), "\xe0\xa0\x80");
  EXPECT_EQ(read("x20ac"), "\xe2\x82\xac");
  EXPECT_EQ(read("xd7ff"), "\xed\x9f\xbf");
  EXPECT_EQ(read("xe000"), "\xee\x80\x80");
  EXPECT_EQ(read("xffff"), "\xef\xbf\xbf");
  EXPECT_EQ(read("x10000"), "\xf0\x90\x80\x80");
  EXPECT_EQ(read("x1d11e"), "\xf0\x9d\x84\x9e");
  EXPECT_EQ(read("x10ffff"), "\xf4\x8f\xbf\xbf");
  // 0, halves of a pair, too large, and no numbers.
  for (const char* none : {"0", "xd800", "xdfff", "x110000", "99999999999", "65x", "x", ""}) {
    EXPECT_EQ(read(none), std::string("&#") + none + ";");
  }
}

// The limits of Unicode's table of well-formed bytes, and U+FFFE and U+FFFF, which XML forbids.
TEST(PlainXml, BytesThatAreNoCharacterOfXmlAreQuestionMarks) {
  for (const std::string one : {" ",
                                "\x7f",
                                "\xc2\x80",
                                "\xdf\xbf",
                                "\xe0\xa0\x80",
                                "\xe0\xbf\xbf",
                                "\xe1\x80\x80",
                                "\xe4\xb8\x80",
                                "\xec\xbf\xbf",
                                "\xed\x80\x80",
                                "\xed\x9f\xbf",
                                "\xee\x80\x80",
                                "\xee\xbf\xbf",
                                "\xef\xbe\xbf",
                                "\xef\xbf\xbd",
                                "\xf0\x90\x80\x80",
                                "\xf0\xbf\xbf\xbf",
                                "\xf1\x80\x80\x80",
                                "\xf3\xbf\xbf\xbf",
                                "\xf4\x80\x80\x80",
                                "\xf4\x8f\xbf\xbf"}) {
    EXPECT_EQ(xml_escaped("a" + one + "b"), "a" + one + "b");
  }
  for (const std::string none :
       {"\x1f", "\x80", "\xbf", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xed\xbf\xbf",
        "\xef\xbf\xbe", "\xef\xbf\xbf", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80",
        "\xc2", "\xe2\x82", "\xf0\x9d\x84"}) {
    EXPECT_EQ(xml_escaped("a" + none + "b"), "a" + std::string(none.size(), '?') + "b");
  }
}

TEST(PlainXml, TextsHaveNoBlanksAroundThem) {
  const XmlElement read = parse_xml("<!DOCTYPE a>\n<a> \t<b>\r\n two words\t</b><c> </c></a>\n");
  EXPECT_EQ(read.text_at({"b"}), "two words");
  EXPECT_EQ(read.text_at({"c"}), "");
  EXPECT_EQ(read.text_at({"d"}), "");
}

TEST(PlainXml, ElementsAreAtMost100DeepAnd200000) {
  const auto nested = [](int deep) {
    std::string begin, end;
    for (int i = 0; i < deep; ++i) begin += "<a>", end += "</a>";
    return begin + end;
  };
  EXPECT_NO_THROW(parse_xml(nested(100)));
  EXPECT_THAT(complaint([&] { parse_xml(nested(101)); }), HasSubstr("too many elements"));
  std::string many = "<a>";
  for (int i = 1; i < 200'000; ++i) many += "<b/>";
  EXPECT_EQ(parse_xml(many + "</a>").children.size(), 199'999u);
  EXPECT_THAT(complaint([&] { parse_xml(many + "<b/></a>"); }), HasSubstr("too many elements"));
}

}  // namespace
}  // namespace headpin::devices
