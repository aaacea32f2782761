#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "render/fingerprint.h"
#include "scene/play/delays.h"
#include "scene/watch/eye_frames.h"

/// Frames of both eyes, drawn while a live session runs.
namespace headpin::scene {

/// The stages of the latency from the arrival of a head's sample until its frame is published [s].
struct FrameStages {
  double ticked = 0.0;     ///< until the session had used it in a tick
  double waited = 0.0;     ///< waiting for the tick at which a frame was due
  double drawn = 0.0;      ///< until both pictures were drawn
  double published = 0.0;  ///< until they were encoded and sent

  double sum() const { return ticked + waited + drawn + published; }
};

/// The latencies of all frames with a new sample.
struct FrameLatency {
  Delays each;  ///< sums of the stages
  FrameStages total;

  void add(const FrameStages& stages);
  /// Of a frame; all 0 before the first one.
  FrameStages mean() const;
};

/// A frame to draw, with all necessary data.
struct FrameJob {
  std::int64_t frame = 0, tick = 0;
  Time time{};
  Glimpse glimpse;
};

/// The result.
struct DrawnFrame {
  FrameRecord record;
  RealTime::Clock::time_point drawn, published;  ///< when both pictures, when the sink had them
};

/// Drawing failed and a frame is lost; the session continues.
struct DrawingFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Draws a live session's frames, in this or in another process.
class FrameDrawer {
 public:
  virtual ~FrameDrawer() = default;
  virtual const render::Fingerprint& drawn_by() const = 0;
  /// @return  nothing if no more frames can be drawn, which was reported before
  /// @throws DrawingFailed  once for each failure
  virtual std::optional<DrawnFrame> draw(const FrameJob& job) = 0;
};

/// Draws in the calling thread. After construction it is ready to draw.
class DrawerHere : public FrameDrawer {
 public:
  /// @param sink  null: frames are not published
  DrawerHere(Eyes eyes, std::unique_ptr<FrameSink> sink);
  const render::Fingerprint& drawn_by() const override { return drawn_by_; }
  std::optional<DrawnFrame> draw(const FrameJob& job) override;

 private:
  Eyes eyes_;
  std::unique_ptr<FrameSink> sink_;
  EyeFrame frame_;
  render::Fingerprint drawn_by_;
};

/// Draws frames in parallel with the session, which never waits: one frame at a time. A frame that
/// is due while another one is drawn is dropped; of several that are due at one tick, as with more
/// frames than ticks a second, the newest is drawn.
class FramesBeside : public Observer {
 public:
  /// What was drawn.
  struct Done {
    FrameRecord record;
    std::optional<FrameStages> stages;  ///< if it showed a new sample
  };
  /// Called in the thread that uses the result.
  using Maker = std::function<std::unique_ptr<FrameDrawer>()>;
  using Clock = RealTime::Clock;

  /// Returns when the first frame can be drawn.
  /// @throws  what the maker throws
  explicit FramesBeside(Maker maker);
  ~FramesBeside() override;

  /// Sets the clock for latencies; it must outlive this.
  void measure_by(const RealTime& pace) { pace_ = &pace; }

  void tick(const Session& session) override;
  /// Frames that were finished since the last call.
  std::vector<Done> take_done();
  /// Failures since the last call.
  std::vector<std::string> take_failures();
  /// Waits for the current frame, so that it is recorded; to be called at the end.
  /// @throws  what drawing threw
  void finish();
  /// Frames that were due and were not drawn: another was being drawn, a newer one was due at the same
  /// tick, or drawing failed.
  std::int64_t late() const;
  const render::Fingerprint& drawn_by() const { return drawn_by_; }

 private:
  struct Offer {
    FrameJob job;
    std::optional<FrameStages> stages;  ///< up to `at`, when the newest sample in it is fresh
    Clock::time_point at;
  };

  bool offer(Offer offer);
  void work(const Maker& maker);
  void draw(FrameDrawer& drawer, const Offer& offer);

  const RealTime* pace_ = nullptr;
  std::int64_t frame_ = 0, late_ = 0;
  std::optional<Time> newest_, shown_;  // arrival of the head sample at hand, and in the last frame
  Time since_{};                        // when the session got the newest
  Clock::time_point taken_;             // and had made that tick
  render::Fingerprint drawn_by_;        // written before the constructor comes back
  Time lead_{};  // of the frames' clock: brings them close behind the head's samples

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Offer> offer_;
  std::vector<Done> done_;
  std::vector<std::string> failures_;  // of drawing
  std::int64_t lost_ = 0;              // frames, to them
  std::exception_ptr failure_;         // of this
  bool ready_ = false, busy_ = false, closing_ = false;
  std::thread thread_;  // last, so that all it uses is there before it starts
};

}  // namespace headpin::scene
