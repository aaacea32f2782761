#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/clock_offset.h"
#include "devices/genlock.h"
#include "devices/source.h"
#include "devices/trial_sink.h"
#include "devices/viewer_messages.h"
#include "files/output_file.h"

/// Samples and everything else of a trial over LCM: published as they happen, subscribed to as a
/// source.
namespace headpin::devices {

/// One end of LCM, by whatever provider its URL names: udpm, file, memq, tcpq, mpudpm.
class LcmLink {
 public:
  /// @param url  empty: LCM_DEFAULT_URL, else multicast on 239.255.76.67:7667 that stays on
  ///             the host
  /// @throws std::runtime_error  when LCM cannot be opened there
  /// @param prefix  before the channels of a trial's messages
  /// @param output  how a log is written, file://PATH?mode=w: a file as all outputs, there from the
  ///                start
  explicit LcmLink(const std::string& url, std::string_view prefix = "",
                   files::OutputFile::Options output = {});
  ~LcmLink();
  LcmLink(const LcmLink&) = delete;
  LcmLink& operator=(const LcmLink&) = delete;

  /// @throws std::runtime_error  when it cannot be sent, as over multicast without a route
  void publish(const TrialHeader& header);
  void publish(const Sample& sample);
  void publish(const Event& event);
  void publish(const TickState& state);
  void publish(const FrameRecord& frame);

  /// For Drake's viewer, and for whoever wants to see what the eyes see.
  void publish(std::span<const ViewerLink> links);
  void publish(Time time, std::span<const ViewerPose> poses);
  void publish(const EyePictures& eyes);

  /// bot_core's rigid_transform_t, for those who know nothing of headpin.
  void publish_pose(const std::string& channel, Time time, const Pose& pose);

  const std::string& url() const { return url_; }
  /// A log being read: what it holds comes in at its pace and ends, and nothing can be published.
  bool is_replay() const { return log_ != nullptr; }

 private:
  friend class LcmSource;
  struct Lcm;
  class LogPlayer;
  class LogWriter;
  std::string named(std::string_view channel) const { return prefix_ + std::string(channel); }
  void send(const std::string& channel, std::span<const std::uint8_t> bytes);

  std::string url_, prefix_;
  std::unique_ptr<Lcm> lcm_;  // unless a log is read or written, without liblcm
  std::unique_ptr<LogPlayer> log_;
  std::unique_ptr<LogWriter> written_;
  std::vector<std::uint8_t> bytes_;  // of the message at hand
};

/// A trial published as it comes about. Its header and who draws its frames are repeated every second,
/// for those who begin to listen later.
class TrialPublisher : public TrialSink {
 public:
  /// @param link    must outlive this
  /// @param header  completed as by stamped()
  TrialPublisher(LcmLink& link, const TrialHeader& header);

  void write(const Sample& sample) override;
  void write(const Event& event) override;
  void write(const TickState& state) override;
  void write(const FrameRecord& frame) override;
  void close() override;

 private:
  template <typename T>
  void send(Time time, const T& message);

  LcmLink& link_;
  TrialHeader header_;
  std::optional<Event> drawn_by_;
  std::int64_t count_ = 1;  ///< of messages, what is repeated once
  Time last_{}, next_header_{};
};

/// Samples that others publish on TRACKER and MOUSE3D.
///
/// Each station has a publisher with a clock of its own. ClockOffset carries it over to the
/// session's from the first sample on, and anew when it jumps by more than a second; a sample's
/// stamps are then both on the session's clock. The mouse's few messages follow the station whose
/// clock shows nearly the same.
class LcmSource : public Source {
 public:
  struct Counts {
    std::int64_t received = 0;
    std::int64_t dropped = 0;      ///< the oldest, when more wait than the queue holds
    std::int64_t undecodable = 0;  ///< another type or size
    std::int64_t implausible = 0;  ///< NaN, quaternions not unit, times or places out of range
    std::int64_t foreign = 0;      ///< poses in another frame than the transmitter's
    std::int64_t clock_jumps = 0;  ///< a publisher's clock, against the session's
  };
  static constexpr std::int32_t kMouse = 0;
  /// Who publishes a station, or the mouse.
  struct Publisher {
    ClockOffset clock;
    std::int64_t samples = 0;
    Time theirs{};       ///< time of its newest sample as published
    Time device_time{};  ///< the same on the session's clock
    Time host_time{};    ///< when that came
    /// What that came later than the one of its samples that was late the least.
    Time late() const { return host_time - device_time; }
  };

  /// @param link   must outlive this
  /// @param queue  how many samples wait at most until they are polled
  explicit LcmSource(LcmLink& link, std::size_t queue = 4096);
  ~LcmSource() override;

  /// From now on messages are stamped with when LCM got them on this clock, in place of the time at
  /// which they are asked for; that is before they came when a session is late.
  void use_clock(std::function<Time()> clock) { clock_ = std::move(clock); }

  /// From now on the first station's clock is taken for the session's; null: none is.
  void hold_to(Genlock* genlock) { genlock_ = genlock; }

  /// Throws away what has arrived up to now. What waited while a session was made ready would say
  /// nothing of the publishers' clocks.
  void drain();

  /// Takes in what has arrived, without waiting, and stamps it with `now` as its host time, or with
  /// just after the last poll, so that a replay hands it out at the same tick. A time that is later
  /// than the arrival does no harm; an earlier one makes all samples too early.
  ///
  /// @throws std::runtime_error  when LCM stops, as a tcpq server does
  void receive(Time now);

  void poll(Time now, std::vector<Sample>& out) override;
  /// At the end of a log; anything else that ends is an error of receive().
  bool exhausted() const override { return ended_ && waiting_.empty(); }

  const Counts& counts() const { return counts_; }
  /// By station; kMouse is the mouse.
  const std::map<std::int32_t, Publisher>& publishers() const { return publishers_; }

 private:
  struct Subscriptions;
  void stamp(TrackerSample& sample);
  void stamp(MouseSample& sample);
  Time carried_over(Publisher& publisher, Time theirs, const void* held_to);
  Time held(Time theirs, double ours_us, const void* held_to) const;
  void stamp_arrival(std::int64_t wall_us);
  void take(std::string_view channel, std::span<const std::uint8_t> bytes);

  LcmLink& link_;
  std::size_t queue_;
  std::deque<Sample> waiting_;  // in the order they came
  std::map<std::int32_t, Publisher> publishers_;
  std::function<Time()> clock_;
  Genlock* genlock_ = nullptr;
  Time receiving_{}, polled_{};
  bool ended_ = false, draining_ = false;
  Counts counts_;
  std::unique_ptr<Subscriptions> subscriptions_;
};

}  // namespace headpin::devices
