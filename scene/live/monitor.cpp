#include "scene/live/monitor.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "scene/record/details.h"
#include "scene/record/events.h"

namespace headpin::scene {

LiveMonitor::LiveMonitor(const LiveSources& sources, const RealTime& pace, FramesBeside& eyes,
                         TrialOutputs& trial)
    : sources_(sources), pace_(pace), eyes_(eyes), trial_(trial), said_(sources.each().size()) {}

void LiveMonitor::tick(const Session& session) {
  samples_ += static_cast<std::int64_t>(session.samples.size());
  bad_samples_ += std::ranges::count_if(session.samples, [](const devices::Sample& sample) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    return tracker && !tracker->good();
  });
  take_frames();
  take_failures(session);
  look_at_sources(session);
  look_at_recording(session);
}

void LiveMonitor::finish(const Session& session) {
  take_frames();
  take_failures(session);
  for (std::size_t i = 0; i < said_.size(); ++i) {
    const devices::OpenSource& one = sources_.each()[i];
    const devices::SourceStatus status = one.source->status(session.now());
    tell_faults(session, one.name, said_[i].faults.take_rest(status.faults));
  }
}

std::vector<LiveNews> LiveMonitor::take_news() {
  return std::exchange(news_, {});
}

LiveState LiveMonitor::state(const Session& session) const {
  LiveState state;
  state.now = session.now();
  state.samples = samples_;
  state.bad_samples = bad_samples_;
  state.frames = frames_;
  state.late_frames = eyes_.late();
  state.drawing_failures = drawing_failures_;
  state.overruns = pace_.overruns();
  state.fresh_frames = latency_.each.count();
  state.latency_median_s = latency_.each.quantile(0.5);
  state.latency_p99_s = latency_.each.quantile(0.99);
  state.latency_mean = latency_.mean();
  for (const devices::OpenSource& one : sources_.each()) {
    state.sources.push_back({one.name, one.source->status(session.now())});
  }
  return state;
}

Event LiveMonitor::kept_pace(const Session& session) const {
  Event event;
  event.time = session.now();
  event.kind = kind::kept_pace;
  event.detail = KeptPace{.ticks = session.tick,
                          .overruns = pace_.overruns(),
                          .frames = frames_,
                          .late_frames = eyes_.late(),
                          .drawing_failures = drawing_failures_};
  return event;
}

void LiveMonitor::take_frames() {
  for (const FramesBeside::Done& done : eyes_.take_done()) {
    ++frames_;
    if (done.stages) latency_.add(*done.stages);
    trial_.write(done.record);
  }
}

void LiveMonitor::take_failures(const Session& session) {
  for (const std::string& why : eyes_.take_failures()) {
    ++drawing_failures_;
    news_.push_back({session.now(), why});
    write(session, kind::drawing_failed, why);
  }
}

void LiveMonitor::look_at_sources(const Session& session) {
  for (std::size_t i = 0; i < said_.size(); ++i) {
    const devices::OpenSource& one = sources_.each()[i];
    const devices::SourceStatus status = one.source->status(session.now());
    tell_trouble(session, one.name, status.trouble, said_[i]);
    tell_faults(session, one.name, said_[i].faults.take(status.faults, session.now()));
  }
}

void LiveMonitor::tell_trouble(const Session& session, const std::string& source,
                               const std::string& trouble, Said& said) {
  if (trouble == said.trouble) return;
  said.trouble = trouble;
  news_.push_back({session.now(), trouble.empty() ? source + " is back" : trouble});
}

void LiveMonitor::tell_faults(const Session& session, const std::string& source,
                              const std::vector<std::string>& faults) {
  for (const std::string& what : faults) {
    const std::string text = fmt::format("from {}, {}", source, what);
    news_.push_back({session.now(), text});
    write(session, kind::source_amiss, text);
  }
}

/// Notices at once if the file of the recording is lost. The session continues.
void LiveMonitor::look_at_recording(const Session& session) {
  if (lost_ || session.now() < next_look_) return;
  next_look_ = session.now() + Time{1'000'000};
  try {
    trial_.require_kept();
  } catch (const std::runtime_error& error) {
    lost_ = true;
    news_.push_back({session.now(),
                     fmt::format("{}; the session continues without a recording", error.what())});
  }
}

void LiveMonitor::write(const Session& session, std::string_view kind, std::string detail) {
  Event event;
  event.time = session.now();
  event.tick = session.tick;
  event.kind = kind;
  event.detail = std::move(detail);
  trial_.write(event);
}

}  // namespace headpin::scene
