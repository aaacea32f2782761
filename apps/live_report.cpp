#include "apps/live_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "apps/damage.h"
#include "apps/streams.h"
#include "scene/play/events.h"
#include "scene/play/quantile.h"

namespace headpin::apps {

void write(Live& live, const devices::Event& event) {
  if (live.writer) live.writer->write(event);
  if (live.publisher) live.publisher->write(event);
}

void Reporter::take_frames() {
  for (const scene::FramesBeside::Done& done : live_.eyes->take_done()) {
    ++live_.frames;
    if (done.stages) live_.latency.add(*done.stages);
    if (live_.writer) live_.writer->write(done.record);
    if (live_.publisher) live_.publisher->write(done.record);
  }
}

/// Reports lost pictures, and writes them to the trial.
void Reporter::take_failures() {
  for (const std::string& why : live_.eyes->take_failures()) {
    ++live_.drawing_failures;
    say("{:7.1f} s  {}\n", seconds(live_.session.now()), printable(why));
    write(live_, event_now(scene::kind::drawing_failed, why));
  }
}

devices::Event Reporter::event_now(std::string_view kind, std::string detail) const {
  devices::Event event;
  event.time = live_.session.now();
  event.tick = live_.session.tick;
  event.kind = kind;
  event.detail = std::move(detail);
  return event;
}

void Reporter::report_trouble(const std::string& source, const std::string& trouble, Said& said) {
  if (trouble == said.trouble) return;
  said.trouble = trouble;
  say("{:7.1f} s  {}\n", seconds(live_.session.now()),
      trouble.empty() ? source + " is back" : trouble);
}

/// Reports faults in received samples, and writes them to the trial.
void Reporter::report_faults(const std::string& source, const std::vector<std::string>& news) {
  for (const std::string& what : news) {
    const std::string text = fmt::format("from {}, {}", source, what);
    say("{:7.1f} s  {}\n", seconds(live_.session.now()), text);
    write(live_, event_now(scene::kind::source_amiss, text));
  }
}

/// Reports what happened since the last report.
void Reporter::finish() {
  take_frames();
  take_failures();
  for (std::size_t i = 0; i < said_.size(); ++i) {
    const devices::OpenSource& one = live_.sources[i];
    const devices::SourceStatus status = one.source->status(live_.session.now());
    report_faults(one.name, said_[i].faults.take_rest(status.faults));
  }
}

/// Reports at once if the file of the recording is lost. The session continues.
void Reporter::report_loss() {
  if (!live_.writer || lost_ || live_.session.now() < next_look_) return;
  next_look_ = live_.session.now() + Time{1'000'000};
  try {
    live_.writer->require_kept();
  } catch (const std::runtime_error& error) {
    lost_ = true;
    say("{:7.1f} s  {}; the session continues without a recording\n", seconds(live_.session.now()),
        error.what());
  }
}

void Reporter::tick(const scene::Session& session) {
  live_.samples += static_cast<std::int64_t>(session.samples.size());
  live_.bad_samples += std::ranges::count_if(session.samples, [](const devices::Sample& sample) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    return tracker && !tracker->good();
  });
  take_frames();
  take_failures();
  for (std::size_t i = 0; i < said_.size(); ++i) {
    const devices::OpenSource& one = live_.sources[i];
    const devices::SourceStatus status = one.source->status(session.now());
    report_trouble(one.name, status.trouble, said_[i]);
    report_faults(one.name, said_[i].faults.take(status.faults, session.now()));
  }
  report_loss();
  if (session.now() < next_line_) return;
  print_line(live_);
  next_line_ += Time{10'000'000};
}

void print_line(const Live& live) {
  std::string text = fmt::format(
      "{:7.1f} s  {} samples, {} frames ({} late), sample to frame {:.1f} ms median, {:.1f} ms "
      "p99, {} overruns, {} skittles down",
      seconds(live.session.now()), live.samples, live.frames, live.eyes->late(),
      1e3 * scene::quantile(live.latency.each_s, 0.5),
      1e3 * scene::quantile(live.latency.each_s, 0.99), live.pace->overruns(),
      live.totals.score().skittles_down);
  if (live.bad_samples > 0) {
    text += fmt::format("; {} bad samples, whose status is not a space", live.bad_samples);
  }
  for (const auto& source : live.sources)
    text += "; " + source.source->status(live.session.now()).line;
  say("{}\n", text);
}

/// Prints the stages of the latency from a head's sample to its frame.
void print_stages(const scene::FrameLatency& latency) {
  const scene::FrameStages mean = latency.mean();
  say("{:11}mean {:.1f} ms: {:.1f} until its tick, {:.1f} until the frame was due, {:.1f} until it "
      "was drawn, {:.1f} until it was published\n",
      "", 1e3 * mean.sum(), 1e3 * mean.ticked, 1e3 * mean.waited, 1e3 * mean.drawn,
      1e3 * mean.published);
}

namespace {

nlohmann::json summary_of(const devices::OpenSource& source, Time now) {
  const devices::SourceStatus status = source.source->status(now);
  nlohmann::json j = {{"source", source.name}, {"activity", status.activity}};
  for (const auto& [name, count] : status.counts) j[name] = count;
  return j;
}

}  // namespace

nlohmann::json summary(const Live& live, const LiveOptions& options) {
  nlohmann::json j = scene::summary(live.session, live.totals.score());
  j["output"] = options.record ? nlohmann::json(*options.record) : nlohmann::json();
  j["duration_s"] = seconds(live.session.now());
  if (const std::string why = live.totals.why_nothing_fell(); !why.empty())
    j["why_nothing_fell"] = why;
  j["samples"] = live.samples;
  j["frames"] = live.frames;
  j["late_frames"] = live.eyes->late();
  j["overruns"] = live.pace->overruns();
  j["drawing_failures"] = live.drawing_failures;
  j["latency_median_s"] = scene::quantile(live.latency.each_s, 0.5);
  j["latency_p99_s"] = scene::quantile(live.latency.each_s, 0.99);
  const scene::FrameStages mean = live.latency.mean();
  j["latency_mean_s"] = mean.sum();
  j["latency_stages"] = {{"ticked_s", mean.ticked},
                         {"waited_s", mean.waited},
                         {"drawn_s", mean.drawn},
                         {"published_s", mean.published}};
  j["sources"] = nlohmann::json::array();
  for (const auto& source : live.sources)
    j["sources"].push_back(summary_of(source, live.session.now()));
  return j;
}

}  // namespace headpin::apps
