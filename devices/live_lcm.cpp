#include "devices/live_lcm.h"

#include <string_view>

#include <fmt/format.h>

#include "devices/lcm_link.h"

namespace headpin::devices {
namespace {

class LiveLcm : public LiveSource {
 public:
  LiveLcm(const std::string& name, const std::string& url, const std::function<Time()>& clock)
      : LiveSource(name), link_(url), source_(link_) {
    if (clock && !link_.is_replay()) source_.use_clock(clock);
  }

  void start(Genlock* genlock) override {
    if (!link_.is_replay()) source_.hold_to(genlock);
    source_.drain();
  }
  void poll(Time now, std::vector<Sample>& out) override { source_.poll(now, out); }
  bool exhausted() const override { return source_.exhausted(); }
  std::string activity() const override { return link_.is_replay() ? "playing" : "listening"; }

  std::int64_t unusable() const override {
    const LcmSource::Counts& c = source_.counts();
    return c.undecodable + c.implausible + c.foreign;
  }
  std::string unusable_report() const override {
    const LcmSource::Counts& c = source_.counts();
    return fmt::format(
        "{} of another type or size than TRACKER's and MOUSE3D's, {} with numbers that cannot be, "
        "{} in another frame than \"T\"",
        c.undecodable, c.implausible, c.foreign);
  }

  /// How old the newest sample of each publisher is, and how late it came.
  std::string report(Time now) const override {
    std::string text = fmt::format("LCM {} dropped", source_.counts().dropped);
    for (const auto& [station, publisher] : source_.publishers()) {
      if (station == LcmSource::kMouse) continue;
      text +=
          fmt::format(", station {} {:.0f} ms old, came {:.0f} ms late", station,
                      1e3 * seconds(now - publisher.device_time), 1e3 * seconds(publisher.late()));
    }
    return text;
  }
  Counts counts() const override {
    const LcmSource::Counts& c = source_.counts();
    return {{"dropped_samples", c.dropped},
            {"undecodable", c.undecodable},
            {"implausible", c.implausible},
            {"foreign", c.foreign}};
  }

  std::string recording() const override {
    if (!link_.is_replay()) return {};
    const std::string path = link_.url().substr(std::string_view("file://").size());
    return path.substr(0, path.find('?'));
  }

 private:
  LcmLink link_;
  LcmSource source_;
};

}  // namespace

std::unique_ptr<LiveSource> live_lcm(const std::string& name, const std::string& url,
                                     const SourceOptions& options) {
  return std::make_unique<LiveLcm>(name, url, options.clock);
}

}  // namespace headpin::devices
