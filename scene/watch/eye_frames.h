#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/looks/eyes.h"
#include "scene/play/run.h"
#include "scene/record/file.h"

/// Frames of both eyes, drawn while a trial is replayed.
namespace headpin::scene {

/// One drawn frame of both eyes, left first.
struct EyeFrame {
  std::int64_t number = 0, tick = 0;
  Time time{};
  std::array<render::View, 2> views;
  std::array<render::Image, 2> images;
  std::array<render::Labels, 2> labels;  ///< where they are wanted
  std::vector<render::DrawItem> items;   ///< likewise: the objects, with their poses
};

/// Options of drawing a frame.
struct FrameExtras {
  bool pictures = true;  ///< else only the views
  bool labels = false;
  std::optional<Pose> X_WC = {};  ///< viewpoint instead of the head
};

/// The record of a frame in a trial.
FrameRecord record_of(const EyeFrame& frame);

/// Destination of drawn frames: a folder, a video, LCM.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void add(const EyeFrame& frame) = 0;
};

/// Draws every wanted frame at its own time, at the first tick that is not before it; the session
/// waits.
class FrameByFrame : public Observer {
 public:
  struct Plan {
    std::int64_t fps = 60;
    std::int64_t frames = 0;                           ///< frames 0 .. frames - 1
    std::function<bool(std::int64_t frame)> wanted;    ///< those of them to draw
    Pose X_WD_first;                                   ///< head until a sample of it has come
    std::function<void(std::int64_t drawn)> progress;  ///< told after each
    FrameExtras extras = {};
  };

  /// @param eyes, sinks  must outlive this
  FrameByFrame(Eyes& eyes, Plan plan, std::vector<FrameSink*> sinks)
      : eyes_(eyes), plan_(std::move(plan)), sinks_(std::move(sinks)) {}

  void start(const Session& session) override { tick(session); }
  void tick(const Session& session) override;

  std::int64_t drawn() const { return drawn_; }

 private:
  Eyes& eyes_;
  Plan plan_;
  std::vector<FrameSink*> sinks_;
  BetweenTicks before_;
  EyeFrame frame_;
  std::int64_t drawn_ = 0;
};

/// Draws the recorded frames of a trial, each at its tick, and compares them with the recorded
/// hashes. Those at whose tick no pose of the head is known are left out.
class FramesAsShown : public Observer {
 public:
  struct Plan {
    bool compare = true;                               ///< pictures with the recorded hashes
    std::function<bool(std::int64_t frame)> wanted;    ///< those of them to draw
    std::function<void(std::int64_t drawn)> progress;  ///< told after each
    FrameExtras extras = {};
  };

  /// @param recorded  with the frames beside it
  /// @param eyes      all must outlive this
  /// @throws std::runtime_error  when there are no frames
  FramesAsShown(Eyes& eyes, TrialPlayer& recorded, Plan plan, std::vector<FrameSink*> sinks = {});

  /// @throws std::runtime_error  naming frame and eye of the first that differs
  void tick(const Session& session) override;

  std::int64_t drawn() const { return drawn_; }
  std::int64_t compared() const { return compared_; }  ///< frames found equal

 private:
  void draw(const FrameRecord& recorded, const Session& session, const Pose& X_WD);
  void compare(const FrameRecord& recorded) const;

  Eyes& eyes_;
  TrialPlayer& recorded_;
  Plan plan_;
  std::vector<FrameSink*> sinks_;
  EyeFrame frame_;
  std::int64_t drawn_ = 0, compared_ = 0;
};

}  // namespace headpin::scene
