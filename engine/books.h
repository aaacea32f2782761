#pragma once

#include <cstring>

#include "engine/workspace.h"
#include "engine/world.h"

/// How a step keeps the energy ledger. Private to the engine.
namespace headpin::engine::detail {

/// Adds the gains of the free bodies to the ledger, phase by phase. Adds nothing if no body moves.
class Books {
 public:
  /// @param changed  whether the set of moving bodies has changed since the last step
  Books(World& world, Workspace& w, bool changed)
      : world_(world), w_(w), keep_(world.parameters.keep_ledger) {
    if (!keep_) return;
    Balance& last = world.memory.balance;
    start_ = changed || !world.roll.movers.empty() ? balance_now() : last;
    world.ledger.hand += start_ - last;  // what users changed between steps
    last = start_;
    w.by_impacts = w.by_driven = {};
  }
  /// Books the impacts. Their gains are summed impulse by impulse, because they act within the
  /// step.
  void book_impacts() {
    keep_ = keep_ && !world_.roll.movers.empty();
    if (!keep_) return;
    add(world_.ledger.impact, w_.by_impacts);
    add(world_.ledger.hand, w_.by_driven);
    w_.by_driven = {};
  }
  void begin() {
    if (keep_) mark_ = balance_now();
  }
  /// Books the gain since begin() or the last end(); the part from driven bodies goes to `hand`.
  void end(Balance& account) {
    if (!keep_) return;
    const Balance now = balance_now();
    add(account, now - mark_ - w_.by_driven);
    mark_ = now;
    add(world_.ledger.hand, w_.by_driven);
    w_.by_driven = {};
  }
  /// Books the rest of the gain up to the last end() as free motion under gravity.
  void close() {
    if (!keep_) return;
    world_.memory.balance = mark_;
    world_.ledger.gravity += world_.memory.balance - start_ - booked_;
  }

 private:
  void add(Balance& account, const Balance& gain) {
    account += gain;
    booked_ += gain;
  }
  /// The same as balance(), but reuses the part of each body whose state has not changed.
  Balance balance_now() {
    static_assert(sizeof(State) == 13 * sizeof(double), "no bytes between its numbers");
    if (!knows_parts_) w_.booked.assign(world_.states.size(), {});
    knows_parts_ = true;
    Balance sum;
    for (BodyId i = 0; i < world_.bodies.size(); ++i) {
      if (world_.bodies[i].kind != Kind::free) continue;
      auto& [known, state, part] = w_.booked[i];
      if (!known || std::memcmp(&state, &world_.states[i], sizeof(State)) != 0) {
        known = true;
        state = world_.states[i];
        part = balance_of(world_, i);
      }
      sum += part;
    }
    return sum;
  }

  World& world_;
  Workspace& w_;
  bool keep_, knows_parts_ = false;
  Balance start_, mark_, booked_;
};

}  // namespace headpin::engine::detail
