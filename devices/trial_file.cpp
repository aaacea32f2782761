#include "devices/trial_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "devices/event_log.h"
#include "devices/messages.h"
#include "devices/sources.h"

namespace headpin::devices {
namespace {

/// Which device a sample is of: the station of a tracker, 0 for the 3D mouse.
std::int32_t device(const Sample& sample) {
  const auto* tracker = std::get_if<TrackerSample>(&sample);
  return tracker ? tracker->station : 0;
}

void note_trouble(TrialSummary& summary, const char* kind, const std::string& of, Time at,
                  std::int64_t messages = 1) {
  constexpr Time kNear{1'000'000};
  const auto last =
      std::find_if(summary.trouble.rbegin(), summary.trouble.rend(),
                   [&](const Trouble& t) { return t.kind == kind && t.device == of; });
  if (last != summary.trouble.rend() && at >= last->from && at - last->to <= kNear) {
    last->to = std::max(last->to, at);
    last->messages += messages;
  } else if (summary.trouble.size() < kMostTroubles) {
    summary.trouble.push_back({kind, of, messages, at, at});
  }
}

/// Finds the numbers of a row that jump away from those around them, and back.
class LoneFinder {
 public:
  /// @param most    that neighbours differ
  /// @param fewest  numbers that tell which of them is wrong
  /// @param found   where the messages they are from are put
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found)
      : most_(most), fewest_(fewest), found_(&found) {}

  void add(std::int64_t message, double value) {
    row_.push_back({message, value});
    ++count_;
    while (count_ >= fewest_ && row_.size() > kAhead) judge();
  }
  void finish() {
    while (count_ >= fewest_ && !row_.empty()) judge();
  }

 private:
  static constexpr std::size_t kAhead = 4;
  struct Entry {
    std::int64_t message;
    double value;
  };

  bool differ(double a, double b) const { return std::abs(a - b) > most_; }

  /// Whether one of the next few goes on where it was before.
  bool comes_back() const {
    const std::size_t end = std::min(row_.size(), 1 + kAhead);
    for (std::size_t k = 1; k < end; ++k) {
      if (!differ(*before_, row_[k].value)) return true;
    }
    return end == 1;  // nothing behind it speaks for it
  }

  /// The first one has nobody before it: it is wrong when those behind it agree with each other.
  bool first_is_wrong() const {
    return row_.size() > 2 && differ(row_[0].value, row_[1].value) &&
           differ(row_[0].value, row_[2].value) && !differ(row_[1].value, row_[2].value);
  }

  void judge() {
    const bool wrong = before_ ? differ(*before_, row_[0].value) && comes_back() : first_is_wrong();
    if (wrong) {
      found_->push_back(row_[0].message);
      if (!before_) before_ = row_[1].value;
    } else {
      before_ = row_[0].value;
    }
    row_.pop_front();
  }

  double most_;
  std::size_t fewest_, count_ = 0;
  std::vector<std::int64_t>* found_;
  std::deque<Entry> row_;
  std::optional<double> before_;  // the last one that was right
};

/// The messages of a trial, one after the other. What cannot be used is passed over and counted.
class Messages {
 public:
  /// @param session  the trial is what a session published, not what it listened to
  Messages(LogReader reader, bool session) : reader_(reader), session_(session) {}

  /// The next sample, event, state or frame, nothing at the end or where another trial begins.
  std::optional<Message> next() {
    while (const std::optional<LogEvent> event = reader_.next()) {
      std::optional<Message> message = take(*event);
      if (over_) break;
      if (message) return message;
    }
    counted_.skipped.bytes = reader_.skipped_bytes();
    counted_.skipped.cut_bytes = reader_.cut_bytes();
    return std::nullopt;
  }

  /// Of the message at hand: its number among all that were taken, and its stamp.
  std::int64_t number() const { return taken_ - 1; }
  Time stamp() const { return stamp_; }
  Time since_first() const { return stamp_ - *first_stamp_; }

  /// Channels, header, what was passed over, and whether the end was there.
  TrialSummary& counted() { return counted_; }

 private:
  std::optional<Message> take(const LogEvent& event) {
    stamp_ = event.time;
    if (!first_stamp_) first_stamp_ = stamp_;
    Channel& channel = counted_.channels[std::string(event.channel)];
    if (++channel.messages == 1) channel.first = event.time;
    channel.last = event.time;
    channel.bytes += static_cast<std::int64_t>(event.data.size());
    std::string_view name = event.channel;
    if (session_) {
      if (!name.starts_with(kSessionPrefix)) return std::nullopt;
      name.remove_prefix(kSessionPrefix.size());
    }
    if (!is_trial_channel(name)) return std::nullopt;

    std::optional<Message> message = decode(name, event.data);
    if (!message || !plausible(*message)) {
      ++(message ? counted_.skipped.implausible : counted_.skipped.undecodable);
      note_trouble(counted_, message ? "implausible" : "undecodable", std::string(name),
                   since_first());
      return std::nullopt;
    }
    if (auto* header = std::get_if<TrialHeader>(&*message)) {
      take(*header);
      return std::nullopt;
    }
    ++taken_;
    if (const auto* last = std::get_if<Event>(&*message); last && last->kind == kEndEvent) {
      counted_.complete = last->value == static_cast<double>(taken_ - 1);
      return std::nullopt;
    }
    if (const auto* tracker = std::get_if<TrackerSample>(&*message);
        tracker && !tracker->in_transmitters_frame()) {
      ++counted_.skipped.foreign;
      note_trouble(counted_, "foreign", device_name(tracker->station), since_first());
      return std::nullopt;
    }
    return message;
  }

  void take(TrialHeader& header) {
    if (!counted_.has_header) {
      counted_.header = std::move(header);
      counted_.has_header = true;
      ++taken_;
    } else if (header != counted_.header) {
      ++counted_.skipped.other_trials;
      over_ = true;
    }
  }

  LogReader reader_;
  bool session_, over_ = false;
  std::int64_t taken_ = 0;
  Time stamp_{};
  std::optional<Time> first_stamp_;
  TrialSummary counted_;
};

constexpr double kMostJump_s = 1.0;

/// Messages whose time, or a state's tick, jumps away from those around it while the log's own
/// stamps go on; in their order.
std::vector<std::int64_t> find_misdated(Messages messages) {
  constexpr double kMostTicks = 1000.0;
  constexpr std::size_t kFewest = 8;  // two presses of a button do not tell which of them is wrong
  std::vector<std::int64_t> found;
  std::map<std::pair<std::int32_t, std::size_t>, LoneFinder> samples;  // each device, all its times
  LoneFinder times(kMostJump_s, 1, found), ticks(kMostTicks, 1, found);
  std::int64_t states = 0;
  const auto look_at = [&](const auto& sample) {
    const std::array all = {sample.device_time, sample.host_time, sample.session_time};
    for (std::size_t kind = 0; kind < all.size(); ++kind) {
      if (kind > 0 && all[kind] == Time{}) continue;  // it has no such time
      samples.try_emplace(std::pair(device(Sample(sample)), kind), kMostJump_s, kFewest, found)
          .first->second.add(messages.number(), seconds(all[kind] - messages.stamp()));
    }
  };
  while (const std::optional<Message> message = messages.next()) {
    if (const auto* tracker = std::get_if<TrackerSample>(&*message)) look_at(*tracker);
    if (const auto* mouse = std::get_if<MouseSample>(&*message)) look_at(*mouse);
    if (const auto* state = std::get_if<TickState>(&*message)) {
      times.add(messages.number(), seconds(state->time - messages.stamp()));
      ticks.add(messages.number(), static_cast<double>(state->tick - states++));
    }
  }
  for (auto& [row, finder] : samples) finder.finish();
  times.finish();
  ticks.finish();
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Whether a session published its own trial here, beside what it listened to.
bool holds_session(LogReader reader) {
  const std::string header = std::string(kSessionPrefix) + std::string(kTrialChannel);
  while (const std::optional<LogEvent> event = reader.next()) {
    if (event->channel == header) return true;
  }
  return false;
}

}  // namespace

std::string device_name(std::int32_t station) {
  if (station == 0) return "3D mouse";
  if (station == kHeadStation) return "head";
  return station == kHandStation ? "right hand" : fmt::format("station {}", station);
}

struct LogContent {
  std::string path;
  std::unique_ptr<FileWindow> file;     // or else
  std::span<const std::uint8_t> bytes;  // all of it
  bool session = false;
  std::vector<std::int64_t> misdated;
  TrialSummary summary;

  LogReader reader() const { return file ? LogReader(*file) : LogReader(bytes); }
  bool looked_through = false;

  void look_through();
};

/// What is left of a trial when its misdated messages are gone.
class TrialWalk {
 public:
  explicit TrialWalk(const LogContent& content)
      : content_(content), messages_(content.reader(), content.session) {}

  std::optional<Message> next() {
    while (std::optional<Message> message = messages_.next()) {
      if (misdated()) {
        ++counted().skipped.misdated;
        note("misdated", device_of(*message));
        continue;
      }
      if (const auto* state = std::get_if<TickState>(&*message)) tick_ = state->time;
      if (auto* tracker = std::get_if<TrackerSample>(&*message)) date(*tracker);
      if (auto* mouse = std::get_if<MouseSample>(&*message)) date(*mouse);
      return message;
    }
    if (content_.looked_through && samples_ != content_.summary.sample_count) {
      throw std::runtime_error(content_.path + ": has been changed while it was read");
    }
    return std::nullopt;
  }

  void note(const char* kind, const std::string& of, std::int64_t messages = 1) {
    note_trouble(counted(), kind, of, messages_.since_first(), messages);
  }
  TrialSummary& counted() { return messages_.counted(); }

 private:
  bool misdated() {
    const std::vector<std::int64_t>& all = content_.misdated;
    if (next_misdated_ == all.size() || all[next_misdated_] != messages_.number()) return false;
    ++next_misdated_;
    return true;
  }
  static std::string device_of(const Message& message) {
    if (const auto* tracker = std::get_if<TrackerSample>(&message)) {
      return device_name(tracker->station);
    }
    return std::holds_alternative<MouseSample>(message) ? device_name(0)
                                                        : std::string(kStateChannel);
  }
  /// A sample that stands behind a state was not known to it.
  template <typename T>
  void date(T& sample) {
    ++samples_;
    if (!tick_) return;
    if (arrival(Sample(sample)) <= *tick_) {
      ++counted().late;
      note("late", device_of(sample));
    }
    if (available(Sample(sample)) <= *tick_) sample.session_time = *tick_ + Time{1};
  }

  const LogContent& content_;
  Messages messages_;
  std::size_t next_misdated_ = 0;
  std::optional<Time> tick_;  // of the last state
  std::int64_t samples_ = 0;
};

namespace {

/// Sums up what comes by.
class Summing {
 public:
  explicit Summing(TrialSummary& into) : into_(into) {}

  /// @return  samples of the device that were lost just before this one
  std::int64_t take(const Sample& sample) {
    ++into_.sample_count;
    const Time time = device_time(sample);
    cover(time);
    DeviceSummary& d = into_.devices[device(sample)];
    if (d.samples++ == 0) {
      d.first = d.last = time;
    } else if (time <= last_time_[device(sample)]) {
      ++into_.backwards;
    }
    last_time_[device(sample)] = time;
    d.longest_gap = std::max(d.longest_gap, time - d.last);
    d.last = std::max(d.last, time);
    take_availability(available(sample));
    const auto* tracker = std::get_if<TrackerSample>(&sample);
    return tracker ? count(d, *tracker) : 0;
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
  std::int64_t count(DeviceSummary& d, const TrackerSample& sample) {
    std::int64_t& sequence =
        sequence_.try_emplace(sample.station, sample.sequence - 1).first->second;
    const std::int64_t lost = std::max<std::int64_t>(0, sample.sequence - sequence - 1);
    sequence = sample.sequence;
    d.lost += lost;
    d.bad += !sample.good();
    return lost;
  }

  TrialSummary& into_;
  Time last_available_{};
  std::map<std::int32_t, Time> last_time_;
  std::map<std::int32_t, std::int64_t> sequence_;
};

/// The sample that a message is.
std::optional<Sample> sample_of(Message& message) {
  if (auto* tracker = std::get_if<TrackerSample>(&message)) return Sample(std::move(*tracker));
  if (auto* mouse = std::get_if<MouseSample>(&message)) return Sample(*mouse);
  return std::nullopt;
}

}  // namespace

TrialFile::TrialFile(const std::string& path) : content_(std::make_unique<LogContent>()) {
  content_->path = path;
  content_->file = std::make_unique<FileWindow>(path);
  look_through();
  if (content_->summary.channels.empty()) {
    throw std::runtime_error(path + ": not an LCM event log: no whole event in " +
                             std::to_string(content_->file->size()) + " bytes");
  }
}

TrialFile::TrialFile(std::span<const std::uint8_t> bytes)
    : content_(std::make_unique<LogContent>()) {
  content_->path = "log";
  content_->bytes = bytes;
  look_through();
}

TrialFile::~TrialFile() = default;
TrialFile::TrialFile(TrialFile&&) noexcept = default;
TrialFile& TrialFile::operator=(TrialFile&&) noexcept = default;

void LogContent::look_through() {
  session = holds_session(reader());
  misdated = find_misdated(Messages(reader(), session));
  TrialWalk walk(*this);
  TrialSummary& all = walk.counted();
  Summing summing(all);
  while (std::optional<Message> message = walk.next()) {
    if (const auto sample = sample_of(*message)) {
      if (const std::int64_t lost = summing.take(*sample)) {
        walk.note("lost", device_name(device(*sample)), lost);
      }
    } else if (auto* event = std::get_if<Event>(&*message)) {
      all.events.push_back(std::move(*event));
    } else if (const auto* state = std::get_if<TickState>(&*message)) {
      summing.take(*state);
    } else if (const auto* frame = std::get_if<FrameRecord>(&*message)) {
      summing.take(*frame);
    }
  }
  summary = std::move(all);
  looked_through = true;
}

void TrialFile::look_through() {
  content_->look_through();
  if (content_->summary.disorder == Time{}) return;
  Gap longest;  // of samples in order
  Time last{};
  TrialPlayer player(*this);
  std::vector<Sample> samples;
  while (const std::optional<Time> time = player.next_time()) {
    samples.clear();
    player.poll(*time, samples);
    Summing::extend(longest, last, *time);
  }
  content_->summary.longest_gap = longest;
}

const TrialSummary& TrialFile::summary() const {
  return content_->summary;
}

void TrialFile::require_trial(Time longest_gap) const {
  const TrialSummary& trial = summary();
  const std::string& path = content_->path;
  if (!trial.has_header) {
    std::string found;
    for (const auto& [name, channel] : trial.channels) found += (found.empty() ? "" : ", ") + name;
    throw std::runtime_error(path + ": no message on " + std::string(kTrialChannel) +
                             " to say which trial this is; found " + found);
  }
  if (trial.header.format_version != kFormatVersion) {
    throw std::runtime_error(path + ": trial of format version " +
                             std::to_string(trial.header.format_version) + ", expected " +
                             std::to_string(kFormatVersion));
  }
  if (const Gap& gap = trial.longest_gap; gap.length() > longest_gap) {
    throw std::runtime_error(
        fmt::format("{}: no sample for {:.1f} s, from {:.3f} s on; expected {:.0f} s at most (if "
                    "that is meant: "
                    "--longest-gap)",
                    path, seconds(gap.length()), seconds(gap.from), seconds(longest_gap)));
  }
}

void TrialFile::walk(const std::function<bool(Item&)>& see) const {
  TrialWalk walk(*content_);
  while (std::optional<Message> message = walk.next()) {
    Item item;
    if (auto sample = sample_of(*message)) {
      item = std::move(*sample);
    } else if (auto* state = std::get_if<TickState>(&*message)) {
      item = std::move(*state);
    } else if (const auto* frame = std::get_if<FrameRecord>(&*message)) {
      item = *frame;
    } else {
      continue;
    }
    if (!see(item)) return;
  }
}

TrialPlayer::TrialPlayer(const TrialFile& file, Beside beside)
    : walk_(std::make_unique<TrialWalk>(*file.content_)), disorder_(file.summary().disorder) {
  if (beside.states) states_.left = file.summary().state_count;
  if (beside.frames) frames_.left = file.summary().frame_count;
}

TrialPlayer::~TrialPlayer() = default;

void TrialPlayer::poll(Time now, std::vector<Sample>& out) {
  while (!ended_ && (!newest_ || *newest_ - disorder_ <= now)) read();
  for (; !samples_.empty() && samples_.begin()->first <= now; samples_.erase(samples_.begin())) {
    out.push_back(std::move(samples_.begin()->second));
  }
}

std::optional<Time> TrialPlayer::next_time() {
  while (!ended_ && (samples_.empty() || *newest_ - disorder_ <= samples_.begin()->first)) read();
  return samples_.empty() ? std::nullopt : std::optional(samples_.begin()->first);
}

/// Takes in the next message.
void TrialPlayer::read() {
  std::optional<Message> message = walk_->next();
  if (!message) {
    ended_ = true;
    return;
  }
  if (auto sample = sample_of(*message)) {
    const Time time = available(*sample);
    newest_ = std::max(newest_.value_or(time), time);
    samples_.emplace(time, std::move(*sample));
  } else if (auto* state = std::get_if<TickState>(&*message); state && states_.left > 0) {
    --states_.left;
    states_.read.push_back(std::move(*state));
  } else if (const auto* frame = std::get_if<FrameRecord>(&*message); frame && frames_.left > 0) {
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
template const FrameRecord* TrialPlayer::find(Row<FrameRecord>&, std::int64_t);

}  // namespace headpin::devices
