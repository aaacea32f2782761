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

#include "base/math.h"
#include "devices/lcm/url.h"

/// Reads LCM's multicast messages (udpm). This stays our own code, because two datagrams can crash
/// a process in which liblcm 1.3.1 reads them (pull request 628 of lcm-proj/lcm), and because
/// liblcm does not report the sender of a message.
namespace headpin::devices {

/// One datagram: a message, or one fragment of a message that is too large for one datagram.
struct LcmDatagram {
  std::string_view channel;            ///< empty in all fragments but the first
  std::span<const std::uint8_t> data;  ///< of a whole message
  bool whole = false;
};

/// @return  nothing for bytes that are not LCM's; else with views into the bytes
std::optional<LcmDatagram> read_lcm_datagram(std::span<const std::uint8_t> bytes);

/// Receives messages on some channels of a multicast group, with their arrival times and senders.
class MulticastListener {
 public:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> data;  ///< empty for a message of more than one datagram
    std::uint64_t sender = 0;        ///< its address and port, as sender_name() reads them
    Time arrived{};                  ///< wall-clock time, from the kernel
  };

  /// Joins the group. The kernel keeps messages until start() or take().
  ///
  /// @param queue  largest number of waiting messages; then the oldest are dropped
  /// @throws std::runtime_error  when that is impossible, for example without a route for multicast
  MulticastListener(const MulticastGroup& group, std::vector<std::string> channels,
                    std::size_t queue);
  ~MulticastListener();
  MulticastListener(const MulticastListener&) = delete;
  MulticastListener& operator=(const MulticastListener&) = delete;

  /// Starts a thread that reads.
  void start();
  /// The oldest waiting message.
  std::optional<Message> take();
  /// Number of messages that were dropped since the last call.
  std::int64_t take_dropped() { return dropped_.exchange(0); }

 private:
  void hear(int wait_ms);
  bool hear_one();
  void keep(const LcmDatagram& datagram, std::uint64_t sender, Time arrived);

  int socket_ = -1;
  std::vector<std::string> channels_;
  std::size_t queue_;
  std::vector<std::uint8_t> bytes_;  ///< of the current datagram
  std::mutex mutex_;                 ///< for the waiting messages
  std::deque<Message> waiting_;
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// ADDRESS:PORT
std::string sender_name(std::uint64_t sender);

}  // namespace headpin::devices
