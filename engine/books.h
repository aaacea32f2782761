#pragma once

#include "engine/workspace.h"
#include "engine/world.h"

/// How a step keeps the energy ledger. Private to the engine.
namespace headpin::engine::detail {

/// Books, phase by phase, what the free bodies gain. Where none moves there is nothing to book.
class Books {
 public:
  /// @param changed  who moves has changed since the last step
  Books(World& world, Workspace& w, bool changed)
      : world_(world), w_(w), keep_(world.parameters.keep_ledger) {
    if (!keep_) return;
    Balance& last = world.memory.balance;
    start_ = changed || !world.roll.movers.empty() ? balance(world) : last;
    world.ledger.hand += start_ - last;  // what users changed between steps
    last = start_;
    w.struck = w.pushed = {};
  }
  /// Impulses are booked by their own sum: they act within the step, at velocities in between.
  void book_impacts() {
    keep_ = keep_ && !world_.roll.movers.empty();
    if (!keep_) return;
    add(world_.ledger.impact, w_.struck);
    add(world_.ledger.hand, w_.pushed);
    w_.pushed = {};
  }
  void begin() {
    if (keep_) mark_ = balance(world_);
  }
  /// What was gained since begin(), less what driven bodies gave.
  void end(Balance& account) {
    if (!keep_) return;
    add(account, balance(world_) - mark_ - w_.pushed);
    add(world_.ledger.hand, w_.pushed);
    w_.pushed = {};
  }
  /// The rest is free motion under gravity.
  void close() {
    if (!keep_) return;
    world_.memory.balance = balance(world_);
    world_.ledger.gravity += world_.memory.balance - start_ - booked_;
  }

 private:
  void add(Balance& account, const Balance& gain) {
    account += gain;
    booked_ += gain;
  }
  World& world_;
  Workspace& w_;
  bool keep_;
  Balance start_, mark_, booked_;
};

}  // namespace headpin::engine::detail
