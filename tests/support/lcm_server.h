#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace headpin {

/// A port of 127.0.0.1 that nobody else gets. Nobody answers there until it listens.
class LocalPort {
 public:
  LocalPort() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("no port");
    }
    number_ = ntohs(address.sin_port);
  }
  ~LocalPort() { close(socket_); }
  LocalPort(const LocalPort&) = delete;
  LocalPort& operator=(const LocalPort&) = delete;

  int descriptor() const { return socket_; }
  int number() const { return number_; }
  std::string url() const { return "tcpq://127.0.0.1:" + std::to_string(number_); }

 private:
  int socket_, number_ = 0;
};

/// A server of LCM (tcpq) that forwards nothing. It serves until it is destroyed.
class LocalLcmServer {
 public:
  /// @param greets  answers as a server of LCM, else closes each connection at once
  /// @param most    it answers as many connections, and closes those after them
  explicit LocalLcmServer(bool greets, std::size_t most = 1000) : greets_(greets), most_(most) {
    if (::listen(port_.descriptor(), 10) != 0) throw std::runtime_error("cannot listen");
    thread_ = std::thread([this] { serve(); });
  }
  ~LocalLcmServer() {
    stopping_ = true;
    thread_.join();
    close_all();
  }
  LocalLcmServer(const LocalLcmServer&) = delete;
  LocalLcmServer& operator=(const LocalLcmServer&) = delete;

  std::string url() const { return port_.url(); }

  /// Closes the connections. Those that come later are closed at once.
  void close_all() {
    const std::lock_guard lock(mutex_);
    greets_ = false;
    for (const int connection : connections_) close(connection);
    connections_.clear();
  }

 private:
  void serve() {
    while (!stopping_) {
      pollfd state{port_.descriptor(), POLLIN, 0};
      if (poll(&state, 1, 10) != 1) continue;
      const int connection = accept4(port_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC);
      if (connection < 0) continue;
      const std::lock_guard lock(mutex_);
      if (greets_ && connections_.size() < most_ && greet(connection)) {
        connections_.insert(connection);
      } else {
        close(connection);
      }
    }
  }
  static bool greet(int connection) {
    constexpr std::array<unsigned char, 8> kGreeting = {0x28, 0x76, 0x17, 0xfa, 0, 0, 1, 0};
    std::array<unsigned char, 8> client{};
    return recv(connection, client.data(), client.size(), MSG_WAITALL) == 8 && client[3] == 0xfb &&
           send(connection, kGreeting.data(), kGreeting.size(), MSG_NOSIGNAL) == 8;
  }

  LocalPort port_;
  std::mutex mutex_;  ///< for the members below
  bool greets_;
  std::size_t most_;
  std::set<int> connections_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace headpin
