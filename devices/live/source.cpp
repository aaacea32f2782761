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
  explicit LiveTrial(const std::string& path) : LiveSource(path), file_(path), player_(file_) {
    file_.require_trial(kLongestGap);
  }

  void poll(Time now, std::vector<Sample>& out) override { player_.poll(now, out); }
  bool exhausted() const override { return player_.exhausted(); }
  std::string activity() const override { return exhausted() ? "at its end" : "playing"; }
  std::string report(Time now) const override {
    return fmt::format("{} {:.1f} of {:.1f} s", activity(), seconds(now),
                       seconds(file_.summary().end));
  }
  std::string recording() const override { return name(); }

 private:
  TrialFile file_;
  TrialPlayer player_;
};

/// A kind of source, by the prefix of its names.
struct Kind {
  std::string_view prefix;
  std::unique_ptr<LiveSource> (*open)(const std::string& name, const std::string& where,
                                      Clocks& clocks, const SourceOptions& options);
};

constexpr std::array kKinds = {
    Kind{"fastrak:", live_fastrak},
    Kind{"lcm:", live_lcm},
};

}  // namespace

std::vector<std::string> AmissNews::take(const LiveSource& source, Time now) {
  if (now < next_) return {};
  std::vector<std::string> news = take_rest(source);
  if (!news.empty()) next_ = now + Time{10'000'000};
  return news;
}

std::vector<std::string> AmissNews::take_rest(const LiveSource& source) {
  const std::vector<LiveSource::Amiss> amiss = source.amiss();
  said_.resize(amiss.size());
  std::vector<std::string> news;
  for (std::size_t i = 0; i < amiss.size(); ++i) {
    if (std::exchange(said_[i], amiss[i].count) != amiss[i].count) news.push_back(amiss[i].what);
  }
  return news;
}

std::unique_ptr<LiveSource> open_source(const std::string& name, Clocks& clocks,
                                        const SourceOptions& options) {
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
  return std::make_unique<LiveTrial>(name);
}

}  // namespace headpin::devices
