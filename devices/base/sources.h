#pragma once

#include <vector>

#include "devices/base/source.h"

/// Sources that replay recordings or merge other sources, by the same rule.
namespace headpin::devices {

/// The time of arrival of a sample, or the time at which its device told it if it was not
/// transmitted. A predicted pose arrives before the time that it is for.
Time arrival(const Sample& sample);

/// The time from which a session may use a sample: its arrival, or the time at which a recorded
/// session used it. Live and replayed sessions follow the same rule.
Time available(const Sample& sample);

/// A recording as a source: returns the samples of a trial by the time at which they were
/// available.
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

/// Several sources as one; each sample is returned as soon as in a replay.
class MergedSource : public Source {
 public:
  explicit MergedSource(std::vector<Source*> sources) : sources_(std::move(sources)) {}

  void poll(Time now, std::vector<Sample>& out) override;
  /// True when all sources are exhausted and no sample waits.
  bool exhausted() const override;

 private:
  std::vector<Source*> sources_;  // must outlive this
  std::vector<Sample> waiting_;
};

}  // namespace headpin::devices
