#pragma once

#include "engine/world.h"

/// How a step keeps the energy ledger. Private to the engine.
namespace headpin::engine::detail {

/// Books, phase by phase, what the free bodies gain. Where none moves there is nothing to book.
class Books {
 public:
  Books(World& world, bool changed) : world_(world), keep_(world.parameters.keep_ledger) {
    if (!keep_) return;
    start_ = changed || !world.scratch.movers.empty() ? balance(world) : world.balance;
    world.ledger.hand += start_ - world.balance;  // what users changed between steps
    world.balance = start_;
    world.struck = world.pushed = {};
  }
  /// Impulses are booked by their own sum: they act within the step, at velocities in between.
  void book_impacts() {
    keep_ = keep_ && !world_.scratch.movers.empty();
    if (!keep_) return;
    add(world_.ledger.impact, world_.struck);
    add(world_.ledger.hand, world_.pushed);
    world_.pushed = {};
  }
  void begin() {
    if (keep_) mark_ = balance(world_);
  }
  /// What was gained since begin(), less what driven bodies gave.
  void end(Balance& account) {
    if (!keep_) return;
    add(account, balance(world_) - mark_ - world_.pushed);
    add(world_.ledger.hand, world_.pushed);
    world_.pushed = {};
  }
  /// The rest is free motion under gravity.
  void close() {
    if (!keep_) return;
    world_.balance = balance(world_);
    world_.ledger.gravity += world_.balance - start_ - booked_;
  }

 private:
  void add(Balance& account, const Balance& gain) {
    account += gain;
    booked_ += gain;
  }
  World& world_;
  bool keep_;
  Balance start_, mark_, booked_;
};

}  // namespace headpin::engine::detail
