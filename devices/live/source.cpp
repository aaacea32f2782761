#include "devices/live/source.h"

#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "devices/live/fastrak.h"
#include "devices/live/lcm.h"
#include "devices/trial/file.h"

namespace headpin::devices {
namespace {

/// A trial, played by the session's clock.
class LiveTrial : public LiveSource {
 public:
  explicit LiveTrial(const std::string& path) : file_(path), player_(file_) {
    file_.require_trial(kLongestGap);
  }

  void poll(Time now, std::vector<Sample>& out) override { player_.poll(now, out); }
  bool exhausted() const override { return player_.exhausted(); }
  SourceStatus status(Time now) const override {
    SourceStatus status;
    status.activity = exhausted() ? "at its end" : "playing";
    status.line = fmt::format("{} {:.1f} of {:.1f} s", status.activity, seconds(now),
                              seconds(file_.summary().end));
    return status;
  }

 private:
  TrialFile file_;
  TrialPlayer player_;
};

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

OpenSource open_source(const std::string& name, Clocks& clocks, const SourceOptions& options) {
  for (const Kind& kind : kKinds) {
    if (name.starts_with(kind.prefix)) {
      return kind.open(name, name.substr(kind.prefix.size()), clocks, options);
    }
  }
  const std::size_t colon = name.find(':');
  if (colon != std::string::npos && name.find('/') > colon && !std::filesystem::exists(name)) {
    throw std::invalid_argument(fmt::format(
        "unknown kind of source '{}'; expected fastrak:LINE, lcm:URL, or the file of a trial",
        name.substr(0, colon)));
  }
  return {.name = name, .source = std::make_unique<LiveTrial>(name), .recording = name};
}

}  // namespace headpin::devices
