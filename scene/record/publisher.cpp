#include "scene/record/publisher.h"

#include <algorithm>

#include "devices/base/sources.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"

namespace headpin::scene {
namespace {

template <typename T>
void publish_on(devices::LcmLink& link, std::string_view channel, const T& message) {
  devices::Buffer bytes;
  encode(message, bytes);
  link.publish(channel, bytes);
}

void publish(devices::LcmLink& link, const devices::Sample& sample) {
  link.publish(sample);
}

void publish(devices::LcmLink& link, const TickState& state) {
  publish_on(link, kStateChannel, state);
}

void publish(devices::LcmLink& link, const FrameRecord& frame) {
  publish_on(link, kFrameChannel, frame);
}

}  // namespace

void publish(devices::LcmLink& link, const TrialHeader& header) {
  publish_on(link, kTrialChannel, header);
}

void publish(devices::LcmLink& link, const Event& event) {
  publish_on(link, kEventChannel, event);
}

TrialPublisher::TrialPublisher(devices::LcmLink& link, const TrialHeader& header)
    : link_(link), header_(stamped(header)) {
  publish(link_, header_);
  next_header_ = Time{1'000'000};
}

template <typename T>
void TrialPublisher::send(Time time, const T& message) {
  last_ = std::max(last_, time);
  if (last_ >= next_header_) {
    publish(link_, header_);
    if (drawn_by_) publish(link_, *drawn_by_);
    next_header_ = last_ + Time{1'000'000};
  }
  publish(link_, message);
  ++count_;
}

void TrialPublisher::write(const devices::Sample& sample) {
  send(available(sample), sample);
}

void TrialPublisher::write(const Event& event) {
  send(event.time, event);
  if (event.kind == kDrawnByEvent) drawn_by_ = event;
}

void TrialPublisher::write(const TickState& state) {
  send(state.time, state);
}

void TrialPublisher::write(const FrameRecord& frame) {
  send(frame.time, frame);
}

void TrialPublisher::close() {
  Event end;
  end.time = last_;
  end.kind = kEndEvent;
  end.value = static_cast<double>(count_);
  send(end.time, end);
}

}  // namespace headpin::scene
