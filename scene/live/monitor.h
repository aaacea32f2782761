#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/live/frames_beside.h"
#include "scene/live/sources.h"
#include "scene/live/trial_outputs.h"
#include "scene/play/run.h"

/// How a live session is going.
namespace headpin::scene {

/// The state of a live session, beside that of its game.
struct LiveState {
  struct Source {
    std::string name;
    devices::SourceStatus status;
  };

  Time now{};
  std::int64_t samples = 0, bad_samples = 0;  ///< bad: their status is not a space
  std::int64_t frames = 0, late_frames = 0, drawing_failures = 0;
  std::int64_t overruns = 0;      ///< ticks that began after the next one was due
  std::int64_t fresh_frames = 0;  ///< that showed a new sample of the head
  double latency_median_s = 0.0, latency_p99_s = 0.0;  ///< from that sample to its frame, to 1 %
  FrameStages latency_mean;
  std::vector<Source> sources;
};

/// Something that a person should know now.
struct LiveNews {
  Time time{};
  std::string text;
};

/// Counts samples and frames, and notices what goes wrong with sources, pictures and the recording.
/// Frames, and news with an event of their own, go into the trial.
class LiveMonitor : public Observer {
 public:
  /// All must outlive this.
  LiveMonitor(const LiveSources& sources, const RealTime& pace, FramesBeside& eyes,
              TrialOutputs& trial);

  void tick(const Session& session) override;
  /// Takes what has come since the last tick; to be called when the eyes have finished.
  void finish(const Session& session);

  /// The news since the last call.
  std::vector<LiveNews> take_news();

  LiveState state(const Session& session) const;

  /// The event that says how well the session kept real time.
  Event kept_pace(const Session& session) const;

 private:
  /// The last messages about a source.
  struct Said {
    std::string trouble;
    devices::FaultNews faults;
  };
  void take_frames();
  void take_failures(const Session& session);
  void look_at_sources(const Session& session);
  void tell_trouble(const Session& session, const std::string& source, const std::string& trouble,
                    Said& said);
  void tell_faults(const Session& session, const std::string& source,
                   const std::vector<std::string>& faults);
  void look_at_recording(const Session& session);
  void write(const Session& session, std::string_view kind, std::string detail);

  const LiveSources& sources_;
  const RealTime& pace_;
  FramesBeside& eyes_;
  TrialOutputs& trial_;
  std::int64_t samples_ = 0, bad_samples_ = 0, frames_ = 0, drawing_failures_ = 0;
  FrameLatency latency_;
  std::vector<Said> said_;  ///< of each source
  std::vector<LiveNews> news_;
  Time next_look_{};  ///< at the recording
  bool lost_ = false;
};

}  // namespace headpin::scene
