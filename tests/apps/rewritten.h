#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string_view>

#include "devices/base/sources.h"
#include "scene/record/events.h"
#include "scene/record/log.h"

namespace headpin {

/// Writes the trial FROM as TO, changed: its samples, events and states in the order of a session.
inline void rewrite_trial(const std::filesystem::path& from, const std::filesystem::path& to,
                          const std::function<void(scene::Trial&)>& change) {
  scene::Trial trial = scene::read_trial(from);
  change(trial);
  scene::Recorder recorder(to, trial.header);
  auto event = trial.events.begin();
  auto state = trial.states.begin();
  const auto write_until = [&](Time end) {
    for (; event != trial.events.end() && event->time < end; ++event) recorder.write(*event);
    for (; state != trial.states.end() && state->time < end; ++state) recorder.write(*state);
  };
  for (const devices::Sample& sample : trial.samples) {
    write_until(devices::available(sample));
    recorder.write(sample);
  }
  write_until(Time::max());
  recorder.close();
}

/// Moves the first body from a tick on, as if another version had simulated the trial.
inline void change_states_from(std::int64_t tick, scene::Trial& trial) {
  for (scene::TickState& state : trial.states) {
    if (state.tick < tick) continue;
    state.bodies.front().X_WB.p.x() += 0.1;
    state.hash ^= 1;
  }
}

/// Adds what a live session tells, at its tick, and no simulation makes again: what drew at time 0, and that a
/// source was amiss at 2.5 s.
inline void add_told_live(scene::Trial& trial) {
  const auto add = [&](std::string_view kind, Time time, std::int64_t tick) {
    scene::Event event;
    event.time = time;
    event.tick = tick;
    event.kind = kind;
    const auto later = std::ranges::upper_bound(trial.events, time, {}, &scene::Event::time);
    trial.events.insert(later, event);
  };
  add(scene::kind::drawn_by, Time{}, 0);
  add(scene::kind::source_amiss, Time{2'500'000}, 600);
}

}  // namespace headpin
