#include "apps/damage.h"

#include "apps/streams.h"
#include "scene/record/file.h"

namespace headpin::apps {

void say_what_is_missing(std::string_view command, const std::string& path,
                         const scene::TrialSummary& trial) {
  const std::string missing = scene::what_is_missing(trial);
  if (missing.empty()) return;
  say("headpin {}: {}: {}; see `headpin info`\n", command, printable(path), missing);
}

}  // namespace headpin::apps
