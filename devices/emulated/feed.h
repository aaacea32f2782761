#pragma once

#include "devices/base/sample.h"
#include "devices/fastrak/motion.h"

namespace headpin::devices {

/// What an emulated unit measures: the motion of somebody who stands there now, or a recording that
/// starts when a client requests records.
struct Feed {
  FastrakMotion motion;
  bool recorded = false;
  bool loop = false;         ///< the recording starts again at its end; otherwise it rests there
  bool pressed = false;      ///< the switch, beside what the motion says
  Time begin{}, length{};    ///< of a recording
  TrackerSample first = {};  ///< of a recording

  /// The time within the recording.
  Time within(Time time) const {
    if (length == Time{}) return time;
    const Time t = time > begin ? time - begin : Time{};
    return loop ? t % length : t;
  }
  FastrakTruth at(int station, Time time) const {
    FastrakTruth truth = motion(station, within(time));
    truth.pressed = truth.pressed || pressed;
    return truth;
  }
};

}  // namespace headpin::devices
