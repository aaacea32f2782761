#include "apps/live_report.h"

#include <string>

#include <fmt/format.h>

#include "apps/streams.h"

namespace headpin::apps {

void Reporter::say_news() {
  for (const scene::LiveNews& news : monitor_.take_news()) {
    say("{:7.1f} s  {}\n", seconds(news.time), printable(news.text));
  }
}

void Reporter::tick(const scene::Session& session) {
  say_news();
  if (session.now() < next_line_) return;
  print_line(monitor_.state(session), totals_);
  next_line_ += Time{10'000'000};
}

void print_line(const scene::LiveState& state, const scene::Totals& totals) {
  std::string text = fmt::format(
      "{:7.1f} s  {} samples, {} frames ({} late), sample to frame {:.1f} ms median, {:.1f} ms "
      "p99, {} overruns, {} skittles down",
      seconds(state.now), state.samples, state.frames, state.late_frames,
      1e3 * state.latency_median_s, 1e3 * state.latency_p99_s, state.overruns,
      totals.score().skittles_down);
  if (state.bad_samples > 0) {
    text += fmt::format("; {} bad samples, whose status is not a space", state.bad_samples);
  }
  for (const auto& [name, status] : state.sources) text += "; " + status.line;
  say("{}\n", text);
}

void print_stages(const scene::LiveState& state) {
  if (state.fresh_frames == 0) return;
  const scene::FrameStages& mean = state.latency_mean;
  say("{:11}mean {:.1f} ms: {:.1f} until its tick, {:.1f} until the frame was due, {:.1f} until it "
      "was drawn, {:.1f} until it was published\n",
      "", 1e3 * mean.sum(), 1e3 * mean.ticked, 1e3 * mean.waited, 1e3 * mean.drawn,
      1e3 * mean.published);
}

nlohmann::json summary(const scene::Session& session, const scene::LiveState& state,
                       const scene::Totals& totals, const LiveOptions& options) {
  nlohmann::json j = scene::summary(session, totals.score_at_end(session));
  j["output"] = options.record ? nlohmann::json(*options.record) : nlohmann::json();
  j["duration_s"] = seconds(state.now);
  if (const std::string why = totals.why_nothing_fell(); !why.empty()) j["why_nothing_fell"] = why;
  j["samples"] = state.samples;
  j["frames"] = state.frames;
  j["late_frames"] = state.late_frames;
  j["overruns"] = state.overruns;
  j["drawing_failures"] = state.drawing_failures;
  j["latency_median_s"] = state.latency_median_s;
  j["latency_p99_s"] = state.latency_p99_s;
  const scene::FrameStages& mean = state.latency_mean;
  j["latency_mean_s"] = mean.sum();
  j["latency_stages"] = {{"ticked_s", mean.ticked},
                         {"waited_s", mean.waited},
                         {"drawn_s", mean.drawn},
                         {"published_s", mean.published}};
  j["sources"] = nlohmann::json::array();
  for (const auto& [name, status] : state.sources) {
    nlohmann::json source = {{"source", name}, {"activity", status.activity}};
    for (const auto& [key, count] : status.counts) source[key] = count;
    j["sources"].push_back(source);
  }
  return j;
}

}  // namespace headpin::apps
