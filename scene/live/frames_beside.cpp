#include "scene/live/frames_beside.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace headpin::scene {

namespace {

double seconds_between(RealTime::Clock::time_point a, RealTime::Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

void FrameLatency::add(const FrameStages& stages) {
  each.add(stages.sum());
  total.ticked += stages.ticked;
  total.waited += stages.waited;
  total.drawn += stages.drawn;
  total.published += stages.published;
}

FrameStages FrameLatency::mean() const {
  const auto n = static_cast<double>(std::max<std::int64_t>(1, each.count()));
  return {total.ticked / n, total.waited / n, total.drawn / n, total.published / n};
}

DrawerHere::DrawerHere(Eyes eyes, std::unique_ptr<FrameSink> sink)
    : eyes_(std::move(eyes)),
      sink_(std::move(sink)),
      drawn_by_(render::fingerprint(eyes_.renderer)) {
  see(eyes_, {}, frame_.images);  // compiles the shaders before the first frame
}

std::optional<DrawnFrame> DrawerHere::draw(const FrameJob& job) {
  frame_.number = job.frame;
  frame_.tick = job.tick;
  frame_.time = job.time;
  frame_.views = see(eyes_, job.glimpse, frame_.images);
  DrawnFrame done;
  done.drawn = RealTime::Clock::now();
  done.record = record_of(frame_);
  if (sink_) sink_->add(frame_);
  done.published = RealTime::Clock::now();
  return done;
}

FramesBeside::FramesBeside(Maker maker)
    : thread_([this, maker = std::move(maker)] { work(maker); }) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ready_ || failure_; });
  if (!failure_) return;
  lock.unlock();
  thread_.join();
  std::rethrow_exception(failure_);
}

FramesBeside::~FramesBeside() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FramesBeside::tick(const Session& session) {
  const Rates& rates = session.scenario().rates;
  const Time now = session.now();
  if (session.player.head_arrival != newest_) {
    newest_ = session.player.head_arrival;
    since_ = now;
    taken_ = Clock::now();
  }
  if (tick_time(frame_, rates.frame_hz) - lead_ > now) return;
  const std::int64_t first = frame_++;
  while (tick_time(frame_, rates.frame_hz) - lead_ <= now) ++frame_;
  const std::int64_t frame = frame_ - 1;  // the newest that is due; those before it are late
  const std::optional<Pose> X_WD = head_pose(session);
  if (!X_WD) return;
  late_ += frame - first;
  Offer due{{frame, session.tick, now, glimpse(session, *X_WD)}, {}, Clock::now()};
  if (pace_ && newest_ != shown_) {  // latency is measured for new samples only
    due.stages = {.ticked = seconds_between(pace_->at(*newest_), taken_),
                  .waited = seconds_between(taken_, due.at)};
    const Time tick = tick_time(1, rates.physics_hz);
    // One frame interval is enough if the tracker has the frame rate; at other rates nothing helps.
    if (now - since_ > tick && lead_ < tick_time(1, rates.frame_hz)) lead_ += tick;
  }
  shown_ = newest_;
  if (!offer(std::move(due))) ++late_;
}

/// @return  whether the frame will be drawn
bool FramesBeside::offer(Offer offer) {
  {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    if (offer_ || busy_) return false;
    offer_ = std::move(offer);
  }
  changed_.notify_all();
  return true;
}

std::vector<FramesBeside::Done> FramesBeside::take_done() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

std::vector<std::string> FramesBeside::take_failures() {
  const std::lock_guard lock(mutex_);
  return std::exchange(failures_, {});
}

std::int64_t FramesBeside::late() const {
  const std::lock_guard lock(mutex_);
  return late_ + lost_;
}

void FramesBeside::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || (!offer_ && !busy_); });
  if (failure_) std::rethrow_exception(failure_);
}

void FramesBeside::work(const Maker& maker) {
  try {
    const std::unique_ptr<FrameDrawer> drawer = maker();
    drawn_by_ = drawer->drawn_by();
    std::unique_lock lock(mutex_);
    ready_ = true;
    changed_.notify_all();
    for (;;) {
      changed_.wait(lock, [this] { return offer_ || closing_; });
      if (!offer_) return;
      const Offer offer = std::move(*offer_);
      offer_.reset();
      busy_ = true;
      lock.unlock();
      draw(*drawer, offer);
      lock.lock();
      busy_ = false;
      changed_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}

void FramesBeside::draw(FrameDrawer& drawer, const Offer& offer) {
  try {
    const std::optional<DrawnFrame> drawn = drawer.draw(offer.job);
    const std::lock_guard lock(mutex_);
    if (!drawn) {
      ++lost_;
      return;
    }
    Done& done = done_.emplace_back(Done{drawn->record, offer.stages});
    if (!done.stages) return;
    done.stages->drawn = seconds_between(offer.at, drawn->drawn);
    done.stages->published = seconds_between(drawn->drawn, drawn->published);
  } catch (const DrawingFailed& failed) {
    const std::lock_guard lock(mutex_);
    ++lost_;
    failures_.emplace_back(failed.what());
  }
}

}  // namespace headpin::scene
