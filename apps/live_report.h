#pragma once

#include <nlohmann/json.hpp>

#include "apps/live.h"
#include "scene/live/monitor.h"
#include "scene/watch/totals.h"

/// What `headpin live` prints about a session.
namespace headpin::apps {

/// Prints the news of a session at once, and a line about it every ten seconds.
class Reporter : public scene::Observer {
 public:
  /// Both must outlive this, and see each tick before it.
  Reporter(scene::LiveMonitor& monitor, const scene::Totals& totals)
      : monitor_(monitor), totals_(totals) {}

  void tick(const scene::Session& session) override;
  void say_news();

 private:
  scene::LiveMonitor& monitor_;
  const scene::Totals& totals_;
  Time next_line_{10'000'000};
};

/// The line that is printed every ten seconds.
void print_line(const scene::LiveState& state, const scene::Totals& totals);

/// The mean latency from a sample of the head to its frame, stage by stage; nothing without a frame.
void print_stages(const scene::LiveState& state);

/// What `--json` prints.
nlohmann::json summary(const scene::Session& session, const scene::LiveState& state,
                       const scene::Totals& totals, const LiveOptions& options);

}  // namespace headpin::apps
