#include <cstdlib>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/lcm/url.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

constexpr const char* kNoUrl =
    "expected an LCM URL such as udpm://239.255.76.67:7667?ttl=0 or file://LOG?mode=w";
constexpr const char* kNoGroup =
    "expected udpm://ADDRESS:PORT with an address from 224.0.0.0 to 239.255.255.255 and a port "
    "from "
    "1 to 65535";
constexpr const char* kNoServer = "expected tcpq://HOST:PORT with a port from 1 to 65535";

class LcmUrlTest : public testing::Test {
 protected:
  LcmUrlTest() { unsetenv("LCM_DEFAULT_URL"); }
  ~LcmUrlTest() override { unsetenv("LCM_DEFAULT_URL"); }

  static void expect_refused(const std::string& url, const std::string& why,
                             LcmUse use = LcmUse::any) {
    EXPECT_THROW(LcmUrl(url, "--lcm ", use), std::invalid_argument) << url;
    EXPECT_EQ(complaint([&] { LcmUrl(url, "--lcm ", use); }), "--lcm " + url + ": " + why);
  }
};

// As LCM's documentation says; liblcm 1.3.1 itself sends to port 0 where none is given.
TEST_F(LcmUrlTest, AddressAndPortOfMulticastMayBeLeftOut) {
  const auto expect_group = [](const std::string& url, const std::string& complete) {
    EXPECT_EQ(LcmUrl(url).for_liblcm(), complete) << url;
    EXPECT_TRUE(LcmUrl(url).group()) << url;
    EXPECT_THAT(std::string(LcmUrl(url).hint()), HasSubstr("multicast needs a route")) << url;
  };
  expect_group("", "udpm://239.255.76.67:7667?ttl=0");
  expect_group("udpm://", "udpm://239.255.76.67:7667?ttl=0");
  expect_group("udpm://?ttl=2", "udpm://239.255.76.67:7667?ttl=2");
  expect_group("udpm://:80", "udpm://239.255.76.67:80?ttl=0");
  expect_group("udpm://239.1.2.3?ttl=1", "udpm://239.1.2.3:7667?ttl=1");
  expect_group("udpm://224.0.0.0:65535?ttl=255&recv_buf_size=9&transmit_only=true",
               "udpm://224.0.0.0:65535?ttl=255&recv_buf_size=9");
  const MulticastGroup group = *LcmUrl("udpm://239.255.255.255:1").group();
  EXPECT_EQ(group.address, 239u << 24 | 255u << 16 | 255u << 8 | 255u);
  EXPECT_EQ(group.port, 1);
}

TEST_F(LcmUrlTest, WhatIsNoUrlOfLcmIsRefused) {
  for (const char* url : {"foo", "http://foo", "://", "?ttl=0", "udpm:239.255.76.67:7667",
                          "UDPM://", " udpm://", "udpm", "/a?b://c"}) {
    expect_refused(url, kNoUrl);
  }
  expect_refused("mpudpm://239.255.76.67:7667",
                 "two datagrams of anybody end a program in which liblcm 1.3.1 reads mpudpm; "
                 "expected udpm://");
}

TEST_F(LcmUrlTest, APlaceThatIsNoneIsRefused) {
  for (const char* place : {"999.1.1.1:7667", "1.2.3.4:7667", "223.255.255.255:7667", "240.0.0.0",
                            "nobody:80", "239.1:80", "239.1.2.3:0", "239.1.2.3:", "239.1.2.3:x",
                            "239.1.2.3:80x", "239.1.2.3:-1", "239.1.2.3:99999"}) {
    expect_refused(std::string("udpm://") + place, kNoGroup);
  }
  for (const char* port : {"0", "", "x", "65536", "-1"}) {
    expect_refused(std::string("tcpq://localhost:") + port, kNoServer);
  }
}

// liblcm goes on with its default for them, and with another one for a ttl of 999.
TEST_F(LcmUrlTest, AParameterThatMeansNothingIsRefused) {
  expect_refused("udpm://?tll=0", "unknown parameter 'tll'; expected ttl or recv_buf_size");
  expect_refused("udpm://?ttl=0&x", "unknown parameter 'x'; expected ttl or recv_buf_size");
  expect_refused("udpm://?ttl=abc", "ttl: expected a whole number from 0 to 255, found abc");
  expect_refused("udpm://?ttl=999", "ttl: expected a whole number from 0 to 255, found 999");
  expect_refused("udpm://?ttl=-1", "ttl: expected a whole number from 0 to 255, found -1");
  expect_refused("udpm://?ttl", "ttl: expected a whole number from 0 to 255, found nothing");
  expect_refused("udpm://?recv_buf_size=1e6",
                 "recv_buf_size: expected a whole number from 0 to 2147483647, found 1e6");
  expect_refused("file://a?sped=0",
                 "unknown parameter 'sped'; expected mode, speed or start_timestamp");
  expect_refused("file://a?mode=x", "mode: expected r or w, found x");
  expect_refused("file://a?mode=a", "cannot append to a log; expected mode=w");
  for (const char* speed : {"-1", "nan", "inf", "2x"}) {
    expect_refused(
        std::string("file://a?speed=") + speed,
        std::string("speed: expected a number, 0 (as fast as possible) or more, found ") + speed);
  }
  expect_refused("file://a?start_timestamp=",
                 "start_timestamp: expected a whole number of microseconds, found nothing");
}

TEST_F(LcmUrlTest, ALogIsReadOrWritten) {
  const UrlOfLog plain = *LcmUrl("file://a,b.lcmlog").log();
  EXPECT_EQ(plain.path, "a,b.lcmlog");
  EXPECT_FALSE(plain.written);
  EXPECT_EQ(plain.speed, 1.0);
  const UrlOfLog log = *LcmUrl("file:///a?mode=r&speed=0.5&start_timestamp=-7").log();
  EXPECT_EQ(log.path, "/a");
  EXPECT_EQ(log.speed, 0.5);
  EXPECT_EQ(log.begin, Time{-7});
  EXPECT_TRUE(LcmUrl("file://a?speed=2,mode=w").log()->written);
  EXPECT_EQ(LcmUrl("file://a").hint(), "");

  expect_refused("file://", "expected the name of a log after file://, found nothing");
  expect_refused("file://?mode=w", "expected the name of a log after file://, found nothing");
  expect_refused("file://out.lcmlog",
                 "this would be read; to write a log, expected file://out.lcmlog?mode=w",
                 LcmUse::publishing);
  expect_refused("file://a?mode=w", "this would be written; to read a log, expected file://a",
                 LcmUse::reading);
  EXPECT_NO_THROW(LcmUrl("file://a?mode=w", "", LcmUse::publishing));
  EXPECT_NO_THROW(LcmUrl("file://a", "", LcmUse::reading));
}

TEST_F(LcmUrlTest, AServerHasAHostAndAPort) {
  EXPECT_EQ(LcmUrl("tcpq://").server()->host, "127.0.0.1");
  EXPECT_EQ(LcmUrl("tcpq://").server()->port, 7700);
  EXPECT_EQ(LcmUrl("tcpq://here").server()->host, "here");
  EXPECT_EQ(LcmUrl("tcpq://here:65535").server()->port, 65535);
  EXPECT_EQ(LcmUrl("tcpq://here:1").server()->port, 1);
  EXPECT_EQ(LcmUrl("memq://").for_liblcm(), "memq://");
  EXPECT_FALSE(LcmUrl("memq://").server() || LcmUrl("memq://").group() || LcmUrl("memq://").log());
}

TEST_F(LcmUrlTest, TheVariableStandsForAnEmptyUrlAndIsNamed) {
  setenv("LCM_DEFAULT_URL", "", 1);
  EXPECT_EQ(LcmUrl("").shown(), "its default URL");
  setenv("LCM_DEFAULT_URL", "tcpq://here:80", 1);
  EXPECT_EQ(LcmUrl("").server()->host, "here");
  EXPECT_EQ(LcmUrl("").shown(), "tcpq://here:80");
  EXPECT_FALSE(LcmUrl("memq://").server());
  setenv("LCM_DEFAULT_URL", "foo", 1);
  EXPECT_EQ(complaint([] { LcmUrl("", "--lcm "); }),
            std::string("LCM_DEFAULT_URL in the environment: ") + kNoUrl + ", found 'foo'");
  EXPECT_EQ(LcmUrl("memq://", "lcm:").name(), "lcm:memq://");
}

}  // namespace
}  // namespace headpin::devices
