#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/live.h"
#include "apps/live_eyes.h"
#include "devices/lcm/link.h"
#include "devices/live/source.h"
#include "scene/play/run.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"

/// What a live session reports: on standard error while it runs, in its trial, and at its end.
namespace headpin::apps {

/// The state of a live session.
struct Live {
  std::shared_ptr<scene::RealTime> pace = std::make_shared<scene::RealTime>();
  std::vector<devices::OpenSource> sources;
  scene::Session session;
  std::unique_ptr<scene::TrialWriter> writer;
  std::unique_ptr<devices::LcmLink> link, session_link;  ///< to others
  std::unique_ptr<scene::TrialWriter> publisher;         ///< over the latter
  devices::TrialHeader header;                           ///< participant and condition
  scene::Totals totals;
  std::unique_ptr<scene::FramesBeside> eyes;
  std::int64_t samples = 0, bad_samples = 0, frames = 0, drawing_failures = 0;
  scene::FrameLatency latency;
};

/// Writes an event that belongs to no tick: to the recording and to the listeners.
void write(Live& live, const devices::Event& event);

/// Counts samples and frames, and prints a line about the session every ten seconds.
class Reporter : public scene::Observer {
 public:
  explicit Reporter(Live& live) : live_(live), said_(live.sources.size()) {}
  void tick(const scene::Session& session) override;
  void finish();

 private:
  void take_frames();
  void take_failures();
  devices::Event event_now(std::string_view kind, std::string detail) const;
  /// The last messages about a source.
  struct Said {
    std::string trouble;
    devices::FaultNews faults;
  };
  void report_trouble(const std::string& source, const std::string& trouble, Said& said);
  void report_faults(const std::string& source, const std::vector<std::string>& news);
  void report_loss();

  Live& live_;
  std::vector<Said> said_;  ///< of each source
  Time next_line_{10'000'000};
  Time next_look_{};  ///< at the recording
  bool lost_ = false;
};

/// The line that is printed every ten seconds.
void print_line(const Live& live);

/// The mean latency from a sample of the head to its frame, stage by stage.
void print_stages(const scene::FrameLatency& latency);

/// What `--json` prints.
nlohmann::json summary(const Live& live, const LiveOptions& options);

}  // namespace headpin::apps
