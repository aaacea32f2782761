#include "apps/serve/networks.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace headpin::apps {
namespace {

/// An address that other machines of a network can reach; empty for those of this machine or link.
std::string networked(const sockaddr& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.sa_family == AF_INET) {
    const in_addr& v4 = reinterpret_cast<const sockaddr_in&>(address).sin_addr;
    inet_ntop(AF_INET, &v4, text.data(), text.size());
  } else {
    const in6_addr& v6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
    if (IN6_IS_ADDR_LINKLOCAL(&v6)) return "";
    inet_ntop(AF_INET6, &v6, text.data(), text.size());
  }
  return is_loopback(text.data()) ? "" : text.data();
}

/// The address that this machine would send from to the internet; nothing is sent. Empty without a way.
std::string towards_internet(int family) {
  sockaddr_storage there{};
  socklen_t size = sizeof(sockaddr_in6);
  if (family == AF_INET) {
    auto* const v4 = reinterpret_cast<sockaddr_in*>(&there);
    v4->sin_family = AF_INET;
    v4->sin_port = htons(9);
    inet_pton(AF_INET, "1.1.1.1", &v4->sin_addr);
    size = sizeof *v4;
  } else {
    auto* const v6 = reinterpret_cast<sockaddr_in6*>(&there);
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(9);
    inet_pton(AF_INET6, "2606:4700:4700::1111", &v6->sin6_addr);
  }
  const int fd = ::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return "";
  auto* const address = reinterpret_cast<sockaddr*>(&there);
  const bool known = ::connect(fd, address, size) == 0 && getsockname(fd, address, &size) == 0;
  ::close(fd);
  return known ? networked(*address) : "";
}

bool is_network_card(const std::string& interface) {
  std::error_code none;
  return std::filesystem::exists(std::filesystem::path("/sys/class/net") / interface / "device",
                                 none);
}

}  // namespace

std::string best_known(const std::vector<NetworkAddress>& all) {
  const auto rank = [](const NetworkAddress& one) {
    return one.of_internet ? 2 : one.of_hardware ? 1 : 0;
  };
  const auto best = std::ranges::max_element(all, {}, rank);  // the first of the best
  return best == all.end() ? "" : best->text;
}

std::vector<NetworkAddress> addresses_of(const ifaddrs* interfaces, int family,
                                         const std::string& internet,
                                         const std::function<bool(const std::string&)>& is_card) {
  constexpr unsigned kRuns = IFF_UP | IFF_RUNNING;
  std::vector<NetworkAddress> all;
  for (const ifaddrs* one = interfaces; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != family) continue;
    if ((one->ifa_flags & kRuns) != kRuns) continue;
    const std::string text = networked(*one->ifa_addr);
    if (text.empty()) continue;
    const bool tunnel = (one->ifa_flags & IFF_POINTOPOINT) != 0;
    all.push_back({text, text == internet && !tunnel, is_card(one->ifa_name)});
  }
  return all;
}

std::string reachable(const std::string& bound) {
  const bool all_v4 = bound == "0.0.0.0", all_v6 = bound == "::";
  if (!all_v4 && !all_v6) return bound;
  const int family = all_v4 ? AF_INET : AF_INET6;
  ifaddrs* interfaces = nullptr;
  if (getifaddrs(&interfaces) != 0) return bound;
  const std::string found =
      best_known(addresses_of(interfaces, family, towards_internet(family), is_network_card));
  freeifaddrs(interfaces);
  return found.empty() ? bound : found;
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1";
}

}  // namespace headpin::apps
