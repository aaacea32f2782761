#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "engine/math.h"

/// LCM over multicast (udpm), read by ourselves: two datagrams can end a process in which liblcm
/// 1.3.1 reads them (pull request 628 of lcm-proj/lcm), and liblcm does not say who sent a message.
namespace headpin::devices {

/// One datagram: a message, or one fragment of a message that is too large for one datagram.
struct LcmDatagram {
  std::string_view channel;            ///< empty in all fragments but the first
  std::span<const std::uint8_t> data;  ///< of a whole message
  bool whole = false;
};

/// @return  nothing for what LCM does not send; else with views into the bytes
std::optional<LcmDatagram> read_lcm_datagram(std::span<const std::uint8_t> bytes);

/// Where the messages of a URL such as udpm://239.255.76.67:7667?ttl=0 are sent to.
struct MulticastGroup {
  std::uint32_t address = 0;  ///< in the host's order
  std::uint16_t port = 0;
};

/// @param url  empty: LCM's default
/// @return  nothing for the URL of another provider, or of no address
std::optional<MulticastGroup> multicast_group(const std::string& url);

/// What users of multicast meet most, and what helps; empty for other URLs.
std::string multicast_hint(const std::string& url);

/// Messages on some channels of a multicast group, with when they came and who sent them.
class MulticastListener {
 public:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> data;  ///< none of a message of more than one datagram
    std::uint64_t sender = 0;        ///< its address and port, as sender_name() reads them
    Time arrived{};                  ///< by the wall's clock, as the kernel says
  };

  /// Hears the group from now on. What waits is kept by the kernel until start() or take().
  ///
  /// @param queue  how many messages wait at most; then the oldest go
  /// @throws std::runtime_error  when that is impossible, as without a route for multicast
  MulticastListener(const MulticastGroup& group, std::vector<std::string> channels,
                    std::size_t queue);
  ~MulticastListener();
  MulticastListener(const MulticastListener&) = delete;
  MulticastListener& operator=(const MulticastListener&) = delete;

  /// Reads in a thread of its own from now on.
  void start();
  /// The oldest that waits.
  std::optional<Message> take();
  /// How many were left out since the last call, as too many waited.
  std::int64_t take_dropped() { return dropped_.exchange(0); }

 private:
  void hear(int wait_ms);
  bool hear_one();
  void keep(const LcmDatagram& datagram, std::uint64_t sender, Time arrived);

  int socket_ = -1;
  std::vector<std::string> channels_;
  std::size_t queue_;
  std::vector<std::uint8_t> bytes_;  ///< of the datagram at hand
  std::mutex mutex_;                 ///< of what waits
  std::deque<Message> waiting_;
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// ADDRESS:PORT
std::string sender_name(std::uint64_t sender);

}  // namespace headpin::devices
