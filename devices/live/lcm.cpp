#include "devices/live/lcm.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "devices/lcm/datagrams.h"
#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "devices/trial/trial.h"

namespace headpin::devices {
namespace {

class LiveLcm : public LiveSource {
 public:
  LiveLcm(const std::string& name, LcmUrl url, const std::function<Time()>& clock)
      : LiveSource(name), link_(std::move(url)), source_(link_) {
    if (clock && !link_.is_replay()) source_.use_clock(clock);
  }

  void start(Genlock* genlock) override {
    if (!link_.is_replay()) source_.hold_to(genlock);
    source_.listen();
  }
  void poll(Time now, std::vector<Sample>& out) override { source_.poll(now, out); }
  bool exhausted() const override { return source_.exhausted(); }
  std::string activity() const override { return link_.is_replay() ? "playing" : "listening"; }

  std::vector<Amiss> amiss() const override {
    const LcmSource::Counts& c = source_.counts();
    return {
        {c.undecodable + c.implausible + c.foreign, unusable()},
        {c.others, others()},
        {c.unstamped, fmt::format("{} samples have no time of their own (device_utime is 0): "
                                  "each is taken to be measured when it came",
                                  c.unstamped)},
        {c.handovers, fmt::format("stations have changed their publisher {} times, after a second "
                                  "without a sample",
                                  c.handovers)},
        {c.clock_jumps, fmt::format("a publisher's clock has jumped {} times", c.clock_jumps)}};
  }

  /// The age and the delay of the newest sample of each publisher.
  std::string report(Time now) const override {
    std::string text =
        fmt::format("LCM {} lost on the way, {} dropped", source_.lost(), source_.counts().dropped);
    for (const auto& [device, publisher] : source_.publishers()) {
      if (const auto station = station_of(device)) text += report(now, *station, publisher);
    }
    return text;
  }
  Counts counts() const override {
    const LcmSource::Counts& c = source_.counts();
    return {{"dropped_samples", c.dropped},         {"lost_samples", source_.lost()},
            {"other_publishers_samples", c.others}, {"unstamped_samples", c.unstamped},
            {"clock_jumps", c.clock_jumps},         {"undecodable", c.undecodable},
            {"implausible", c.implausible},         {"foreign", c.foreign}};
  }

  std::string recording() const override {
    return link_.is_replay() ? link_.url().log()->path : std::string();
  }

 private:
  static std::string report(Time now, std::int32_t station, const LcmSource::Publisher& publisher) {
    const Time ahead = publisher.device_time - now;
    if (ahead > Time{}) {
      return fmt::format(", station {} {:.0f} ms ahead of the session's clock", station,
                         1e3 * seconds(ahead));
    }
    return fmt::format(", station {} {:.0f} ms old, came {:.0f} ms late", station,
                       -1e3 * seconds(ahead), 1e3 * seconds(std::max(publisher.late(), Time{})));
  }

  std::string unusable() const {
    const LcmSource::Counts& c = source_.counts();
    return fmt::format(
        "messages that cannot be used: {} of another type or size than TRACKER's and MOUSE3D's, {} "
        "with impossible numbers, {} in another frame than \"T\"",
        c.undecodable, c.implausible, c.foreign);
  }

  /// The publishers whose samples are skipped, and those whose samples are used.
  std::string others() const {
    std::string text;
    for (const auto& [device, publisher] : source_.publishers()) {
      if (publisher.others == 0) continue;
      text += fmt::format("{}{} has more than one publisher: {} samples left out",
                          text.empty() ? "" : "; ", device_name(device), publisher.others);
      if (publisher.other == 0) continue;
      text += fmt::format(", the last from {} while {} sent it", sender_name(publisher.other),
                          sender_name(publisher.beside));
    }
    return text;
  }

  LcmLink link_;
  LcmSource source_;
};

}  // namespace

std::unique_ptr<LiveSource> live_lcm(const std::string& name, const std::string& url,
                                     const SourceOptions& options) {
  return std::make_unique<LiveLcm>(name, LcmUrl(url, "lcm:", LcmUse::reading), options.clock);
}

}  // namespace headpin::devices
