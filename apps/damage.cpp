#include "apps/damage.h"

#include "apps/streams.h"
#include "devices/trial/file.h"

namespace headpin::apps {

void say_what_is_missing(std::string_view command, const std::string& path,
                         const devices::TrialSummary& trial) {
  if (trial.complete) return;
  say("headpin {}: {}: {}; see `headpin info`\n", command, printable(path),
      devices::what_is_missing(trial));
}

}  // namespace headpin::apps
