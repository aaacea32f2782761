#pragma once

#include <functional>
#include <string>
#include <vector>

struct ifaddrs;  // of <ifaddrs.h>

namespace headpin::apps {

/// An address of this machine that other machines may reach.
struct NetworkAddress {
  std::string text;
  bool of_internet = false;  ///< the machine has it towards the internet, but not through a tunnel
  bool of_hardware = false;  ///< of a network card, and not of a bridge, a tunnel or the like
};

/// The address that the machines around most likely reach: the one towards the internet, else the first of
/// a network card, else the first. A bridge such as docker0 is for what runs on this machine.
///
/// @return  empty without any
std::string best_known(const std::vector<NetworkAddress>& all);

/// The addresses of a family that other machines may reach, of interfaces that run: a cable that is unplugged
/// keeps its address.
///
/// @param interfaces  as getifaddrs() tells them
/// @param internet    the address towards the internet; empty for none
/// @param is_card     whether the interface of a name is a network card
std::vector<NetworkAddress> addresses_of(const ifaddrs* interfaces, int family,
                                         const std::string& internet,
                                         const std::function<bool(const std::string&)>& is_card);

/// Of 0.0.0.0 and ::, the best known address of this machine; of others, themselves.
std::string reachable(const std::string& bound);

/// Whether only this machine reaches the address.
bool is_loopback(const std::string& address);

}  // namespace headpin::apps
