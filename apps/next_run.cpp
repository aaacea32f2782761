#include "apps/next_run.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "apps/streams.h"
#include "base/left_parts.h"

namespace headpin::apps {
namespace {

void require_none_done(const std::vector<Run>& runs, const std::string& id) {
  if (const Run* done = counting(runs)) {
    throw PlayedAlready(
        fmt::format("{}: {} has played already ({:.1f} s); a session is played only once",
                    done->path.string(), id, done->seconds));
  }
}

}  // namespace

void leave_to_person(const std::vector<Run>& runs, const std::string& id) {
  if (const Run* const persons = of_person(runs)) {
    throw PersonsSession(
        fmt::format("{} is left out: {} is a person's", id, persons->path.string()));
  }
}

NextRun::NextRun(const Study& study, const std::string& id, const std::string& command,
                 bool is_virtual)
    : folder_(study.at.sessions(id)) {
  renew(study, id, command, is_virtual);
}

void NextRun::lock(const std::string& id) {
  if (lock_ && lock_->is_of(folder_)) return;
  std::filesystem::create_directories(folder_);
  lock_.emplace(folder_, "playing the session of " + id);
}

void NextRun::require_unplayed(const Study& study, const std::string& id) {
  lock(id);
  require_none_done(runs_of(study, id), id);
}

void NextRun::renew(const Study& study, const std::string& id, const std::string& command,
                    bool is_virtual) {
  lock(id);
  base::remove_left_parts(folder_.string());
  const std::vector<Run> runs = runs_of(study, id);
  require_none_done(runs, id);
  if (is_virtual) leave_to_person(runs, id);
  int last = 0;
  for (const Run& run : runs) {
    last = std::max(last, run_number(run.name).value_or(0));
    say("{}: {} is kept: {}\n", command, run.path.string(), why_not(run));
  }
  path_ = (folder_ / fmt::format("run-{:02}.lcmlog", last + 1)).string();
}

}  // namespace headpin::apps
