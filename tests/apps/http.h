#pragma once

#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

/// HTTP as bytes on a socket, so that a test can also send what no client would.
namespace headpin {

class Connection {
 public:
  explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      close(socket_);
      throw std::runtime_error("nobody listens at port " + std::to_string(port));
    }
  }
  ~Connection() {
    if (socket_ >= 0) close(socket_);
  }
  Connection(Connection&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Connection& operator=(Connection&&) = delete;

  /// @return  whether all of it was taken
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// All that comes until the other side closes.
  std::string rest() {
    std::string all;
    char piece[4096];
    for (;;) {
      const ssize_t got = recv(socket_, piece, sizeof piece, 0);
      if (got <= 0) return all;
      all.append(piece, static_cast<std::size_t>(got));
    }
  }

 private:
  int socket_;
};

struct Reply {
  int status = 0;  ///< 0 without an answer
  std::string body;
};

inline Reply reply_of(const std::string& bytes) {
  if (!bytes.starts_with("HTTP/1.1 ")) return {};
  const std::size_t body = bytes.find("\r\n\r\n");
  return {std::stoi(bytes.substr(9, 3)), body == bytes.npos ? "" : bytes.substr(body + 4)};
}

inline std::string request(const std::string& method, const std::string& target,
                           const std::string& body = "") {
  return method + " " + target + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace headpin
