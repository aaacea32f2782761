#include "scene/record/misdated.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <tuple>

namespace headpin::scene {
namespace {

/// Finds numbers of a sequence that jump away from their neighbours and back.
class LoneFinder {
 public:
  /// @param most    largest difference of neighbours
  /// @param fewest  smallest number of values that shows which of them is wrong
  /// @param found   gets the messages of the wrong values
  LoneFinder(double most, std::size_t fewest, std::vector<std::int64_t>& found)
      : most_(most), fewest_(fewest), found_(&found) {}

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

  bool differ(double a, double b) const { return std::abs(a - b) > most_; }

  /// Whether one of the next few values continues from the value before.
  bool comes_back() const {
    const std::size_t end = std::min(row_.size(), 1 + kAhead);
    for (std::size_t k = 1; k < end; ++k) {
      if (!differ(*before_, row_[k].value)) return true;
    }
    return end == 1;  // no later value confirms it
  }

  /// The first value has none before it. It is wrong if the values after it agree with each other.
  bool first_is_wrong() const {
    return row_.size() > 2 && differ(row_[0].value, row_[1].value) &&
           differ(row_[0].value, row_[2].value) && !differ(row_[1].value, row_[2].value);
  }

  /// Whether the first value is behind as on a line that stood still: its time lies between those of
  /// its neighbours.
  bool is_late() const {
    const Entry& one = row_[0];
    if (!one.told || !told_ || one.value > *before_) return false;
    return *told_ <= *one.told && (row_.size() == 1 || *one.told <= *row_[1].told);
  }

  void judge() {
    const bool jumps = before_ ? differ(*before_, row_[0].value) && comes_back() : first_is_wrong();
    const bool late = jumps && before_ && is_late();
    if (!jumps || late) told_ = row_[0].told;
    if (jumps && !late) {
      found_->push_back(row_[0].message);
      if (!before_) before_ = row_[1].value;
    } else if (!jumps) {
      before_ = row_[0].value;
    }
    row_.pop_front();
  }

  double most_;
  std::size_t fewest_, count_ = 0;
  std::vector<std::int64_t>* found_;
  std::deque<Entry> row_;
  std::optional<double> before_;  // the last one that was right and not late
  std::optional<Time> told_;      // of the last one that was right
};

constexpr double kMostJump_s = 1.0;

}  // namespace

Misdated find_misdated(Messages messages) {
  constexpr double kMostTicks = 1000.0;
  constexpr std::size_t kFewest = 8;  // two presses of a button do not show which of them is wrong
  Misdated out;
  std::vector<std::int64_t>& found = out.messages;
  std::map<std::pair<devices::Device, std::size_t>, LoneFinder>
      samples;  // each device, all its times
  std::map<devices::Device, Time> newest;
  std::optional<std::int64_t> last_tick;
  LoneFinder times(kMostJump_s, 1, found), ticks(kMostTicks, 1, found);
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
      samples.try_emplace(std::pair(device, kind), kMostJump_s, kFewest, found)
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
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return out;
}

}  // namespace headpin::scene
