#include "devices/live/lcm.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "devices/lcm/datagrams.h"
#include "devices/lcm/link.h"
#include "devices/lcm/log_source.h"
#include "devices/lcm/source.h"

namespace headpin::devices {
namespace {

using Publisher = LcmIntake::Publisher;

std::string unusable(const LcmIntake::Counts& c) {
  return fmt::format(
      "messages that cannot be used: {} of another type or size than TRACKER's and MOUSE3D's, {} "
      "with impossible numbers, {} in another frame than \"T\"",
      c.undecodable, c.implausible, c.foreign);
}

/// The publishers whose samples are skipped, and those whose samples are used.
std::string others(const LcmIntake& intake) {
  std::string text;
  for (const auto& [device, publisher] : intake.publishers()) {
    if (publisher.others == 0) continue;
    text += fmt::format("{}{} has more than one publisher: {} samples left out",
                        text.empty() ? "" : "; ", device_name(device), publisher.others);
    if (publisher.other == 0) continue;
    text += fmt::format(", the last from {} while {} sent it", sender_name(publisher.other),
                        sender_name(publisher.beside));
  }
  return text;
}

std::vector<SourceFault> faults_in(const LcmIntake& intake) {
  const LcmIntake::Counts& c = intake.counts();
  return {
      {c.undecodable + c.implausible + c.foreign, unusable(c)},
      {c.others, others(intake)},
      {c.unstamped, fmt::format("{} samples have no time of their own (device_utime is 0): "
                                "each is taken to be measured when it came",
                                c.unstamped)},
      {c.handovers, fmt::format("stations have changed their publisher {} times, after a second "
                                "without a sample",
                                c.handovers)},
      {c.clock_jumps, fmt::format("a publisher's clock has jumped {} times", c.clock_jumps)}};
}

std::string report_on(Time now, std::int32_t station, const Publisher& publisher) {
  const Time ahead = publisher.told - now;
  if (ahead > Time{}) {
    return fmt::format(", station {} {:.0f} ms ahead of the session's clock", station,
                       1e3 * seconds(ahead));
  }
  return fmt::format(", station {} {:.0f} ms old, came {:.0f} ms late", station,
                     1e3 * seconds(-ahead), 1e3 * seconds(std::max(publisher.late(), Time{})));
}

/// The age and the delay of the newest sample of each publisher.
std::string report_on(Time now, const LcmIntake& intake) {
  std::string text =
      fmt::format("LCM {} lost on the way, {} dropped", intake.lost(), intake.counts().dropped);
  for (const auto& [device, publisher] : intake.publishers()) {
    if (const auto station = station_of(device)) text += report_on(now, *station, publisher);
  }
  return text;
}

SourceStatus::Counts counts_of(const LcmIntake& intake) {
  const LcmIntake::Counts& c = intake.counts();
  return {{"dropped_samples", c.dropped},         {"lost_samples", intake.lost()},
          {"other_publishers_samples", c.others}, {"unstamped_samples", c.unstamped},
          {"clock_jumps", c.clock_jumps},         {"undecodable", c.undecodable},
          {"implausible", c.implausible},         {"foreign", c.foreign}};
}

SourceStatus status_of(const char* activity, Time now, const LcmIntake& intake) {
  return {.activity = activity,
          .trouble = "",
          .faults = faults_in(intake),
          .counts = counts_of(intake),
          .line = report_on(now, intake)};
}

/// What others publish now.
class LiveLcm : public LiveSource {
 public:
  LiveLcm(LcmUrl url, Clocks& clocks, const std::function<Time()>& clock)
      : link_(std::move(url)), source_(link_, clocks) {
    if (clock) source_.use_clock(clock);
  }

  void start() override { source_.listen(); }
  void poll(Time now, std::vector<Sample>& out) override { source_.poll(now, out); }
  bool exhausted() const override { return source_.exhausted(); }
  SourceStatus status(Time now) const override {
    return status_of("listening", now, source_.intake());
  }

 private:
  LcmLink link_;
  LcmSource source_;
};

/// What was published, from a log.
class LivePlayedLog : public LiveSource {
 public:
  explicit LivePlayedLog(const UrlOfLog& log) : source_(log) {}

  void poll(Time now, std::vector<Sample>& out) override { source_.poll(now, out); }
  bool exhausted() const override { return source_.exhausted(); }
  SourceStatus status(Time now) const override {
    return status_of("playing", now, source_.intake());
  }

 private:
  LogSource source_;
};

}  // namespace

OpenSource live_lcm(const std::string& name, const std::string& url, Clocks& clocks,
                    const SourceOptions& options) {
  const LcmUrl at(url, "lcm:", LcmUse::reading);
  if (const auto& log = at.log()) {
    return {.name = name, .source = std::make_unique<LivePlayedLog>(*log), .recording = log->path};
  }
  return {.name = name, .source = std::make_unique<LiveLcm>(at, clocks, options.clock)};
}

}  // namespace headpin::devices
