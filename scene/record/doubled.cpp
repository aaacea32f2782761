#include "scene/record/doubled.h"

#include <unordered_set>

#include "base/hash.h"

namespace headpin::scene {

std::vector<std::int64_t> find_doubled(Messages messages) {
  std::vector<std::int64_t> found;
  std::unordered_set<std::uint64_t> seen;
  while (messages.next()) {
    Fnv hash;
    for (const std::uint8_t byte : messages.bytes()) hash.add(byte);
    if (!seen.insert(hash.value()).second) found.push_back(messages.number());
  }
  return found;
}

}  // namespace headpin::scene
