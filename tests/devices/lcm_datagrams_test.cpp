// LCM's datagrams, written here by the protocol's description, byte by byte.

#include <random>

#include <gtest/gtest.h>

#include "devices/lcm/datagrams.h"

namespace headpin::devices {
namespace {

using Datagram = std::vector<std::uint8_t>;

void put(Datagram& bytes, std::uint32_t number, int count) {
  while (count-- > 0) bytes.push_back(static_cast<std::uint8_t>(number >> (8 * count)));
}

void put(Datagram& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

Datagram whole(const std::string& channel, const std::string& data) {
  Datagram bytes;
  put(bytes, "LC02");
  put(bytes, 7, 4);  // its number
  put(bytes, channel + '\0' + data);
  return bytes;
}

/// @param data  the channel stands before that of the first
Datagram fragment(std::uint32_t size, std::uint32_t offset, std::uint32_t number,
                  std::uint32_t count, const std::string& data) {
  Datagram bytes;
  put(bytes, "LC03");
  put(bytes, 7, 4);
  put(bytes, size, 4);
  put(bytes, offset, 4);
  put(bytes, number, 2);
  put(bytes, count, 2);
  put(bytes, data);
  return bytes;
}

std::string text(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(LcmDatagrams, AMessageHasItsChannelAndItsData) {
  const Datagram bytes = whole("TRACKER", std::string("a\0b", 3)), empty = whole("X", "");
  const auto read = read_lcm_datagram(bytes);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->whole);
  EXPECT_EQ(read->channel, "TRACKER");
  EXPECT_EQ(text(read->data), std::string("a\0b", 3));
  EXPECT_EQ(text(read_lcm_datagram(empty)->data), "");
}

// liblcm 1.3.1 adds offset and length of a fragment in 32 bits and copies it where that points.
TEST(LcmDatagrams, AFragmentIsNoMessageWhereverItClaimsToStand) {
  const std::string first = "TRACKER" + std::string(1, '\0') + std::string(1000, 'x');
  const Datagram one = fragment(3000, 0, 0, 2, first),
                 other = fragment(3000, 0xFFFFFF00u, 1, 2, std::string(1000, 'y'));
  const auto begin = read_lcm_datagram(one), rest = read_lcm_datagram(other);
  ASSERT_TRUE(begin);
  EXPECT_FALSE(begin->whole);
  EXPECT_EQ(begin->channel, "TRACKER");
  EXPECT_TRUE(begin->data.empty());
  ASSERT_TRUE(rest);
  EXPECT_TRUE(rest->channel.empty());
  EXPECT_TRUE(rest->data.empty());
}

TEST(LcmDatagrams, WhatLcmDoesNotSendIsNothing) {
  EXPECT_FALSE(read_lcm_datagram({}));
  Datagram other = whole("TRACKER", "data");
  other[0] = 'X';
  EXPECT_FALSE(read_lcm_datagram(other));
  EXPECT_FALSE(read_lcm_datagram(whole("", "no channel")));
  EXPECT_TRUE(read_lcm_datagram(whole(std::string(63, 'c'), "")));
  EXPECT_FALSE(read_lcm_datagram(whole(std::string(64, 'c'), "")));
  for (const Datagram& good : {whole("TRACKER", ""), fragment(9, 0, 0, 2, std::string("T\0", 2))}) {
    for (std::size_t n = 0; n < good.size(); ++n) {
      EXPECT_FALSE(read_lcm_datagram(std::span(good).first(n))) << n << " bytes";
    }
  }
}

TEST(LcmDatagrams, AnyBytesAreReadWithinThemselves) {
  std::mt19937 random(5);
  for (int i = 0; i < 100'000; ++i) {
    Datagram bytes = i % 2 == 0 ? whole("TRACKER", "data") : fragment(99, 0, 0, 3, "MOUSE3D");
    bytes.resize(random() % (bytes.size() + 1));
    for (int k = 0; k < 3 && !bytes.empty(); ++k) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    const Datagram exact(bytes);  // so that a sanitizer sees the first byte beyond it
    const auto read = read_lcm_datagram(exact);
    if (!read || read->data.empty()) continue;
    EXPECT_GE(read->data.data(), exact.data());
    EXPECT_LE(read->data.data() + read->data.size(), exact.data() + exact.size());
  }
}

TEST(LcmDatagrams, ASenderIsNamedByWhereItSendsFrom) {
  EXPECT_EQ(sender_name((192ull << 24 | 168 << 16 | 1 << 8 | 20) << 16 | 40000),
            "192.168.1.20:40000");
}

}  // namespace
}  // namespace headpin::devices
