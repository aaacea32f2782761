#include "devices/live/source.h"

#include <array>
#include <string_view>

#include "devices/live/fastrak.h"
#include "devices/live/lcm.h"

namespace headpin::devices {
namespace {

/// A kind of source, by the prefix of its names.
struct Kind {
  std::string_view prefix;
  OpenSource (*open)(const std::string& name, const std::string& where, Clocks& clocks,
                     const SourceOptions& options);
};

constexpr std::array kKinds = {
    Kind{"fastrak:", live_fastrak},
    Kind{"lcm:", live_lcm},
};

}  // namespace

std::vector<std::string> FaultNews::take(const std::vector<SourceFault>& faults, Time now) {
  if (now < next_) return {};
  std::vector<std::string> news = take_rest(faults);
  if (!news.empty()) next_ = now + Time{10'000'000};
  return news;
}

std::vector<std::string> FaultNews::take_rest(const std::vector<SourceFault>& faults) {
  said_.resize(faults.size());
  std::vector<std::string> news;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (std::exchange(said_[i], faults[i].count) != faults[i].count) news.push_back(faults[i].what);
  }
  return news;
}

std::optional<OpenSource> open_device(const std::string& name, Clocks& clocks,
                                      const SourceOptions& options) {
  for (const Kind& kind : kKinds) {
    if (name.starts_with(kind.prefix)) {
      return kind.open(name, name.substr(kind.prefix.size()), clocks, options);
    }
  }
  return std::nullopt;
}

}  // namespace headpin::devices
