#include "scene/record/misdated.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

namespace headpin::scene {
namespace {

/// The messages of one clock: a device, or nothing for the states.
using Whose = std::optional<devices::Device>;

/// A first or last value of a clock that jumps: only other clocks show whether it is wrong, or whether it is
/// the log's stamps that jump there.
struct Doubt {
  Whose whose;
  std::int64_t message;   ///< of the value
  std::int64_t from, to;  ///< messages between which the jump is
  double jump;            ///< [s]
};

/// Finds numbers of a sequence that jump away from their neighbours and back.
class LoneFinder {
 public:
  /// @param most    largest difference of neighbours
  /// @param fewest  smallest number of values that shows which of them is wrong
  /// @param found   gets the messages of the wrong values
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found)
      : most_(most), fewest_(fewest), found_(&found) {}
  /// @param doubts  gets the first and the last value where they jump; `found` does not
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found, Whose whose,
             std::vector<Doubt>& doubts)
      : most_(most), fewest_(fewest), found_(&found), of_(whose), doubts_(&doubts) {}

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
      const double jump = one.value - before_->value;
      doubts_->push_back({of_, one.message, before_->message, one.message, jump});
    } else {
      const double jump = one.value - row_[1].value;
      doubts_->push_back({of_, one.message, one.message, row_[2].message, jump});
    }
  }

  double most_;
  std::size_t fewest_, count_ = 0;
  std::vector<std::int64_t>* found_;
  Whose of_;
  std::vector<Doubt>* doubts_ = nullptr;
  std::deque<Entry> row_;
  std::optional<Entry> before_;  // the last one that was right and not late
  std::optional<Time> told_;     // of the last one that was right
};

constexpr double kMostJump_s = 1.0;

/// The values of another clock around a doubt: the last before, all between, the first after.
class Witness {
 public:
  void add(const Doubt& doubt, std::int64_t message, double value) {
    if (message < doubt.from) {
      least_ = most_ = value;
      count_ = 1;
      return;
    }
    if (after_) return;
    after_ = message > doubt.to;
    least_ = count_ == 0 ? value : std::min(least_, value);
    most_ = count_ == 0 ? value : std::max(most_, value);
    ++count_;
  }
  bool saw_it() const { return count_ > 1; }
  double spread() const { return most_ - least_; }

 private:
  std::size_t count_ = 0;
  double least_ = 0.0, most_ = 0.0;
  bool after_ = false;
};

/// Whose time a message has, and how far it is ahead of the log's stamp [s].
std::optional<std::pair<Whose, double>> clock_of(const Message& message, Time stamp) {
  const auto of = [&](Whose whose, Time time) {
    return std::optional(std::pair(whose, seconds(time - stamp)));
  };
  if (const auto* tracker = std::get_if<devices::TrackerSample>(&message))
    return of(devices::device_at(tracker->station), tracker->device_time);
  if (const auto* mouse = std::get_if<devices::MouseSample>(&message))
    return of(devices::Device::mouse, mouse->device_time);
  if (const auto* state = std::get_if<TickState>(&message)) return of(Whose(), state->time);
  if (const auto* change = std::get_if<StateChange>(&message)) return of(Whose(), change->time);
  return std::nullopt;
}

/// Adds the doubtful messages that are wrong: another clock was there, and none jumped as far.
void settle(const std::vector<Doubt>& doubts, Messages messages, std::vector<std::int64_t>& found) {
  if (doubts.empty()) return;
  std::vector<std::map<Whose, Witness>> witnesses(doubts.size());
  while (const std::optional<Message> message = messages.next()) {
    const auto clock = clock_of(*message, messages.stamp());
    if (!clock) continue;
    for (std::size_t i = 0; i < doubts.size(); ++i) {
      if (clock->first == doubts[i].whose) continue;
      witnesses[i][clock->first].add(doubts[i], messages.number(), clock->second);
    }
  }
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    bool seen = false, shared = false;
    for (const auto& [whose, witness] : witnesses[i]) {
      if (!witness.saw_it()) continue;
      seen = true;
      shared = shared || std::abs(doubts[i].jump) - witness.spread() <= kMostJump_s;
    }
    if (seen && !shared) found.push_back(doubts[i].message);
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
  std::map<std::pair<devices::Device, std::size_t>, LoneFinder>
      samples;  // each device, all its times
  std::map<devices::Device, Time> newest;
  std::optional<std::int64_t> last_tick;
  LoneFinder times(kMostJump_s, 1, found, Whose(), doubts), ticks(kMostTicks, 1, found);
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
    const std::array all = {sample.device_time, sample.host_time, sample.session_time};
    for (std::size_t kind = 0; kind < all.size(); ++kind) {
      if (kind > 0 && all[kind] == Time{}) continue;  // it has no such time
      samples.try_emplace(std::pair(device, kind), kMostJump_s, kFewest, found, device, doubts)
          .first->second.add(messages.number(), seconds(all[kind] - messages.stamp()),
                             kind == 0 ? std::optional(sample.device_time) : std::nullopt);
    }
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
