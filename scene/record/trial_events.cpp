#include "scene/record/trial_events.h"

#include <algorithm>
#include <utility>

#include "devices/base/sources.h"
#include "devices/base/version.h"

namespace headpin::scene {

TrialHeader stamped(TrialHeader header, States states) {
  header.format_version = states == States::all ? kFormatVersion : kChangesFormatVersion;
  header.software_version = devices::software_version();
  header.software_commit = devices::software_commit();
  header.schema = devices::schema_text();
  return header;
}

TrialEvents::TrialEvents(const TrialHeader& header, const Options& options, Take take)
    : options_(options), take_(std::move(take)) {
  give(kTrialChannel, Time{}, stamped(header, options.states));
}

template <typename T>
void TrialEvents::give(std::string_view channel, Time time, const T& message) {
  encode(message, bytes_);
  last_ = std::max(last_, time);
  take_({.number = number_++, .time = options_.epoch + last_, .channel = channel, .data = bytes_});
  ++count_;
}

/// The changes of a state; nothing if it must be stored whole.
std::optional<StateChange> TrialEvents::change_to(const TickState& state) {
  if (options_.states == States::all) return std::nullopt;
  if (state.time < whole_due_) {
    if (auto change = states_.change_to(state)) return change;
  }
  states_.begin(state);
  whole_due_ = state.time + Time{1'000'000};
  return std::nullopt;
}

void TrialEvents::write(const devices::Sample& sample) {
  if (const auto* tracker = std::get_if<devices::TrackerSample>(&sample)) {
    give(devices::kTrackerChannel, devices::available(sample), *tracker);
  } else {
    give(devices::kMouseChannel, devices::available(sample),
         std::get<devices::MouseSample>(sample));
  }
}

void TrialEvents::write(const Event& event) {
  give(kEventChannel, event.time, event);
}

void TrialEvents::write(const TickState& state) {
  if (const auto change = change_to(state)) {
    give(kStateChangeChannel, state.time, *change);
  } else {
    give(kStateChannel, state.time, state);
  }
}

void TrialEvents::write(const FrameRecord& frame) {
  give(kFrameChannel, frame.time, frame);
}

void TrialEvents::write(const Snapshot& snapshot) {
  give(kSnapshotChannel, snapshot.time, snapshot);
  --count_;  // see snapshot_t
}

void TrialEvents::close() {
  Event end;
  end.time = last_;
  end.kind = kEndEvent;
  end.value = static_cast<double>(count_);
  write(end);
}

}  // namespace headpin::scene
