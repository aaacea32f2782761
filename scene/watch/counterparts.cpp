#include "scene/watch/counterparts.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/play/score.h"
#include "scene/play/session.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

/// Releases in two sessions with different tick rates count as simultaneous within this time.
constexpr Time kSameMoment{10'000};

/// The reason why no ball was released at `time`.
///
/// @param before  time of the previous release
std::string why_not_thrown(std::span<const Event> events, Time before, Time time) {
  const auto within = [&](std::string_view kind) {
    return std::ranges::find_if(events, [&](const Event& event) {
      return event.kind == kind && event.time > before && event.time <= time + kSameMoment;
    });
  };
  if (within(kind::missed_grab) != events.end()) {
    return "not thrown: the hand closed on nothing";
  }
  const auto grab = within(kind::grab);
  if (grab != events.end() && !is_of_ball(*grab)) return "not thrown: the hand took a skittle";
  return "not thrown";
}

/// Whether anything in the rest of a trial can still throw a ball or count one.
///
/// Whether the hand finds a ball depends on where the balls are, so the simulation goes on as long as there
/// are buttons. After the last one, only a ball that is thrown can be counted.
class ThrowsAhead {
 public:
  explicit ThrowsAhead(const TrialFile& file) {
    file.walk([&](const TrialFile::Item& item) {
      const auto* sample = std::get_if<devices::Sample>(&item);
      if (sample && std::holds_alternative<devices::MouseSample>(*sample)) ++buttons_;
      return true;
    });
  }

  /// After each tick.
  void see(const Session& session) {
    for (const devices::Sample& sample : session.samples) {
      if (std::holds_alternative<devices::MouseSample>(sample)) --buttons_;
    }
    for (const Event& event : session.events) {
      if (event.kind == kind::release && is_of_ball(event)) uncounted_ = true;
      if (event.kind == kind::delivery) uncounted_ = false;
    }
  }

  bool any(const Session& session) const {
    if (buttons_ > 0 || !session.player.buttons.empty()) return true;
    const bool another_version = session.versions[0] != nullptr;  // begins another game
    return uncounted_ && rules_of(session.scenario().game.rules).counted &&
           (another_version || !session.game.over);
  }

 private:
  std::int64_t buttons_ = 0;  ///< that are still to come
  bool uncounted_ = false;    ///< the last ball that was thrown is not counted
};

}  // namespace

std::vector<ThrownBall> thrown(std::span<const Event> events) {
  std::vector<ThrownBall> all;
  std::string version;
  std::size_t counted = 0;  // throws before this one are, or never will be
  for (const Event& event : events) {
    if (event.kind == kind::version) version = event.detail.text();
    if (event.kind == kind::release && is_of_ball(event)) {
      all.push_back({static_cast<int>(all.size()) + 1, version, event.time, event.tick, {}});
    }
    if (event.kind == kind::delivery && counted < all.size()) {
      all.back().felled = skittles_in(event);
      counted = all.size();
    }
  }
  return all;
}

bool says_events(const TrialSummary& trial) {
  return std::ranges::any_of(trial.events, [](const auto& event) { return event.tick >= 0; });
}

std::vector<Event> events_of(const TrialFile& file, const Scenario& scenario,
                             const std::function<void()>& each_tick) {
  const TrialSummary& trial = file.summary();
  if (says_events(trial)) return trial.events;
  std::vector<Event> events;
  TrialPlayer source(file);
  Session session = make_session(scenario);
  session.hashes = false;
  ThrowsAhead ahead(file);
  const std::int64_t ticks = tick_count(trial, scenario.rates.physics_hz);
  while (session.tick < ticks && ahead.any(session)) {
    if (each_tick) each_tick();
    advance(session, source);
    ahead.see(session);
    events.insert(events.end(), session.events.begin(), session.events.end());
  }
  return events;
}

std::vector<Unpaired> without_counterpart(std::span<const Event> a, std::span<const Event> b) {
  std::vector<Unpaired> all;
  const std::vector<ThrownBall> of_b = thrown(b);
  Time before = Time::min();
  for (const ThrownBall& one : thrown(a)) {
    const auto other = std::ranges::find_if(of_b, [&](const ThrownBall& candidate) {
      return std::chrono::abs(candidate.time - one.time) <= kSameMoment;
    });
    if (other == of_b.end()) {
      all.push_back({one, why_not_thrown(b, before, one.time)});
    } else if (other->version != one.version) {
      all.push_back({one, other->version.empty()
                              ? "thrown before a version began"
                              : fmt::format("thrown in the {} version", other->version)});
    } else if (one.felled && !other->felled) {
      all.push_back({one, "thrown and not counted"});
    }
    before = one.time;
  }
  return all;
}

nlohmann::json whose(const std::string& path, const TrialSummary& trial,
                     const std::vector<std::string>& set) {
  return {{"trial", path},
          {"complete", trial.complete},
          {"participant", trial.header.participant},
          {"condition", trial.header.condition},
          {"seed", trial.header.seed},
          {"set", set}};
}

nlohmann::json compared_throws(const TrialFile& file, const Scenario& as_recorded, bool same,
                               std::span<const Event> again,
                               const std::function<void()>& each_tick) {
  std::vector<Event> events(again.begin(), again.end());
  if (!same || says_events(file.summary())) events = events_of(file, as_recorded, each_tick);
  return {{"throws_without_counterpart", to_json(without_counterpart(events, again))},
          {"new_throws", to_json(without_counterpart(again, events))}};
}

nlohmann::json to_json(const std::vector<Unpaired>& unpaired) {
  nlohmann::json all = nlohmann::json::array();
  for (const Unpaired& one : unpaired) {
    all.push_back({{"throw", one.thrown.number},
                   {"name", one.thrown.version},
                   {"time_s", seconds(one.thrown.time)},
                   {"why", one.why}});
  }
  return all;
}

std::string unpaired_in_words(const nlohmann::json& unpaired) {
  const std::string version = unpaired["name"];
  return fmt::format("throw {} ({}{}{:.3f} s): {}", unpaired["throw"].get<int>(), version,
                     version.empty() ? "" : ", ", unpaired["time_s"].get<double>(),
                     unpaired["why"].get<std::string>());
}

}  // namespace headpin::scene
