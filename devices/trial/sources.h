#pragma once

#include <vector>

#include "devices/base/source.h"

/// Sources that hand out what others or a recording have, all by one rule.
namespace headpin::devices {

/// When a sample was there: when it arrived, or when it was measured if it never crossed a wire.
Time arrival(const Sample& sample);

/// When a session may know of a sample: when it was there, or when a recorded session got it. Live
/// and replayed sessions hand samples out by this one rule.
Time available(const Sample& sample);

/// A recording as a source: hands out the samples of a trial by the time they were available.
class ReplaySource : public Source {
 public:
  explicit ReplaySource(std::vector<Sample> samples);

  void poll(Time now, std::vector<Sample>& out) override;
  bool exhausted() const override { return next_ == samples_.size(); }

  /// When the last sample becomes available; 0 without any.
  Time end() const { return samples_.empty() ? Time{} : available(samples_.back()); }

 private:
  std::vector<Sample> samples_;
  std::size_t next_ = 0;
};

/// Several sources as one, each sample as soon as a replay would have it.
class MergedSource : public Source {
 public:
  explicit MergedSource(std::vector<Source*> sources) : sources_(std::move(sources)) {}

  void poll(Time now, std::vector<Sample>& out) override;
  /// When all of them are and nothing waits.
  bool exhausted() const override;

 private:
  std::vector<Source*> sources_;  // must outlive this
  std::vector<Sample> waiting_;
};

}  // namespace headpin::devices
