#include "devices/emulated/mouse.h"

#include <algorithm>

namespace headpin::devices {

void EmulatedMouse::publish(Time now, Time at) {
  const auto later = std::ranges::upper_bound(recorded_, at, {}, &MouseSample::device_time);
  const auto until = static_cast<std::size_t>(later - recorded_.begin());
  if (until < told_) told_ = 0;  // the trial has started again
  for (; told_ < until; ++told_) {
    then_ = recorded_[told_];
    tell(now - at + then_.device_time);
  }
  tell(now);
}

void EmulatedMouse::tell(Time time) {
  MouseSample mouse;
  mouse.device_time = time;
  mouse.left_thumb = typed.left_thumb || then_.left_thumb;
  mouse.right_thumb = typed.right_thumb || then_.right_thumb;
  mouse.trigger = typed.trigger || then_.trigger;
  const std::array state = {mouse.left_thumb, mouse.right_thumb, mouse.trigger};
  const bool again = !recorded_.empty() && std::chrono::abs(time - told_at_) >= kAgain;
  if (state == told_last_ && !again) return;
  told_last_ = state;
  told_at_ = time;
  link_.publish(Sample(mouse));
}

}  // namespace headpin::devices
