#include "devices/lcm_link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <headpin/rigid_transform_t.hpp>
#include <lcm/lcm.h>

#include "devices/event_log.h"
#include "devices/log.h"
#include "devices/messages.h"
#include "devices/sources.h"

namespace headpin::devices {

namespace {

std::string shown(const std::string& url) {
  return url.empty() ? "its default URL" : url;
}

/// What users of multicast meet most, and what helps.
std::string hint_for(const std::string& url) {
  const bool multicast = url.empty() || url.starts_with("udpm:") || url.starts_with("mpudpm:");
  return multicast ? "; multicast needs a route, without a network: ip link set lo multicast on && "
                     "ip route add 224.0.0.0/4 dev lo"
                   : "";
}

}  // namespace

struct LcmLink::Lcm {
  lcm_t* handle = nullptr;
  ~Lcm() {
    if (handle) lcm_destroy(handle);
  }
};

/// A log that is written: liblcm would empty whatever has its name, and does not say what the disk
/// did not take.
class LcmLink::LogWriter {
 public:
  LogWriter(const std::string& path, files::OutputFile::Options options)
      : file_(path, std::move(options)) {}

  void write(const std::string& channel, std::span<const std::uint8_t> bytes) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();  // as liblcm stamps them
    bytes_.clear();
    append({number_++, std::chrono::duration_cast<Time>(now), channel, bytes}, bytes_);
    file_.write(bytes_.data(), bytes_.size());
  }

 private:
  files::OutputFile file_;
  std::int64_t number_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// A log that plays: file://PATH, with speed=N (1; 0: all at once) and start_timestamp=N as liblcm
/// knows them, read by our own reader, which no damage can hurt.
class LcmLink::LogPlayer {
 public:
  explicit LogPlayer(const std::string& url)
      : file_(path_of(url)), reader_(file_), next_(reader_.next()) {
    if (!next_) throw std::runtime_error(path_of(url) + ": not an LCM event log: no whole event");
    for (std::string_view rest = options_of(url); !rest.empty();) {
      const std::string_view option = rest.substr(0, rest.find('&'));
      rest.remove_prefix(std::min(rest.size(), option.size() + 1));
      take_option(url, option);
    }
    while (next_ && next_->time < begin_) next_ = reader_.next();
    if (next_) last_ = next_->time;
  }

  /// For a log that is only read, unlike file://PATH?mode=w.
  static bool reads(const std::string& url) {
    return url.starts_with(kScheme) && options_of(url).find("mode=w") == std::string_view::npos &&
           options_of(url).find("mode=a") == std::string_view::npos;
  }

  /// The file of a URL that writes one; empty for other URLs.
  static std::string written_by(const std::string& url) {
    return url.starts_with(kScheme) && !reads(url) ? path_of(url) : "";
  }

  /// The next event that is due by `now`, counted from the first call; there until the next call.
  std::optional<LogEvent> due(Time now) {
    if (!start_) start_ = now;
    if (!next_) return std::nullopt;
    // Times that a log's writer cannot have meant are no reason to wait for years.
    const Time gap = next_->time > last_ ? next_->time - last_ : Time{};
    const Time at = played_ + (gap > kLongestGap ? Time{} : gap);
    const double ahead = seconds(now - *start_) * speed_ - seconds(at);
    if (speed_ > 0.0 && ahead < 0.0) return std::nullopt;
    played_ = at;
    last_ = next_->time;
    // Its bytes are there until the next one is read.
    channel_ = next_->channel;
    data_.assign(next_->data.begin(), next_->data.end());
    const LogEvent event{next_->number, next_->time, channel_, data_};
    next_ = reader_.next();
    return event;
  }
  bool ended() const { return !next_; }

 private:
  static constexpr std::string_view kScheme = "file://";
  static std::string path_of(const std::string& url) {
    return url.substr(kScheme.size(), url.find('?') - kScheme.size());
  }
  static std::string_view options_of(std::string_view url) {
    const std::size_t mark = url.find('?');
    return mark == std::string_view::npos ? std::string_view() : url.substr(mark + 1);
  }
  void take_option(const std::string& url, std::string_view option) {
    const std::size_t sign = option.find('=');
    const std::string_view name = option.substr(0, sign);
    const std::string_view value =
        option.substr(sign == std::string_view::npos ? option.size() : sign + 1);
    const auto number = [&](auto& into) {
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), into);
      return error == std::errc{} && end == value.data() + value.size();
    };
    std::int64_t begin = 0;
    if (name == "mode" && value == "r") return;
    if (name == "speed" && number(speed_) && speed_ >= 0.0 && std::isfinite(speed_)) return;
    if (name == "start_timestamp" && number(begin)) {
      begin_ = Time{begin};
      return;
    }
    throw std::runtime_error(
        fmt::format("{}: option '{}': expected speed=N (0: as fast as it goes), "
                    "start_timestamp=MICROSECONDS or mode=r",
                    url, option));
  }

  FileWindow file_;  ///< not mapped: a log that is cut meanwhile ends there
  LogReader reader_;
  std::optional<LogEvent> next_;
  std::string channel_;             ///< of the event played last
  std::vector<std::uint8_t> data_;  ///< likewise
  double speed_ = 1.0;
  Time begin_ = Time::min();
  std::optional<Time> start_;  ///< on the session's clock
  Time last_{};                ///< of the last event played, in the log
  Time played_{};              ///< the same, since the first
};

LcmLink::LcmLink(const std::string& url, std::string_view prefix, files::OutputFile::Options output)
    : url_(url), prefix_(prefix) {
  if (LogPlayer::reads(url)) {
    log_ = std::make_unique<LogPlayer>(url);
    return;
  }
  const char* of_environment = std::getenv("LCM_DEFAULT_URL");
  const std::string meant = url.empty() && of_environment != nullptr ? of_environment : url;
  if (const std::string path = LogPlayer::written_by(meant); !path.empty()) {
    if (meant.find("mode=a") != std::string::npos) {
      throw std::runtime_error(path + ": nothing is appended to a log; expected mode=w");
    }
    output.live = true;
    written_ = std::make_unique<LogWriter>(path, std::move(output));
    return;
  }
  lcm_ = std::make_unique<Lcm>();
  lcm_->handle = lcm_create(meant.empty() ? nullptr : meant.c_str());
  if (!lcm_->handle) {
    throw std::runtime_error("cannot open LCM at " + shown(url) + hint_for(url));
  }
}

LcmLink::~LcmLink() = default;

void LcmLink::send(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (log_)
    throw std::runtime_error("cannot publish on " + channel + " at " + url_ + ": it is read");
  if (written_) return written_->write(channel, bytes);
  do {
    errno = 0;
    if (lcm_publish(lcm_->handle, channel.c_str(), bytes.data(),
                    static_cast<unsigned>(bytes.size())) >= 0) {
      return;
    }
  } while (errno == EINTR);
  throw std::runtime_error(fmt::format("cannot publish on {} at {}: {}{}", channel, shown(url_),
                                       errno ? std::strerror(errno) : "refused by LCM",
                                       hint_for(url_)));
}

void LcmLink::publish(const TrialHeader& header) {
  encode(header, bytes_);
  send(named(kTrialChannel), bytes_);
}

void LcmLink::publish(const Sample& sample) {
  std::visit([&](const auto& s) { encode(s, bytes_); }, sample);
  const bool tracker = std::holds_alternative<TrackerSample>(sample);
  send(named(tracker ? kTrackerChannel : kMouseChannel), bytes_);
}

void LcmLink::publish(const Event& event) {
  encode(event, bytes_);
  send(named(kEventChannel), bytes_);
}

void LcmLink::publish(const TickState& state) {
  encode(state, bytes_);
  send(named(kStateChannel), bytes_);
}

void LcmLink::publish(const FrameRecord& frame) {
  encode(frame, bytes_);
  send(named(kFrameChannel), bytes_);
}

void LcmLink::publish(std::span<const ViewerLink> links) {
  encode(links, bytes_);
  send(kViewerLoadChannel, bytes_);
}

void LcmLink::publish(Time time, std::span<const ViewerPose> poses) {
  encode(time, poses, bytes_);
  send(kViewerDrawChannel, bytes_);
}

void LcmLink::publish(const EyePictures& eyes) {
  encode(eyes, bytes_);
  send(kEyesChannel, bytes_);
}

void LcmLink::publish_pose(const std::string& channel, Time time, const Pose& pose) {
  rigid_transform_t m;
  m.utime = time.count();
  std::copy_n(pose.p.data(), 3, m.trans);
  const std::array quat = {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
  std::ranges::copy(quat, m.quat);
  bytes_.resize(static_cast<std::size_t>(m.getEncodedSize()));
  m.encode(bytes_.data(), 0, m.getEncodedSize());
  send(channel, bytes_);
}

TrialPublisher::TrialPublisher(LcmLink& link, const TrialHeader& header)
    : link_(link), header_(stamped(header)) {
  link_.publish(header_);
  next_header_ = Time{1'000'000};
}

template <typename T>
void TrialPublisher::send(Time time, const T& message) {
  last_ = std::max(last_, time);
  if (last_ >= next_header_) {
    link_.publish(header_);
    if (drawn_by_) link_.publish(*drawn_by_);
    next_header_ = last_ + Time{1'000'000};
  }
  link_.publish(message);
  ++count_;
}

void TrialPublisher::write(const Sample& sample) {
  send(available(sample), sample);
}

void TrialPublisher::write(const Event& event) {
  send(event.time, event);
  if (event.kind == kDrawnByEvent) drawn_by_ = event;
}

void TrialPublisher::write(const TickState& state) {
  send(state.time, state);
}

void TrialPublisher::write(const FrameRecord& frame) {
  send(frame.time, frame);
}

void TrialPublisher::close() {
  Event end;
  end.time = last_;
  end.kind = kEndEvent;
  end.value = static_cast<double>(count_);
  send(end.time, end);
}

struct LcmSource::Subscriptions {
  lcm_t* lcm = nullptr;
  std::vector<lcm_subscription_t*> all;

  void add(LcmSource& source, std::string_view channel, int queue) {
    lcm_subscription_t* subscription = lcm_subscribe(
        lcm, std::string(channel).c_str(),
        [](const lcm_recv_buf_t* received, const char* on, void* to) {
          auto* subscriber = static_cast<LcmSource*>(to);
          subscriber->stamp_arrival(received->recv_utime);
          subscriber->take(on,
                           {static_cast<const std::uint8_t*>(received->data), received->data_size});
        },
        &source);
    if (!subscription) throw std::runtime_error("cannot subscribe to LCM");
    lcm_subscription_set_queue_capacity(subscription, queue);
    all.push_back(subscription);
  }
  ~Subscriptions() {
    for (lcm_subscription_t* subscription : all) lcm_unsubscribe(lcm, subscription);
  }
};

LcmSource::LcmSource(LcmLink& link, std::size_t queue)
    : link_(link), queue_(queue), subscriptions_(std::make_unique<Subscriptions>()) {
  if (link.is_replay()) return;
  if (!link.lcm_) throw std::runtime_error(link.url() + ": is written; expected one that is read");
  subscriptions_->lcm = link.lcm_->handle;
  const int capacity = static_cast<int>(std::min<std::size_t>(queue, 1 << 20));
  subscriptions_->add(*this, kTrackerChannel, capacity);
  subscriptions_->add(*this, kMouseChannel, capacity);
}

LcmSource::~LcmSource() = default;

void LcmSource::drain() {
  if (link_.is_replay()) return;
  draining_ = true;
  receive(polled_);
  draining_ = false;
}

void LcmSource::receive(Time now) {
  receiving_ = std::max(now, polled_ + Time{1});
  // No more at once than the queue holds, so that a flood cannot keep us here.
  for (std::size_t i = 0; i < queue_; ++i) {
    if (link_.is_replay()) {
      const std::optional<LogEvent> event = link_.log_->due(now);
      ended_ = link_.log_->ended();
      if (!event) return;
      if (event->channel == kTrackerChannel || event->channel == kMouseChannel) {
        take(event->channel, event->data);
      }
      continue;
    }
    errno = 0;
    const int handled = lcm_handle_timeout(link_.lcm_->handle, 0);
    // A signal that comes meanwhile is a failure to LCM; what waits is there at the next tick.
    if (handled == 0 || (handled < 0 && errno == EINTR)) return;
    if (handled < 0) throw std::runtime_error("LCM stopped: " + link_.url());
  }
}

/// By the wall's clock, as LCM has it, when a message came that is handled only now.
void LcmSource::stamp_arrival(std::int64_t wall_us) {
  if (!clock_) return;
  // In this order, so that a pause between the two makes it later and not earlier.
  const Time wall =
      std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
  const Time waited = std::clamp(wall - Time{wall_us}, Time{0}, Time{1'000'000});
  receiving_ = std::max(clock_() - waited, polled_ + Time{1});
}

void LcmSource::take(std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (draining_) return;
  const std::optional<Message> message = decode(channel, bytes);
  if (!message) {
    ++counts_.undecodable;
    return;
  }
  if (!plausible(*message)) {
    ++counts_.implausible;
    return;
  }
  Sample sample;
  if (const auto* tracker = std::get_if<TrackerSample>(&*message)) {
    if (!tracker->in_transmitters_frame()) {
      ++counts_.foreign;
      return;
    }
    sample = *tracker;
  }
  if (const auto* mouse = std::get_if<MouseSample>(&*message)) sample = *mouse;
  ++counts_.received;
  std::visit(
      [&](auto& s) {
        stamp(s);
        s.session_time = Time{};  // another session's, if any
      },
      sample);
  waiting_.push_back(std::move(sample));
  if (waiting_.size() > queue_) {
    waiting_.pop_front();
    ++counts_.dropped;
  }
}

void LcmSource::stamp(TrackerSample& sample) {
  Publisher& publisher = publishers_[sample.station];
  sample.device_time = carried_over(publisher, sample.device_time, &publisher);
  sample.host_time = receiving_;
}

/// One message says little of what it is late itself, so it follows the station whose clock shows
/// nearly the same.
void LcmSource::stamp(MouseSample& sample) {
  constexpr double kSameClock_us = 1e5;
  const auto theirs_us = static_cast<double>(sample.device_time.count());
  const auto off = [&](const auto& entry) {
    const auto& [station, publisher] = entry;
    return station == kMouse ? kSameClock_us
                             : std::abs(publisher.clock.ours(theirs_us) -
                                        static_cast<double>(receiving_.count()));
  };
  const auto nearest = std::ranges::min_element(publishers_, {}, off);
  Publisher& mouse = publishers_[kMouse];
  if (nearest != publishers_.end() && off(*nearest) < kSameClock_us) {
    mouse.clock = nearest->second.clock;
    mouse.theirs = sample.device_time;
    mouse.device_time = held(sample.device_time, mouse.clock.ours(theirs_us), nullptr);
    mouse.host_time = receiving_;
    ++mouse.samples;
  } else {
    carried_over(mouse, sample.device_time, nullptr);
  }
  sample.device_time = mouse.device_time;
  sample.host_time = receiving_;
}

/// @param held_to  what tells this clock from others that the session's may be held to
Time LcmSource::carried_over(Publisher& publisher, Time theirs, const void* held_to) {
  constexpr double kJump_us = 1e6;
  const auto theirs_us = static_cast<double>(theirs.count());
  const auto seen_us = static_cast<double>(receiving_.count());
  bool jumped = false;
  if (publisher.clock.started() && std::abs(seen_us - publisher.clock.ours(theirs_us)) > kJump_us) {
    publisher.clock = {};
    ++counts_.clock_jumps;
    jumped = true;
  }
  const bool first = publisher.samples++ == 0 || jumped;
  Time ours = held(theirs, publisher.clock.carry_over(theirs_us, seen_us), held_to);
  // What they measured later is later for us too, whatever was learnt of their clock.
  if (!first && theirs > publisher.theirs) ours = std::max(ours, publisher.device_time + Time{1});
  publisher.theirs = theirs;
  publisher.device_time = ours;
  publisher.host_time = receiving_;
  return ours;
}

/// @param ours_us  what is estimated for it
Time LcmSource::held(Time theirs, double ours_us, const void* held_to) const {
  if (!genlock_) return Time{std::llround(ours_us)};
  const double estimated_us = ours_us - static_cast<double>(theirs.count());
  return theirs + Time{std::llround(genlock_->offset_us(held_to, estimated_us))};
}

void LcmSource::poll(Time now, std::vector<Sample>& out) {
  receive(now);
  polled_ = std::max(polled_, now);
  std::ranges::stable_sort(waiting_, {}, available);
  for (; !waiting_.empty() && available(waiting_.front()) <= now; waiting_.pop_front()) {
    out.push_back(std::move(waiting_.front()));
  }
}

}  // namespace headpin::devices
