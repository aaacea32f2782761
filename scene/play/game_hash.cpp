#include "scene/play/game_hash.h"

#include <fmt/format.h>

#include "scene/record/events.h"

namespace headpin::scene {

void GameHash::add(std::uint64_t state_hash, std::uint64_t version) {
  for (const std::uint64_t number : {state_hash, version}) {
    for (int shift = 0; shift < 64; shift += 8) {
      value_ = (value_ ^ (number >> shift & 0xff)) * 0x100000001b3u;
    }
  }
}

std::string in_hex(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

std::optional<SaidGameHash> said_game_hash(const TrialSummary& trial) {
  for (const Event& event : trial.events) {
    if (event.kind == kind::game_hash) return SaidGameHash{event.tick, event.detail.text()};
  }
  return std::nullopt;
}

std::optional<std::uint64_t> game_hash_of_states(const TrialFile& trial) {
  const std::vector<Event>& events = trial.summary().events;
  auto event = events.begin();
  GameHash hash;
  std::uint64_t version = 0;
  std::int64_t tick = 0;
  TrialItems items(trial);
  while (const std::optional<TickState> state = items.next_state()) {
    if (state->tick != ++tick) return std::nullopt;
    for (; event != events.end() && event->tick <= tick; ++event) {
      if (event->kind != kind::version) continue;
      version = event->detail.value_or(Colour::blue) == Colour::red ? 1 : 2;
    }
    hash.add(state->hash, version);
  }
  if (tick == 0) return std::nullopt;
  return hash.value();
}

}  // namespace headpin::scene
