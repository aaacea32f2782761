#include "devices/base/sources.h"

#include <algorithm>
#include <iterator>

namespace headpin::devices {

Time arrival(const Sample& sample) {
  return std::visit([](const auto& s) { return std::max(s.told(), s.host_time); }, sample);
}

Time available(const Sample& sample) {
  const Time got = std::visit([](const auto& s) { return s.session_time; }, sample);
  return std::max(arrival(sample), got);
}

ReplaySource::ReplaySource(std::vector<Sample> samples) : samples_(std::move(samples)) {
  std::ranges::stable_sort(samples_, {}, available);
}

void ReplaySource::poll(Time now, std::vector<Sample>& out) {
  for (; next_ < samples_.size() && available(samples_[next_]) <= now; ++next_) {
    out.push_back(samples_[next_]);
  }
}

void MergedSource::poll(Time now, std::vector<Sample>& out) {
  for (Source* source : sources_) source->poll(now, waiting_);
  std::ranges::stable_sort(waiting_, {}, available);
  const auto later = std::ranges::upper_bound(waiting_, now, {}, available);
  std::move(waiting_.begin(), later, std::back_inserter(out));
  waiting_.erase(waiting_.begin(), later);
}

bool MergedSource::exhausted() const {
  return waiting_.empty() &&
         std::ranges::all_of(sources_, [](const Source* source) { return source->exhausted(); });
}

}  // namespace headpin::devices
