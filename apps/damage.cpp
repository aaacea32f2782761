#include "apps/damage.h"

#include <vector>

#include <fmt/ranges.h>

#include "apps/streams.h"

namespace headpin::apps {

void say_what_is_missing(std::string_view command, const std::string& path,
                         const devices::TrialSummary& trial) {
  if (trial.complete) return;
  const devices::Skipped& skipped = trial.skipped;
  std::vector<std::string> unread;
  if (const auto n =
          skipped.undecodable + skipped.implausible + skipped.baseless + skipped.misdated;
      n > 0) {
    unread.push_back(fmt::format("{} messages", n));
  }
  if (const auto n = skipped.bytes + skipped.cut_bytes; n > 0) {
    unread.push_back(fmt::format("{} bytes", n));
  }
  say("headpin {}: {}: is incomplete: it ends at {:.3f} s{}; see `headpin info`\n", command,
      printable(path), seconds(trial.last.value_or(Time{})),
      unread.empty() ? "" : fmt::format("; {} of it cannot be read", fmt::join(unread, " and ")));
}

}  // namespace headpin::apps
