#include "scene/record/state_change.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace headpin::scene {
namespace {

BodyNumbers numbers_of(const BodyState& body) {
  const Vec3 &p = body.X_WB.p, &v = body.V_WB.v, &w = body.V_WB.w;
  const Quat& q = body.X_WB.q;
  const std::array<double, 13> all = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(),
                                      v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
  return std::bit_cast<BodyNumbers>(all);
}

BodyState body_of(const BodyNumbers& numbers, bool asleep) {
  const auto n = std::bit_cast<std::array<double, 13>>(numbers);
  return {{Quat(n[3], n[4], n[5], n[6]), {n[0], n[1], n[2]}},
          {{n[7], n[8], n[9]}, {n[10], n[11], n[12]}},
          asleep};
}

}  // namespace

void StateHistory::begin(const TickState& whole) {
  last_ = whole;
  now_.resize(whole.bodies.size());
  std::ranges::transform(whole.bodies, now_.begin(), numbers_of);
  before_ = now_;
}

std::optional<std::int64_t> StateHistory::next_tick() const {
  if (!last_ || last_->tick == std::numeric_limits<std::int64_t>::max()) return std::nullopt;
  return last_->tick + 1;
}

BodyNumbers StateHistory::expected(std::size_t body) const {
  BodyNumbers on;
  for (std::size_t i = 0; i < on.size(); ++i) on[i] = 2 * now_[body][i] - before_[body][i];
  return on;
}

std::optional<StateChange> StateHistory::change_to(const TickState& next) {
  if (next_tick() != next.tick || next.bodies.size() != now_.size()) return std::nullopt;
  StateChange change{next.time, next.tick, next.hash, next.contacts, {}};
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const BodyNumbers numbers = numbers_of(next.bodies[i]);
    const bool asleep = next.bodies[i].asleep;
    if (numbers != now_[i] || asleep != last_->bodies[i].asleep) {
      BodyChange body{static_cast<std::int32_t>(i), asleep, expected(i)};
      for (std::size_t k = 0; k < numbers.size(); ++k) body.beyond[k] = numbers[k] - body.beyond[k];
      change.bodies.push_back(body);
    }
    before_[i] = std::exchange(now_[i], numbers);
  }
  last_ = next;
  return change;
}

const TickState* StateHistory::go_on(const StateChange& change) {
  const bool known =
      next_tick() == change.tick && std::ranges::all_of(change.bodies, [&](const BodyChange& body) {
        return static_cast<std::size_t>(body.body) < now_.size();
      });
  if (!known) return nullptr;
  last_->time = change.time;
  last_->tick = change.tick;
  last_->hash = change.hash;
  last_->contacts = change.contacts;
  std::vector<BodyNumbers> now = now_;
  for (const BodyChange& body : change.bodies) {
    const auto i = static_cast<std::size_t>(body.body);
    now[i] = expected(i);
    for (std::size_t k = 0; k < now[i].size(); ++k) now[i][k] += body.beyond[k];
    last_->bodies[i] = body_of(now[i], body.asleep);
  }
  before_ = std::exchange(now_, std::move(now));
  return &*last_;
}

}  // namespace headpin::scene
