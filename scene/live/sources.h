#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/live/source.h"

namespace headpin::scene {

/// The sources of a live session as one, merged by the rule of replays. A stylus switch is the
/// trigger if there is no mouse.
class LiveSources : public devices::Source {
 public:
  explicit LiveSources(std::vector<devices::OpenSource> sources);

  /// To be called when the session's clock starts; earlier samples are discarded.
  void start() const;

  void poll(Time now, std::vector<devices::Sample>& out) override { merged_->poll(now, out); }
  bool exhausted() const override { return merged_->exhausted(); }

  const std::vector<devices::OpenSource>& each() const { return each_; }

 private:
  std::vector<devices::OpenSource> each_;
  std::unique_ptr<devices::Source> merged_;  ///< of them
};

}  // namespace headpin::scene
