// The address of `serve` that other machines are told.

#include "apps/serve/networks.h"

#include <gtest/gtest.h>

namespace headpin::apps {
namespace {

const NetworkAddress kDocker{"172.17.0.1"}, kCable{"10.0.0.7", false, true},
    kWireless{"192.168.1.20", true, true}, kOfVirtualMachine{"10.0.2.15", true, false},
    kTunnel{"10.8.0.2"};

TEST(Networks, TheAddressTowardsTheInternetGoesBeforeCardsAndCardsBeforeBridges) {
  EXPECT_EQ(best_known({kDocker, kCable, kWireless}), kWireless.text);
  EXPECT_EQ(best_known({kWireless, kCable, kDocker}), kWireless.text);
  EXPECT_EQ(best_known({kDocker, kTunnel, kCable}), kCable.text);
  EXPECT_EQ(best_known({kDocker, kCable, kOfVirtualMachine}), kOfVirtualMachine.text);
  EXPECT_EQ(best_known({kDocker, kTunnel}), kDocker.text);
  EXPECT_EQ(best_known({kCable, {"10.0.0.8", false, true}}), kCable.text);
  EXPECT_EQ(best_known({}), "");
}

TEST(Networks, OneAddressIsKnownAsItselfAndAllAsOneThatIsNoLoopback) {
  for (const char* one : {"192.0.2.9", "127.0.0.1", "2001:db8::9", "::1"}) {
    EXPECT_EQ(reachable(one), one);
  }
  for (const char* all : {"0.0.0.0", "::"}) EXPECT_FALSE(is_loopback(reachable(all)));
}

}  // namespace
}  // namespace headpin::apps
