#pragma once

#include <memory>
#include <optional>

#include "devices/base/source.h"

/// The 3D mouse: left thumb walks forward, right thumb backward, the trigger grabs.
///
/// The Fastrak's protocol carries one switch (output item 16), so a Fastrak alone gives the trigger
/// only. All three buttons travel as MouseSamples on a channel of our own: MOUSE3D in a trial and
/// over LCM (types/mouse3d_t.lcm). How the mouse of 1997 reached its computer is not known.
namespace headpin::devices {

/// Converts the stylus switch in tracker samples to changes of the trigger.
class StylusTrigger {
 public:
  /// @param station  whose records carry the switch; 0: any
  explicit StylusTrigger(std::int32_t station = 0) : station_(station) {}

  /// @return  the mouse's new state, if this sample changes it. Its time is halfway between this
  ///   record and the one before, because the switch moved in between. The first sample gives a
  ///   state only if the trigger is down. Samples with an error letter count too, because the
  ///   switch does not depend on the pose.
  std::optional<MouseSample> update(const TrackerSample& sample);

 private:
  std::int32_t station_;
  bool down_ = false;
  std::optional<Time> before_;  ///< time of the last record
};

/// A tracker source that adds the mouse: it passes all samples on, and adds a MouseSample after
/// each sample that changes the switch, with the same arrival time.
///
/// When the source itself has MouseSamples (a trial, LCM), the switch is ignored, because there is
/// a real mouse.
class StylusMouse : public Source {
 public:
  explicit StylusMouse(std::unique_ptr<Source> tracker, std::int32_t station = 0)
      : tracker_(std::move(tracker)), trigger_(station) {}

  void poll(Time now, std::vector<Sample>& out) override;
  bool exhausted() const override { return tracker_->exhausted(); }

 private:
  std::unique_ptr<Source> tracker_;
  StylusTrigger trigger_;
  bool own_line_ = false;
  std::vector<Sample> polled_;
};

}  // namespace headpin::devices
