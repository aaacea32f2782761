#include "scene/watch/verifier.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace headpin::scene {

Verifier::Verifier(std::string trial, TrialPlayer& recorded, const Session& session)
    : trial_(std::move(trial)),
      recorded_(recorded),
      bodies_(shared_bodies(body_names(*session.stage), body_names(*session.stage))),
      first_(session.tick) {
  if (!recorded.has_states()) {
    throw std::runtime_error(
        trial_ +
        ": holds no states to compare with; expected a trial that was replayed or recorded live");
  }
}

void Verifier::tick(const Session& session) {
  const TickState* recorded = recorded_.state(session.tick);
  if (!recorded) return;
  tick_state(session, state_);
  const auto difference = compare(state_, *recorded, bodies_);
  if (difference && state_.hash == recorded->hash) {
    throw Differs(fmt::format(
        "{}: tick {} ({:.6f} s): the recorded state does not match its hash {:016x}, but "
        "the replay's state does; first difference in the {}",
        trial_, state_.tick, seconds(state_.time), recorded->hash,
        difference->body.empty() ? "number of bodies" : difference->body));
  }
  if (difference) {
    throw Differs(fmt::format(
        "{}: tick {} ({:.6f} s) of the replay differs from the recording, first difference {}: "
        "expected state {:016x}, found {:016x}{}",
        trial_, state_.tick, seconds(state_.time),
        difference->body.empty() ? "in what only the hash tells" : "in the " + difference->body,
        recorded->hash, state_.hash,
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
