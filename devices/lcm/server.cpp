#include "devices/lcm/server.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "devices/lines/byte_stream.h"
#include "devices/lines/tcp.h"

namespace headpin::devices {
namespace {

constexpr std::chrono::seconds kServerPatience{5};
/// What client and server send first: their magic number and the version of the protocol.
constexpr std::array<std::uint8_t, 8> kClientGreeting = {0x28, 0x76, 0x17, 0xfb, 0, 0, 1, 0};
constexpr std::array<std::uint8_t, 4> kServerMagic = {0x28, 0x76, 0x17, 0xfa};

/// The number of a host; empty when the host is unknown.
std::string ipv4_address(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return "";
  std::array<char, INET_ADDRSTRLEN> text{};
  const auto* const address = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
  freeaddrinfo(found);
  return text.data();
}

/// Whether a server of LCM answers.
bool greets(const std::string& address, int port) {
  const std::unique_ptr<ByteStream> server = connect_tcp(address, port, kServerPatience);
  server->write(kClientGreeting);
  std::array<std::uint8_t, kClientGreeting.size()> answer{};
  std::size_t heard = 0;
  const auto end = std::chrono::steady_clock::now() + kServerPatience;
  while (heard < answer.size() && !server->closed() && std::chrono::steady_clock::now() < end) {
    pollfd state{server->descriptor(), POLLIN, 0};
    ::poll(&state, 1, 100);
    heard += server->read(std::span(answer).subspan(heard));
  }
  return heard == answer.size() &&
         std::ranges::equal(kServerMagic, std::span(answer).first(kServerMagic.size()));
}

}  // namespace

std::string find_server(const LcmUrl& url) {
  const std::string address = ipv4_address(url.server()->host);
  bool answers = false;
  try {
    answers = !address.empty() && greets(address, url.server()->port);
  } catch (const std::runtime_error&) {  // nobody is there
  }
  if (!answers) {
    throw std::runtime_error(url.name() +
                             ": no LCM server answers there; expected a running lcm-tcpq-server");
  }
  return fmt::format("tcpq://{}:{}", address, url.server()->port);
}

}  // namespace headpin::devices
