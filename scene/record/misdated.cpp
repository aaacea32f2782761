#include "scene/record/misdated.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <deque>
#include <map>
#include <optional>
#include <utility>

namespace headpin::scene {
namespace {

/// Times of one kind: of a device, or of the states, which have one kind.
struct Clock {
  std::optional<devices::Device> device = {};  ///< nothing: the states
  std::size_t kind = 0;                        ///< of sample_times(); 0: device_time

  bool operator==(const Clock&) const = default;
  bool operator<(const Clock& other) const {  // em++'s std::optional has no <=>
    return device != other.device ? device < other.device : kind < other.kind;
  }
};

/// A first or last value of a clock that jumps: only other clocks show whether it is wrong, or whether it is
/// the log's stamps that jump there.
struct Doubt {
  Clock clock;
  std::int64_t message;   ///< of the value
  std::int64_t from, to;  ///< messages between which the jump is
  double jump;            ///< [s]
};

constexpr double kMostJump_s = 1.0;
/// A log may tell of thousands of devices: further doubts are as those that nothing settles.
constexpr std::size_t kMostDoubts = 64;

/// Finds numbers of a sequence that jump away from their neighbours and back.
class LoneFinder {
 public:
  /// @param most    largest difference of neighbours
  /// @param fewest  smallest number of values that shows which of them is wrong
  /// @param found   gets the messages of the wrong values
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found)
      : most_(most), fewest_(fewest), found_(&found) {}
  /// @param doubts  gets the first and the last value where they jump; `found` does not
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found, Clock clock,
             std::vector<Doubt>& doubts)
      : most_(most), fewest_(fewest), found_(&found), clock_(clock), doubts_(&doubts) {}

  /// @param told  the time of the value, where it may come late
  void add(std::int64_t message, double value, std::optional<Time> told = {}) {
    row_.push_back({message, value, told});
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
    std::optional<Time> told;
  };

  bool differ(const Entry& a, const Entry& b) const { return std::abs(a.value - b.value) > most_; }

  /// Whether one of the next few values continues from the value before.
  bool comes_back() const {
    const std::size_t end = std::min(row_.size(), 1 + kAhead);
    for (std::size_t k = 1; k < end; ++k) {
      if (!differ(*before_, row_[k])) return true;
    }
    return end == 1;  // no later value confirms it
  }

  /// The first value has none before it. It is wrong if the values after it agree with each other.
  bool first_is_wrong() const {
    return row_.size() > 2 && differ(row_[0], row_[1]) && differ(row_[0], row_[2]) &&
           !differ(row_[1], row_[2]);
  }

  /// Whether the first value is behind as on a line that stood still: its time lies between those of
  /// its neighbours.
  bool is_late() const {
    const Entry& one = row_[0];
    if (!one.told || !told_ || one.value > before_->value) return false;
    return *told_ <= *one.told && (row_.size() == 1 || *one.told <= *row_[1].told);
  }

  void judge() {
    const bool jumps = before_ ? differ(*before_, row_[0]) && comes_back() : first_is_wrong();
    const bool late = jumps && before_ && is_late();
    if (!jumps || late) told_ = row_[0].told;
    if (jumps && !late) {
      tell();
      if (!before_) before_ = row_[1];
    } else if (!jumps) {
      before_ = row_[0];
    }
    row_.pop_front();
  }

  void tell() {
    const Entry& one = row_[0];
    if (!doubts_ || (before_ && row_.size() > 1)) {
      found_->push_back(one.message);
    } else if (before_) {
      doubt({clock_, one.message, before_->message, one.message, one.value - before_->value});
    } else {
      doubt({clock_, one.message, one.message, row_[2].message, one.value - row_[1].value});
    }
  }

  /// Times of one message that jump alike are one doubt.
  void doubt(const Doubt& one) {
    const auto is_same = [&](const Doubt& other) {
      return other.message == one.message && other.from == one.from && other.to == one.to &&
             std::abs(other.jump - one.jump) <= kMostJump_s;
    };
    if (doubts_->size() < kMostDoubts && std::ranges::none_of(*doubts_, is_same))
      doubts_->push_back(one);
  }

  double most_;
  std::size_t fewest_, count_ = 0;
  std::vector<std::int64_t>* found_;
  Clock clock_;
  std::vector<Doubt>* doubts_ = nullptr;
  std::deque<Entry> row_;
  std::optional<Entry> before_;  // the last one that was right and not late
  std::optional<Time> told_;     // of the last one that was right
};

/// Calls see(kind, ahead) for each time that a sample has, with how far it is ahead of the log's stamp [s].
template <typename Sample, typename See>
void sample_times(const Sample& sample, Time stamp, const See& see) {
  const std::array all = {sample.device_time, sample.host_time, sample.session_time};
  for (std::size_t kind = 0; kind < all.size(); ++kind) {
    if (kind == 0 || all[kind] != Time{}) see(kind, seconds(all[kind] - stamp));
  }
}

/// A value of a clock [s], and its message.
struct Reading {
  std::int64_t message;
  double value;
};
using Readings = std::map<Clock, std::vector<Reading>>;

/// What may settle doubts: device_time of all devices, the time of the states, and all times of the doubtful
/// devices; each clock's in order of the messages.
Readings readings_for(const std::vector<Doubt>& doubts, Messages messages) {
  Readings out;
  while (const std::optional<Message> message = messages.next()) {
    const Time stamp = messages.stamp();
    const std::int64_t number = messages.number();
    const auto look_at = [&](const auto& sample, devices::Device device) {
      const bool in_doubt = std::ranges::any_of(
          doubts, [&](const Doubt& doubt) { return doubt.clock.device == device; });
      sample_times(sample, stamp, [&](std::size_t kind, double ahead) {
        if (kind == 0 || in_doubt) out[{device, kind}].push_back({number, ahead});
      });
    };
    const auto look_at_state = [&](Time time) {
      out[{}].push_back({number, seconds(time - stamp)});
    };
    if (const auto* tracker = std::get_if<devices::TrackerSample>(&*message))
      look_at(*tracker, devices::device_at(tracker->station));
    if (const auto* mouse = std::get_if<devices::MouseSample>(&*message))
      look_at(*mouse, devices::Device::mouse);
    if (const auto* state = std::get_if<TickState>(&*message)) look_at_state(state->time);
    if (const auto* change = std::get_if<StateChange>(&*message)) look_at_state(change->time);
  }
  return out;
}

/// Difference of the values of a clock around a doubt: the last before, all between, the first after [s].
/// Nothing if there are fewer than two.
std::optional<double> spread_around(const Doubt& doubt, const std::vector<Reading>& clock) {
  auto first = std::ranges::lower_bound(clock, doubt.from, {}, &Reading::message);
  auto last = std::ranges::upper_bound(clock, doubt.to, {}, &Reading::message);
  if (first != clock.begin()) --first;
  if (last != clock.end()) ++last;
  if (last - first < 2) return std::nullopt;
  const auto [least, most] = std::minmax_element(
      first, last, [](const Reading& a, const Reading& b) { return a.value < b.value; });
  return most->value - least->value;
}

/// Whether another clock was there, and none of another device jumped as far. The sample's own other times
/// may be wrong together with the doubtful one.
bool is_wrong(const Doubt& doubt, const Readings& all) {
  bool shown = false;
  for (const auto& [clock, readings] : all) {
    const bool own = clock.device == doubt.clock.device;
    if (clock == doubt.clock || (!own && clock.kind != 0)) continue;
    const std::optional<double> spread = spread_around(doubt, readings);
    if (!spread) continue;
    const bool shared = std::abs(doubt.jump) - *spread <= kMostJump_s;
    if (shared && !own) return false;
    shown = shown || !shared;
  }
  return shown;
}

/// Adds the doubtful messages that are wrong.
void settle(const std::vector<Doubt>& doubts, Messages messages, std::vector<std::int64_t>& found) {
  if (doubts.empty()) return;
  const Readings all = readings_for(doubts, std::move(messages));
  for (const Doubt& doubt : doubts) {
    if (is_wrong(doubt, all)) found.push_back(doubt.message);
  }
}

}  // namespace

Misdated find_misdated(Messages messages) {
  constexpr double kMostTicks = 1000.0;
  constexpr std::size_t kFewest = 8;  // two presses of a button do not show which of them is wrong
  const Messages again = messages;
  Misdated out;
  std::vector<std::int64_t>& found = out.messages;
  std::vector<Doubt> doubts;
  std::map<Clock, LoneFinder> samples;
  std::map<devices::Device, Time> newest;
  std::optional<std::int64_t> last_tick;
  LoneFinder times(kMostJump_s, 1, found, Clock(), doubts), ticks(kMostTicks, 1, found);
  std::int64_t states = 0;
  const auto look_at_state = [&](const auto& state) {
    times.add(messages.number(), seconds(state.time - messages.stamp()));
    ticks.add(messages.number(), static_cast<double>(state.tick - states++));
    out.goes_back = out.goes_back || (last_tick && state.tick <= *last_tick);
    last_tick = std::max(last_tick.value_or(state.tick), state.tick);
  };
  const auto look_at = [&](const auto& sample) {
    const devices::Device device = devices::device_of(devices::Sample(sample));
    const auto [last, first] = newest.try_emplace(device, sample.device_time);
    out.goes_back = out.goes_back || (!first && sample.device_time <= last->second);
    last->second = std::max(last->second, sample.device_time);
    sample_times(sample, messages.stamp(), [&](std::size_t kind, double ahead) {
      const Clock clock{device, kind};
      samples.try_emplace(clock, kMostJump_s, kFewest, found, clock, doubts)
          .first->second.add(messages.number(), ahead,
                             kind == 0 ? std::optional(sample.device_time) : std::nullopt);
    });
  };
  while (const std::optional<Message> message = messages.next()) {
    if (const auto* tracker = std::get_if<devices::TrackerSample>(&*message)) look_at(*tracker);
    if (const auto* mouse = std::get_if<devices::MouseSample>(&*message)) look_at(*mouse);
    if (const auto* state = std::get_if<TickState>(&*message)) look_at_state(*state);
    if (const auto* change = std::get_if<StateChange>(&*message)) look_at_state(*change);
  }
  for (auto& [row, finder] : samples) finder.finish();
  times.finish();
  ticks.finish();
  settle(doubts, again, found);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return out;
}

}  // namespace headpin::scene
