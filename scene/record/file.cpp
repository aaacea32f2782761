#include "scene/record/file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/base/sequence_count.h"
#include "devices/base/sources.h"
#include "devices/log/event_log.h"
#include "scene/record/doubled.h"
#include "scene/record/events.h"
#include "scene/record/messages.h"
#include "scene/record/misdated.h"
#include "scene/record/state_change.h"
#include "scene/record/trial_messages.h"

namespace headpin::scene {
namespace {

/// Whether the log also contains the trial that a session published, besides its inputs.
bool holds_session(devices::LogReader reader) {
  const std::string header = std::string(kSessionPrefix) + std::string(kTrialChannel);
  while (const std::optional<devices::LogEvent> event = reader.next()) {
    if (event->channel == header) return true;
  }
  return false;
}

}  // namespace

std::string what_is_missing(const TrialSummary& trial) {
  const Skipped& skipped = trial.skipped;
  const std::int64_t messages =
      skipped.undecodable + skipped.implausible + skipped.baseless + skipped.misdated;
  const auto counted = [](std::int64_t n, const char* unit) {
    return fmt::format("{} {}{}", n, unit, n == 1 ? "" : "s");
  };
  std::vector<std::string> said;
  if (!trial.complete) {
    std::vector<std::string> unread;
    if (messages > 0) unread.push_back(counted(messages, "message"));
    if (const auto n = skipped.bytes + skipped.cut_bytes; n > 0)
      unread.push_back(counted(n, "byte"));
    said.push_back(
        fmt::format("is incomplete: it ends at {:.3f} s", seconds(trial.last.value_or(Time{}))));
    if (!unread.empty()) {
      said.push_back(fmt::format("{} of it cannot be read", fmt::join(unread, " and ")));
    }
  } else if (messages > 0) {
    said.push_back(fmt::format("is complete, but {} in it {} wrong and not used",
                               counted(messages, "message"), messages == 1 ? "is" : "are"));
  }
  if (skipped.other_trials > 0) {
    said.push_back("the file has another trial after it, which is not read");
  }
  return fmt::format("{}", fmt::join(said, "; "));
}

struct LogContent {
  std::string path;
  std::unique_ptr<devices::FileWindow> file = {};  // or else
  std::span<const std::uint8_t> bytes = {};        // all of it
  bool session = false;
  std::vector<std::int64_t> misdated = {}, doubled = {};  // numbers of messages

  devices::LogReader reader() const {
    return file ? devices::LogReader(*file) : devices::LogReader(bytes);
  }
  Messages messages() const { return {reader(), session, doubled}; }
};

/// Iterates over a trial without its misdated messages.
class TrialWalk {
 public:
  /// @param summary  of an earlier walk, whose samples must still be there; null for the first walk
  TrialWalk(const LogContent& content, const TrialSummary* summary)
      : content_(content),
        messages_(content.messages()),
        expected_(summary ? std::optional(summary->sample_count) : std::nullopt) {}

  std::optional<Message> next() {
    while (std::optional<Message> message = messages_.next()) {
      if (std::holds_alternative<Snapshot>(*message)) continue;
      const bool misdated = is_misdated();
      if (!make_whole(*message, misdated)) continue;
      if (misdated) {
        ++counted().skipped.misdated;
        note("misdated", name_of(*message));
        continue;
      }
      if (const auto* state = std::get_if<TickState>(&*message)) tick_ = state->time;
      if (auto* tracker = std::get_if<devices::TrackerSample>(&*message)) date(*tracker);
      if (auto* mouse = std::get_if<devices::MouseSample>(&*message)) date(*mouse);
      return message;
    }
    if (expected_ && samples_ != *expected_) {
      throw std::runtime_error(content_.path + ": was changed while it was read");
    }
    return std::nullopt;
  }

  void note(const char* kind, const std::string& of, std::int64_t messages = 1) {
    note_trouble(counted(), kind, of, since_first(), messages);
  }
  Time since_first() const { return messages_.since_first(); }
  TrialSummary& counted() { return messages_.counted(); }

 private:
  /// Replaces a change by the state that results from it; false if there is none.
  bool make_whole(Message& message, bool misdated) {
    const auto meant = [&](std::int64_t tick) {
      return misdated ? states_.next_tick().value_or(tick) : tick;
    };
    if (auto* whole = std::get_if<TickState>(&message)) {
      whole->tick = meant(whole->tick);
      states_.begin(*whole);
    }
    auto* change = std::get_if<StateChange>(&message);
    if (!change) return true;
    change->tick = meant(change->tick);
    tick_ = misdated ? tick_ : change->time;
    const TickState* state = states_.go_on(*change);
    if (state && plausible(*state)) {
      message = *state;
      return true;
    }
    states_.forget();
    ++(state ? counted().skipped.implausible : counted().skipped.baseless);
    note(state ? "implausible" : "baseless", std::string(kStateChangeChannel));
    return false;
  }
  bool is_misdated() {
    const std::vector<std::int64_t>& all = content_.misdated;
    if (next_misdated_ == all.size() || all[next_misdated_] != messages_.number()) return false;
    ++next_misdated_;
    return true;
  }
  static std::string name_of(const Message& message) {
    if (const auto* tracker = std::get_if<devices::TrackerSample>(&message)) {
      return devices::device_name(devices::device_at(tracker->station));
    }
    return std::holds_alternative<devices::MouseSample>(message)
               ? devices::device_name(devices::Device::mouse)
               : std::string(kStateChannel);
  }
  /// Usual time between a sample's first byte and its use: the rest of the sample on a slow line,
  /// and a poll. This is not a fault.
  static constexpr Time kUsuallyLate{50'000};

  /// Sets the session time of a sample that follows a state: that state did not include it.
  template <typename T>
  void date(T& sample) {
    ++samples_;
    if (!tick_) return;
    if (devices::arrival(devices::Sample(sample)) + kUsuallyLate <= *tick_) {
      ++counted().late;
      note("late", devices::device_name(devices::device_of(sample)));
    }
    if (devices::available(devices::Sample(sample)) <= *tick_)
      sample.session_time = *tick_ + Time{1};
  }

  const LogContent& content_;
  Messages messages_;
  std::optional<std::int64_t> expected_;  // number of samples
  std::size_t next_misdated_ = 0;
  std::optional<Time> tick_;  // of the last state
  StateHistory states_;
  std::int64_t samples_ = 0;
};

namespace {

/// Finds positions that jump away from those around them, and back.
class AstrayFinder {
 public:
  /// @param at  time of the message in the log
  /// @return    the time of the message before this one, if its sample was astray
  std::optional<Time> take(const devices::TrackerSample& sample, Time at) {
    const Stamped<Vec3> now{sample.device_time, sample.X_TS.p};
    const bool astray = before_ && last_ && far_apart(*before_, *last_) && far_apart(*last_, now) &&
                        !far_apart(*before_, now);
    if (!astray) before_ = last_;
    last_ = now;
    const Time last_at = std::exchange(last_at_, at);
    return astray ? std::optional(last_at) : std::nullopt;
  }

 private:
  /// Whether two positions are further apart than a hand and a receiver's noise allow.
  static bool far_apart(const Stamped<Vec3>& a, const Stamped<Vec3>& b) {
    constexpr double kFastest = 50.0, kNoise = 0.1;  // m/s, m
    const double passed = std::abs(seconds(b.time - a.time));
    return !((b.value - a.value).norm() <= kFastest * passed + kNoise);
  }

  std::optional<Stamped<Vec3>> before_, last_;
  Time last_at_{};
};

/// Adds samples to a summary.
class Summing {
 public:
  explicit Summing(TrialSummary& into) : into_(into) {}

  /// Faults of earlier samples that a sample shows.
  struct Found {
    std::int64_t lost = 0;            ///< missing just before it; -1: it was a missing one
    std::optional<Time> astray = {};  ///< the one before it: time of its message in the log
  };
  /// @param at  time of its message in the log
  Found take(const devices::Sample& sample, Time at) {
    ++into_.sample_count;
    const Time time = devices::device_time(sample);
    cover(time);
    DeviceSummary& d = into_.devices[devices::device_of(sample)];
    if (d.samples++ == 0) {
      d.first = d.last = time;
    } else if (time <= last_time_[devices::device_of(sample)]) {
      ++into_.backwards;
    }
    last_time_[devices::device_of(sample)] = time;
    d.longest_gap = std::max(d.longest_gap, time - d.last);
    d.last = std::max(d.last, time);
    take_availability(devices::available(sample));
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    return tracker ? count(d, *tracker, at) : Found{};
  }
  void take(const TickState& state) {
    ++into_.state_count;
    cover(state.time);
    into_.last_tick = state.tick;
    into_.bodies = state.bodies.size();
  }
  void take(const FrameRecord& frame) {
    ++into_.frame_count;
    cover(frame.time);
  }

  /// For samples in the order in which they are available.
  static void extend(Gap& longest, Time& last, Time time) {
    if (time - last > longest.length()) longest = {last, time};
    last = time;
  }

 private:
  void cover(Time time) {
    into_.first = std::min(into_.first.value_or(time), time);
    into_.last = std::max(into_.last.value_or(time), time);
  }
  void take_availability(Time time) {
    if (into_.sample_count > 1) into_.disorder = std::max(into_.disorder, into_.end - time);
    into_.end = into_.sample_count > 1 ? std::max(into_.end, time) : time;
    extend(into_.longest_gap, last_available_, time);
  }
  Found count(DeviceSummary& d, const devices::TrackerSample& sample, Time at) {
    const Found found{numbers_[sample.station].take(sample.sequence, sample.device_time),
                      places_[sample.station].take(sample, at)};
    d.lost += found.lost;
    d.astray += found.astray.has_value();
    d.bad += !sample.good();
    d.estimated += sample.good() && sample.position_estimated;
    return found;
  }

  TrialSummary& into_;
  Time last_available_{};
  std::map<devices::Device, Time> last_time_;
  std::map<std::int32_t, devices::SequenceCount> numbers_;
  std::map<std::int32_t, AstrayFinder> places_;
};

/// The sample in a message, if it is one.
std::optional<devices::Sample> sample_of(Message& message) {
  if (auto* tracker = std::get_if<devices::TrackerSample>(&message))
    return devices::Sample(std::move(*tracker));
  if (auto* mouse = std::get_if<devices::MouseSample>(&message)) return devices::Sample(*mouse);
  return std::nullopt;
}

/// Whether a log without events is empty or ends within its first one.
bool has_not_begun(const TrialSummary& log, std::size_t bytes) {
  return bytes == 0 || log.skipped.cut_bytes >= 4;
}

}  // namespace

std::string why_without_events(const TrialSummary& log, std::size_t bytes) {
  const std::string none = "no whole event in " + std::to_string(bytes) + " bytes";
  if (bytes == 0) return "is empty; expected an LCM event log";
  if (has_not_begun(log, bytes)) return "is cut short within its first event: " + none;
  return "not an LCM event log: " + none;
}

namespace {

std::unique_ptr<const LogContent> look_into(LogContent log) {
  log.session = holds_session(log.reader());
  Misdated misdated = find_misdated(log.messages());
  if (misdated.goes_back) log.doubled = find_doubled(log.messages());
  if (!log.doubled.empty()) misdated = find_misdated(log.messages());
  log.misdated = std::move(misdated.messages);
  return std::make_unique<const LogContent>(std::move(log));
}

/// The summary of one walk through a log, in the order of its messages.
TrialSummary sum_up(const LogContent& log) {
  TrialWalk walk(log, nullptr);
  TrialSummary& all = walk.counted();
  Summing summing(all);
  while (std::optional<Message> message = walk.next()) {
    if (const auto sample = sample_of(*message)) {
      const Summing::Found found = summing.take(*sample, walk.since_first());
      const std::string device = devices::device_name(devices::device_of(*sample));
      if (found.lost != 0) walk.note("lost", device, found.lost);
      if (found.astray) note_trouble(all, "astray", device, *found.astray, 1);
    } else if (auto* event = std::get_if<Event>(&*message)) {
      if (event->kind == kind::session_end)
        all.session_end = std::max(all.session_end, event->time);
      all.events.push_back(std::move(*event));
    } else if (const auto* state = std::get_if<TickState>(&*message)) {
      summing.take(*state);
    } else if (const auto* frame = std::get_if<FrameRecord>(&*message)) {
      summing.take(*frame);
    }
  }
  return std::move(all);
}

}  // namespace

TrialSummary summarise(const LogContent& log) {
  TrialSummary summary = sum_up(log);
  if (summary.disorder != Time{}) {
    Gap longest;  // of samples in order
    Time last{};
    TrialPlayer player(log, summary, {});
    std::vector<devices::Sample> samples;
    while (const std::optional<Time> time = player.next_time()) {
      samples.clear();
      player.poll(*time, samples);
      Summing::extend(longest, last, *time);
    }
    summary.longest_gap = longest;
  }
  Time last = summary.end;
  Summing::extend(summary.longest_gap, last, summary.session_end);
  return summary;
}

TrialFile::TrialFile(const std::string& path)
    : content_(look_into({.path = path, .file = std::make_unique<devices::FileWindow>(path)})),
      summary_(summarise(*content_)) {
  if (summary_.channels.empty()) {
    const std::size_t bytes = content_->file->size();
    const std::string why = path + ": " + why_without_events(summary_, bytes);
    if (has_not_begun(summary_, bytes)) throw NotBegun(why);
    throw std::runtime_error(why);
  }
}

TrialFile::TrialFile(std::span<const std::uint8_t> bytes)
    : content_(look_into({.path = "log", .bytes = bytes})), summary_(summarise(*content_)) {}

TrialFile::~TrialFile() = default;
TrialFile::TrialFile(TrialFile&&) noexcept = default;
TrialFile& TrialFile::operator=(TrialFile&&) noexcept = default;

void TrialFile::require_trial(Time longest_gap) const {
  const TrialSummary& trial = summary();
  const std::string& path = content_->path;
  if (!trial.has_header) {
    std::string found;
    for (const auto& [name, channel] : trial.channels) found += (found.empty() ? "" : ", ") + name;
    throw std::runtime_error(path + ": no message on " + std::string(kTrialChannel) +
                             " that describes the trial; found " + found);
  }
  const std::int32_t format = trial.header.format_version;
  if (format < kFormatVersion || format > kChangesFormatVersion) {
    throw std::runtime_error(fmt::format("{}: trial of format version {}, expected {} to {}", path,
                                         format, kFormatVersion, kChangesFormatVersion));
  }
  if (const Gap& gap = trial.longest_gap; gap.length() > longest_gap) {
    const bool at_end = trial.session_end > trial.end && gap.to == trial.session_end;
    throw LongGap(
        fmt::format("{}: no sample for {:.3f} s, from {:.3f} s {}; expected {:g} s at most", path,
                    seconds(gap.length()), seconds(gap.from),
                    at_end ? "to the end of the session" : "on", seconds(longest_gap)));
  }
}

std::optional<Snapshot> TrialFile::last_snapshot(Time at) const {
  std::optional<Snapshot> last;
  Messages messages(content_->reader(), content_->session);
  while (std::optional<Message> message = messages.next()) {
    auto* snapshot = std::get_if<Snapshot>(&*message);
    if (snapshot && snapshot->time <= at) last = std::move(*snapshot);
  }
  return last;
}

void TrialFile::walk(const std::function<bool(Item&)>& see) const {
  TrialItems items(*this);
  while (std::optional<Item> item = items.next()) {
    if (!see(*item)) return;
  }
}

TrialItems::TrialItems(const TrialFile& file) : TrialItems(*file.content_, file.summary_) {}
TrialItems::TrialItems(const LogContent& log, const TrialSummary& summary)
    : walk_(std::make_unique<TrialWalk>(log, &summary)) {}
TrialItems::~TrialItems() = default;
TrialItems::TrialItems(TrialItems&&) noexcept = default;
TrialItems& TrialItems::operator=(TrialItems&&) noexcept = default;

std::optional<TrialFile::Item> TrialItems::next() {
  while (std::optional<Message> message = walk_->next()) {
    if (auto sample = sample_of(*message)) return TrialFile::Item(std::move(*sample));
    if (auto* state = std::get_if<TickState>(&*message)) return TrialFile::Item(std::move(*state));
    if (const auto* frame = std::get_if<FrameRecord>(&*message)) return TrialFile::Item(*frame);
  }
  return std::nullopt;
}

std::optional<TickState> TrialItems::next_state() {
  while (std::optional<TrialFile::Item> item = next()) {
    if (auto* state = std::get_if<TickState>(&*item)) return std::move(*state);
  }
  return std::nullopt;
}

TrialPlayer::TrialPlayer(const TrialFile& file, Beside beside)
    : TrialPlayer(*file.content_, file.summary_, beside) {}

TrialPlayer::TrialPlayer(const LogContent& log, const TrialSummary& summary, Beside beside)
    : items_(log, summary), complete_(summary.complete), disorder_(summary.disorder) {
  if (beside.states) states_.left = summary.state_count;
  if (beside.frames) frames_.left = summary.frame_count;
}

void TrialPlayer::poll(Time now, std::vector<devices::Sample>& out) {
  while (!ended_ && (!newest_ || *newest_ - disorder_ <= now)) read();
  for (; !samples_.empty() && samples_.begin()->first <= now; samples_.erase(samples_.begin())) {
    out.push_back(std::move(samples_.begin()->second));
  }
}

std::optional<Time> TrialPlayer::next_time() {
  while (!ended_ && (samples_.empty() || *newest_ - disorder_ <= samples_.begin()->first)) read();
  return samples_.empty() ? std::nullopt : std::optional(samples_.begin()->first);
}

/// Reads the next sample, state or frame.
void TrialPlayer::read() {
  std::optional<TrialFile::Item> item = items_.next();
  if (!item) {
    ended_ = true;
    return;
  }
  if (auto* sample = std::get_if<devices::Sample>(&*item)) {
    const Time time = devices::available(*sample);
    newest_ = std::max(newest_.value_or(time), time);
    samples_.emplace(time, std::move(*sample));
  } else if (auto* state = std::get_if<TickState>(&*item); state && states_.left > 0) {
    --states_.left;
    states_.read.push_back(std::move(*state));
  } else if (const auto* frame = std::get_if<FrameRecord>(&*item); frame && frames_.left > 0) {
    --frames_.left;
    frames_.read.push_back(*frame);
  }
}

template <typename T>
const T* TrialPlayer::find(Row<T>& row, std::int64_t tick) {
  for (;;) {
    while (!row.read.empty() && row.read.front().tick < tick) row.read.pop_front();
    if (!row.read.empty()) return row.read.front().tick == tick ? &row.read.front() : nullptr;
    if (row.left == 0 || ended_) return nullptr;
    read();
  }
}

template const TickState* TrialPlayer::find(Row<TickState>&, std::int64_t);

std::optional<FrameRecord> TrialPlayer::next_frame(std::int64_t tick) {
  const FrameRecord* found = find(frames_, tick);
  if (!found) return std::nullopt;
  const FrameRecord frame = *found;
  frames_.read.pop_front();
  return frame;
}

}  // namespace headpin::scene
