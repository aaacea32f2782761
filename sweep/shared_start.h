#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/base/sources.h"
#include "scene/play/session.h"
#include "sweep/result.h"

/// The part of a replay that many conditions share.
namespace headpin::sweep {

/// A replay that has begun, and what it has come to so far.
struct Run {
  scene::Session session;
  devices::ReplaySource source;
  Result sum;
};

/// Elasticity, friction and response do not matter until two bodies touch. So rows that differ in these alone
/// start from one copy, just before the first touch: in the bundled trial after four of its seven seconds.
class SharedStart {
 public:
  /// Makes a replay at its start.
  using Begin = std::function<Run()>;

  /// A replay for the rows of a text, see text_of_others(). The second row of a text simulates the start
  /// that it and the next ones share.
  ///
  /// @param begin  for this row
  /// @param check  called at every tick of a start; may throw
  Run run_of(const std::string& text, const Begin& begin, const std::function<void()>& check);

  /// Tells when bodies touched first in the replay of the last row, if they did.
  void learn(std::optional<std::int64_t> first_touch);

 private:
  struct Start {
    std::string text;
    std::optional<std::int64_t> first_touch;  ///< tick; none before it is known
    std::optional<Run> run;
  };
  Start& start_of(const std::string& text);

  std::deque<Start> starts_;  ///< the last one is that of the last row
};

/// Whether bodies have touched in the last tick.
bool is_touched(const scene::Session& session);

/// What decides how a row begins: its trial, and its values but those of elasticity, friction and response.
///
/// @param values  of the keys, in their order
std::string text_of_others(std::size_t trial, const std::vector<std::string>& keys,
                           const std::vector<std::string>& values);

}  // namespace headpin::sweep
