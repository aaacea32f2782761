#include "scene/record/source.h"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/record/file.h"

namespace headpin::scene {
namespace {

/// A trial, played by the session's clock.
class LiveTrial : public devices::LiveSource {
 public:
  explicit LiveTrial(const std::string& path) : file_(path), player_(file_) {
    file_.require_trial(devices::kLongestGap);
  }

  void poll(Time now, std::vector<devices::Sample>& out) override { player_.poll(now, out); }
  bool exhausted() const override { return player_.exhausted(); }
  devices::SourceStatus status(Time now) const override {
    devices::SourceStatus status;
    status.activity = exhausted() ? "at its end" : "playing";
    status.line = fmt::format("{} {:.1f} of {:.1f} s", status.activity, seconds(now),
                              seconds(file_.summary().end));
    return status;
  }

 private:
  TrialFile file_;
  TrialPlayer player_;
};

}  // namespace

devices::OpenSource open_source(const std::string& name, devices::Clocks& clocks,
                                const devices::SourceOptions& options) {
  if (auto device = devices::open_device(name, clocks, options)) return std::move(*device);
  const std::size_t colon = name.find(':');
  if (colon != std::string::npos && name.find('/') > colon && !std::filesystem::exists(name)) {
    throw std::invalid_argument(fmt::format(
        "unknown kind of source '{}'; expected fastrak:LINE, lcm:URL, or the file of a trial",
        name.substr(0, colon)));
  }
  return {.name = name, .source = std::make_unique<LiveTrial>(name), .recording = name};
}

}  // namespace headpin::scene
