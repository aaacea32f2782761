#pragma once

#include <string>
#include <vector>

#include "devices/emulated/feed.h"
#include "devices/recordings/recorded_motion.h"
#include "scene/record/file.h"
#include "scene/record/unit.h"

/// What `headpin emulate` measures.
namespace headpin::apps {

struct FeedOptions {
  std::string trial;              ///< empty: a test pattern
  std::string motion = "circle";  ///< the test pattern
  std::string place = "auto";     ///< of the transmitter: auto or recorded
  double longest_gap = seconds(devices::kLongestGap);
  bool loop = false;
};

/// A test pattern, or a trial with what belongs to it.
struct Played {
  devices::Feed feed;
  devices::FastrakPlace place;                ///< of the transmitter, in a recording's frame
  std::string says;                           ///< message about the transmitter's place
  std::vector<devices::MouseSample> buttons;  ///< of a recording's mouse, where they change
};

/// @throws std::runtime_error  naming the trial that cannot be read, or that has no sample
Played play(const FeedOptions& options);

}  // namespace headpin::apps
