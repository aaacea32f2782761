#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "devices/fastrak/emulator.h"
#include "devices/live/source.h"
#include "devices/recordings/recorded_motion.h"
#include "devices/trial/file.h"

/// What an emulated Fastrak measures.
namespace headpin::apps {

struct FeedOptions {
  std::string trial;              ///< empty: a test pattern
  std::string motion = "circle";  ///< the test pattern
  std::string place = "auto";     ///< of the transmitter: auto or recorded
  double longest_gap = seconds(devices::kLongestGap);
  bool loop = false, with_buttons = false;
};

/// The motion that the unit measures: a test pattern, or a recording that starts when a client
/// requests records.
struct Feed {
  devices::FastrakMotion motion;
  devices::FastrakPlace place;        ///< of the transmitter, in a recording's frame
  std::string says;                   ///< message about the transmitter's place
  Time begin{}, length{};             ///< of a recording
  devices::TrackerSample first = {};  ///< of a recording
  bool loop = false, pressed = false;
  std::vector<devices::MouseSample> buttons = {};  ///< of a recording's mouse, where they change

  /// The time within the recording.
  Time within(Time time) const {
    if (length == Time{}) return time;
    const Time t = time > begin ? time - begin : Time{};
    return loop ? t % length : t;
  }
  devices::FastrakTruth at(int station, Time time) const {
    devices::FastrakTruth truth = motion(station, within(time));
    truth.pressed = truth.pressed || pressed;
    return truth;
  }
};

/// @throws std::runtime_error  naming the trial that cannot be read, or that has no sample
Feed feed_of(const FeedOptions& options);

/// The newest samples that others publish on TRACKER and MOUSE3D.
class LcmFeed {
 public:
  explicit LcmFeed(const std::string& url);
  void poll(Time now);
  devices::FastrakTruth at(int station) const;

 private:
  devices::Clocks clocks_;
  devices::OpenSource lcm_;
  devices::FaultNews faults_;
  std::array<devices::FastrakTruth, devices::kFastrakStations> newest_;
  bool trigger_ = false;
  std::vector<devices::Sample> samples_;
};

}  // namespace headpin::apps
