#pragma once

#include <array>
#include <string>
#include <vector>

#include "devices/fastrak/codec.h"
#include "devices/fastrak/motion.h"
#include "devices/live/source.h"

namespace headpin::devices {

/// The newest samples that others publish on TRACKER and MOUSE3D, as the motion of an emulated unit.
class LcmFeed {
 public:
  /// @throws as open_device
  explicit LcmFeed(const std::string& url);

  /// Takes what has arrived. @return  faults in it, as FaultNews tells them
  std::vector<std::string> poll(Time now);

  /// Of station 1 to 4; at rest, as in still_motion, until a sample of it has come.
  FastrakTruth at(int station) const;

 private:
  Clocks clocks_;
  OpenSource lcm_;
  FaultNews faults_;
  std::array<FastrakTruth, kFastrakStations> newest_;
  bool trigger_ = false;
  std::vector<Sample> samples_;
};

}  // namespace headpin::devices
