#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/math.h"

/// The URLs of LCM. They are checked here and not by liblcm, which ignores what it does not know: a
/// session would go on at another place or with another time to live.
namespace headpin::devices {

/// The destination of messages for a URL such as udpm://239.255.76.67:7667?ttl=0.
struct MulticastGroup {
  std::uint32_t address = 0;  ///< in the host's order
  std::uint16_t port = 0;
};

/// What a URL is used for. A log is either read or written.
enum class LcmUse { any, reading, publishing };

/// The file of file://PATH, with the options mode, speed and start_timestamp.
struct UrlOfLog {
  std::string path;
  bool written = false;
  double speed = 1.0;  ///< 0: as fast as possible
  Time begin = Time::min();
};

/// The server of tcpq://HOST:PORT.
struct UrlOfServer {
  std::string host = "127.0.0.1";
  int port = 7700;
};

/// The URL of an LCM provider: udpm, file, memq or tcpq.
class LcmUrl {
 public:
  /// @param typed   empty: LCM_DEFAULT_URL, else multicast on 239.255.76.67:7667 that stays on the
  ///                host
  /// @param before  what stands before it for the user, such as "--lcm " or "lcm:"
  /// @throws std::invalid_argument  for a URL that is wrong or not for this use
  explicit LcmUrl(std::string typed, std::string_view before = "", LcmUse use = LcmUse::any);

  /// The URL as the user gave it, such as "--lcm foo" or "lcm:foo", for messages.
  const std::string& name() const { return name_; }
  /// The URL alone, or "its default URL", for messages.
  const std::string& shown() const { return shown_; }

  /// One of these is there; none of them for memq.
  const std::optional<MulticastGroup>& group() const { return group_; }
  const std::optional<UrlOfLog>& log() const { return log_; }
  const std::optional<UrlOfServer>& server() const { return server_; }

  /// A hint for the most frequent problem of multicast; empty for other URLs.
  std::string_view hint() const { return group_ ? kMulticastHint : ""; }
  /// The URL of multicast or memq for liblcm, complete.
  std::string for_liblcm() const;

  static constexpr std::string_view kMulticastHint =
      "; multicast needs a route, without a network: ip link set lo multicast on && "
      "ip route add 224.0.0.0/4 dev lo";

 private:
  void take_default();
  void read();
  void read_group(std::string_view network, std::string_view parameters);
  void read_log(std::string_view path, std::string_view parameters);
  void read_server(std::string_view network);
  void check(LcmUse use) const;
  [[noreturn]] void refuse(std::string_view why) const;
  [[noreturn]] void refuse_whole(std::string_view expected) const;

  std::string url_, name_, shown_;
  bool of_environment_ = false;
  std::optional<MulticastGroup> group_;
  int ttl_ = 0, receive_buffer_ = 0;  // of multicast; a buffer of 0 is the system's
  std::optional<UrlOfLog> log_;
  std::optional<UrlOfServer> server_;
};

}  // namespace headpin::devices
