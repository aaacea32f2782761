#pragma once

#include <cstdint>
#include <string>

namespace headpin::apps {

struct ParticipantSession {
  std::string output, scenario, name, condition;
  std::uint64_t seed = 1;
  int throws = 10;
  bool force = false, json = false;
};

/// Lets the virtual participant of a seed play a session, writes its device samples and prints the
/// result, like `headpin synthesize --participant`.
void play_session(const ParticipantSession& options);

}  // namespace headpin::apps
