#include "apps/simulate.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "devices/log.h"

namespace headpin::apps {

LoadedTrial load_trial(const std::string& path) {
  LoadedTrial loaded{devices::read_trial(path), {}};
  loaded.scenario = scene::parse_scenario(loaded.trial.header.scenario, path + " (scenario)");
  if (loaded.trial.samples.empty()) {
    throw std::runtime_error(path + ": expected samples of a tracker, found none");
  }
  return loaded;
}

std::int64_t tick_count(const devices::Trial& trial, const scene::Scenario& scenario) {
  const Time end = devices::ReplaySource(trial.samples).end();
  const std::int64_t rate = scenario.rates.physics_hz;
  std::int64_t ticks = end.count() / 1'000'000 * rate;
  while (tick_time(ticks, rate) < end) ++ticks;
  if (!trial.states.empty()) ticks = std::max(ticks, trial.states.back().tick);
  return ticks;
}

void simulate(scene::Session& session, const devices::Trial& trial,
              const std::function<void(const scene::Session&)>& each_tick) {
  devices::ReplaySource source(trial.samples);
  const std::int64_t ticks = tick_count(trial, session.scenario);
  while (session.world.tick < ticks) {
    scene::advance(session, source);
    each_tick(session);
  }
}

namespace {

bool same_bits(const devices::BodyState& a, const devices::BodyState& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) ==
           0;
  };
  return equal(a.X_WB.p, b.X_WB.p) && equal(a.X_WB.q.coeffs(), b.X_WB.q.coeffs()) &&
         equal(a.V_WB.v, b.V_WB.v) && equal(a.V_WB.w, b.V_WB.w) && a.asleep == b.asleep;
}

}  // namespace

std::optional<std::string> first_different_body(const devices::TickState& a,
                                                const devices::TickState& b,
                                                const std::vector<std::string>& names) {
  const std::size_t bodies = std::min(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < bodies; ++i) {
    if (!same_bits(a.bodies[i], b.bodies[i])) {
      return i < names.size() ? names[i] : fmt::format("body {}", i);
    }
  }
  if (a.hash != b.hash || a.bodies.size() != b.bodies.size()) return std::string();
  return std::nullopt;
}

Verifier::Verifier(const devices::Trial& trial, const scene::Session& session)
    : states_(trial.states), names_(scene::body_names(session)) {
  if (states_.empty()) {
    throw std::runtime_error(
        "the trial holds no states to compare with; expected one made by `headpin replay -o` or "
        "`headpin live`");
  }
}

void Verifier::compare(const devices::TickState& state) {
  while (next_ < states_.size() && states_[next_].tick < state.tick) ++next_;
  if (next_ == states_.size() || states_[next_].tick != state.tick) return;
  const auto body = first_different_body(state, states_[next_], names_);
  if (body) {
    throw std::runtime_error(
        fmt::format("tick {} ({:.6f} s) differs from the recording, first {}: expected state "
                    "{:016x}, found {:016x}",
                    state.tick, seconds(state.time),
                    body->empty() ? "in what only the hash tells" : "in the " + *body,
                    states_[next_].hash, state.hash));
  }
  ++compared_;
}

nlohmann::json common_value(const scene::Materials& m, double scene::Material::*coefficient) {
  const double value = m.skittle.*coefficient;
  if (m.ball.*coefficient == value && m.lane.*coefficient == value &&
      m.wall.*coefficient == value) {
    return value;
  }
  return {{"skittle", value},
          {"ball", m.ball.*coefficient},
          {"lane", m.lane.*coefficient},
          {"wall", m.wall.*coefficient}};
}

}  // namespace headpin::apps
