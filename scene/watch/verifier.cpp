#include "scene/watch/verifier.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace headpin::scene {

namespace {

bool same_bits(const BodyState& a, const BodyState& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) ==
           0;
  };
  return equal(a.X_WB.p, b.X_WB.p) && equal(a.X_WB.q.coeffs(), b.X_WB.q.coeffs()) &&
         equal(a.V_WB.v, b.V_WB.v) && equal(a.V_WB.w, b.V_WB.w) && a.asleep == b.asleep;
}

}  // namespace

std::optional<std::string> first_different_body(const TickState& a, const TickState& b,
                                                std::span<const std::string> names) {
  const std::size_t bodies = std::min(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < bodies; ++i) {
    if (!same_bits(a.bodies[i], b.bodies[i])) {
      return i < names.size() ? names[i] : fmt::format("body {}", i);
    }
  }
  if (a.hash != b.hash || a.bodies.size() != b.bodies.size()) return std::string();
  return std::nullopt;
}

SharedBodies shared_bodies(std::span<const std::string> a, std::span<const std::string> b) {
  SharedBodies shared;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = std::ranges::find(b, a[i]);
    if (found == b.end()) {
      shared.only_in_a.push_back(a[i]);
      continue;
    }
    shared.names.push_back(a[i]);
    shared.in_a.push_back(i);
    shared.in_b.push_back(static_cast<std::size_t>(found - b.begin()));
  }
  for (const std::string& name : b) {
    if (std::ranges::find(a, name) == a.end()) shared.only_in_b.push_back(name);
  }
  return shared;
}

std::optional<std::string> first_different_body(const TickState& a, const TickState& b,
                                                const SharedBodies& shared) {
  if (shared.all()) return first_different_body(a, b, shared.names);
  for (std::size_t i = 0; i < shared.names.size(); ++i) {
    const std::size_t in_a = shared.in_a[i], in_b = shared.in_b[i];
    if (in_a >= a.bodies.size() || in_b >= b.bodies.size()) continue;
    if (!same_bits(a.bodies[in_a], b.bodies[in_b])) return shared.names[i];
  }
  return std::nullopt;
}

Verifier::Verifier(std::string trial, TrialPlayer& recorded, const Session& session)
    : trial_(std::move(trial)),
      recorded_(recorded),
      names_(body_names(*session.stage)),
      first_(session.tick) {
  if (!recorded.has_states()) {
    throw std::runtime_error(
        trial_ +
        ": holds no states to compare with; expected a trial made by `headpin replay -o` "
        "or `headpin live`");
  }
}

void Verifier::tick(const Session& session) {
  const TickState* recorded = recorded_.state(session.tick);
  if (!recorded) return;
  tick_state(session, state_);
  const auto body = first_different_body(state_, *recorded, names_);
  if (body && state_.hash == recorded->hash) {
    throw Differs(fmt::format(
        "{}: tick {} ({:.6f} s): the recorded state does not match its hash {:016x}, but "
        "the replay's state does; first difference in the {}",
        trial_, state_.tick, seconds(state_.time), recorded->hash,
        body->empty() ? "number of bodies" : *body));
  }
  if (body) {
    throw Differs(fmt::format(
        "{}: tick {} ({:.6f} s) of the replay differs from the recording, first difference {}: "
        "expected state {:016x}, found {:016x}{}",
        trial_, state_.tick, seconds(state_.time),
        body->empty() ? "in what only the hash tells" : "in the " + *body, recorded->hash,
        state_.hash,
        recorded_.complete() ? ""
                             : "; the recording is not complete, and what the session "
                               "got may be missing in it"));
  }
  ++compared_;
}

std::int64_t Verifier::finish(const TrialSummary& trial, const Session& session) const {
  const std::optional<SaidGameHash> said = said_game_hash(trial);
  const std::string found = in_hex(session.game_hash.value());
  if (said && said->tick == session.tick && said->hash != found) {
    throw Differs(fmt::format(
        "{}: the replayed game differs from the recorded one: expected the game hash {}, found {}",
        trial_, said->hash, found));
  }
  const std::int64_t ticks = (trial.complete ? trial.last_tick : session.tick) - first_;
  const std::int64_t unverified = ticks - compared_;
  if (unverified > (trial.complete ? 0 : 1)) {
    throw std::runtime_error(fmt::format(
        "{}: {} of the {} recorded ticks have no state to compare with; the other {} are equal",
        trial_, unverified, ticks, compared_));
  }
  return unverified;
}

}  // namespace headpin::scene
