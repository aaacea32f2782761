#include "scene/record/doubled.h"

#include <optional>
#include <unordered_set>
#include <variant>

#include "base/hash.h"

namespace headpin::scene {

std::vector<std::int64_t> find_doubled(Messages messages) {
  std::vector<std::int64_t> found;
  std::unordered_set<std::uint64_t> seen;
  while (const std::optional<Message> message = messages.next()) {
    if (std::holds_alternative<Snapshot>(*message)) continue;  // has no number of its own
    Fnv hash;
    for (const std::uint8_t byte : messages.bytes()) hash.add(byte);
    if (!seen.insert(hash.value()).second) found.push_back(messages.number());
  }
  return found;
}

}  // namespace headpin::scene
