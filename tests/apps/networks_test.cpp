// The address of `serve` that other machines are told.

#include "apps/serve/networks.h"

#include <iterator>
#include <list>
#include <set>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

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

constexpr unsigned kRunning = IFF_UP | IFF_RUNNING;

/// Interfaces as the system tells them. Those whose names begin with "card" are network cards.
class Interfaces {
 public:
  /// @param address  IPv4; empty for an interface that has none
  void add(const std::string& name, const std::string& address, unsigned flags = kRunning) {
    One& one = all_.emplace_back();
    one.name = name;
    one.address.sin_family = AF_INET;
    inet_pton(AF_INET, address.c_str(), &one.address.sin_addr);
    one.entry.ifa_name = one.name.data();
    one.entry.ifa_flags = flags;
    if (!address.empty()) one.entry.ifa_addr = reinterpret_cast<sockaddr*>(&one.address);
    if (all_.size() > 1) std::prev(all_.end(), 2)->entry.ifa_next = &one.entry;
  }

  /// @param internet  the address towards the internet
  std::string best(const std::string& internet = "") const {
    const auto is_card = [](const std::string& name) { return name.starts_with("card"); };
    return best_known(addresses_of(&all_.front().entry, AF_INET, internet, is_card));
  }

 private:
  struct One {
    std::string name;
    sockaddr_in address{};
    ifaddrs entry{};
  };
  std::list<One> all_;
};

TEST(Networks, ACardGoesBeforeABridgeAndATunnelIsNoWayToTheInternet) {
  Interfaces all;
  all.add("lo", "127.0.0.1", kRunning | IFF_LOOPBACK);
  all.add("card2", "");
  all.add("docker0", "172.17.0.1");
  all.add("tun0", "10.8.0.2", kRunning | IFF_POINTOPOINT);
  EXPECT_EQ(all.best("10.8.0.2"), "172.17.0.1");
  all.add("card0", "192.168.1.20");
  EXPECT_EQ(all.best("10.8.0.2"), "192.168.1.20");
  EXPECT_EQ(all.best(), "192.168.1.20");
  EXPECT_EQ(all.best("172.17.0.1"), "172.17.0.1");
}

// An eth0 without its cable went before wlan0, where it has an address of its own.
TEST(Networks, AnInterfaceThatDoesNotRunIsLeftOut) {
  Interfaces all;
  all.add("card0", "10.0.0.7", IFF_UP);
  all.add("card1", "10.0.0.8", IFF_RUNNING);
  EXPECT_EQ(all.best("10.0.0.7"), "");
  all.add("card2", "192.168.1.20");
  EXPECT_EQ(all.best(), "192.168.1.20");
  EXPECT_EQ(all.best("10.0.0.7"), "192.168.1.20");
}

/// The addresses of this machine that run and are not only for itself.
std::set<std::string> of_this_machine() {
  std::set<std::string> all;
  ifaddrs* interfaces = nullptr;
  EXPECT_EQ(getifaddrs(&interfaces), 0);
  for (const ifaddrs* one = interfaces; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & kRunning) != kRunning) continue;
    const std::string text =
        inet_ntoa(reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr);
    if (!is_loopback(text)) all.insert(text);
  }
  freeifaddrs(interfaces);
  return all;
}

TEST(Networks, OneAddressIsKnownAsItselfAndAllAsOneOfThisMachine) {
  for (const char* one : {"192.0.2.9", "127.0.0.1", "2001:db8::9", "::1"}) {
    EXPECT_EQ(reachable(one), one);
  }
  std::set<std::string> own = of_this_machine();
  if (own.empty()) own.insert("0.0.0.0");  // without a network
  EXPECT_TRUE(own.contains(reachable("0.0.0.0"))) << reachable("0.0.0.0");
}

}  // namespace
}  // namespace headpin::apps
