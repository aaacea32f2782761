#pragma once

#include <string>
#include <utility>
#include <vector>

#include "devices/log/event_log.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices::test {

/// The samples of a log, in its order, with the times of their events.
inline std::vector<Stamped<Sample>> stamped_samples_of(const std::string& path) {
  FileWindow file(path);
  LogReader reader(file);
  std::vector<Stamped<Sample>> samples;
  while (const auto event = reader.next()) {
    if (auto sample = decode_sample(event->channel, event->data)) {
      samples.push_back({event->time, std::move(*sample)});
    }
  }
  return samples;
}

inline std::vector<Sample> samples_of(const std::string& path) {
  std::vector<Sample> samples;
  for (Stamped<Sample>& one : stamped_samples_of(path)) samples.push_back(std::move(one.value));
  return samples;
}

}  // namespace headpin::devices::test
