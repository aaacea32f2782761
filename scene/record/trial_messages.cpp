#include "scene/record/trial_messages.h"

#include <algorithm>
#include <utility>

#include "scene/record/log.h"

namespace headpin::scene {

void note_trouble(TrialSummary& summary, const char* kind, const std::string& of, Time at,
                  std::int64_t messages) {
  constexpr Time kNear{1'000'000};
  const auto last =
      std::find_if(summary.trouble.rbegin(), summary.trouble.rend(),
                   [&](const Trouble& t) { return t.kind == kind && t.device == of; });
  if (last != summary.trouble.rend() && at >= last->from && at - last->to <= kNear) {
    last->to = std::max(last->to, at);
    last->messages += messages;
    if (last->messages == 0) summary.trouble.erase(std::next(last).base());
  } else if (messages > 0 && summary.trouble.size() < kMostTroubles) {
    summary.trouble.push_back({kind, of, messages, at, at});
  }
}

std::optional<Message> Messages::next() {
  while (const std::optional<devices::LogEvent> event = reader_.next()) {
    std::optional<Message> message = take(*event);
    if (over_) break;
    if (message) return message;
  }
  counted_.skipped.bytes = reader_.skipped_bytes();
  counted_.skipped.cut_bytes = reader_.cut_bytes();
  return std::nullopt;
}

std::optional<Message> Messages::take(const devices::LogEvent& event) {
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
  if (std::holds_alternative<Snapshot>(*message)) return message;  // not counted
  const auto* said = std::get_if<Event>(&*message);
  if (said && said->kind == kDrawnByEvent && std::exchange(drawn_by_, true)) return std::nullopt;
  ++taken_;
  if (is_doubled()) {
    ++counted_.skipped.doubled;
    note_trouble(counted_, "doubled", std::string(name), since_first());
    return std::nullopt;
  }
  if (said && said->kind == kEndEvent) {
    // A sender counts what it repeats; one whose messages are there twice does not.
    const auto all = static_cast<double>(taken_ - 1 - ends_++);
    const auto doubled = static_cast<double>(counted_.skipped.doubled);
    counted_.complete = said->value == all || said->value == all - doubled;
    return std::nullopt;
  }
  bytes_ = event.data;
  if (const auto* tracker = std::get_if<devices::TrackerSample>(&*message);
      tracker && !tracker->in_transmitters_frame()) {
    ++counted_.skipped.foreign;
    note_trouble(counted_, "foreign", devices::device_name(devices::device_at(tracker->station)),
                 since_first());
    return std::nullopt;
  }
  return message;
}

bool Messages::is_doubled() {
  if (doubled_.empty() || doubled_.front() != number()) return false;
  doubled_ = doubled_.subspan(1);
  return true;
}

void Messages::take(TrialHeader& header) {
  if (!counted_.has_header) {
    counted_.header = std::move(header);
    counted_.has_header = true;
    ++taken_;
  } else if (header != counted_.header) {
    ++counted_.skipped.other_trials;
    over_ = true;
  }
}

}  // namespace headpin::scene
