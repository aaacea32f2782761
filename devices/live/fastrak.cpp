#include "devices/live/fastrak.h"

#include <stdexcept>

#include <fmt/format.h>

#include "devices/fastrak/driver.h"
#include "devices/lines/lasting_line.h"
#include "devices/lines/stamped_stream.h"

namespace headpin::devices {
namespace {

class LiveFastrak : public LiveSource {
 public:
  LiveFastrak(std::unique_ptr<ByteStream> stream, Clocks& clocks, const FastrakOptions& options)
      : driver_(std::move(stream), clocks, options) {}

  void poll(Time now, std::vector<Sample>& out) override { driver_.poll(now, out); }
  bool exhausted() const override { return driver_.exhausted(); }

  SourceStatus status(Time) const override {
    const FastrakStatistics& f = driver_.statistics();
    SourceStatus status;
    status.activity = driver_.activity();
    status.trouble = driver_.trouble();
    status.counts = {{"records", f.records},
                     {"skipped_bytes", f.skipped_bytes},
                     {"missed", f.missed},
                     {"restarts", f.restarts}};
    status.line = fmt::format("Fastrak {}, {} records missed, {} bytes skipped, {} restarts",
                              status.activity, f.missed, f.skipped_bytes, f.restarts);
    for (const std::string& setting : driver_.unconfirmed()) status.line += ", " + setting;
    return status;
  }

 private:
  FastrakDriver driver_;
};

}  // namespace

OpenSource live_fastrak(const std::string& name, const std::string& line, Clocks& clocks,
                        const SourceOptions& options) {
  if (line.empty()) {
    throw std::invalid_argument(
        name +
        " expected the name of a serial port or tcp:HOST:PORT after the colon, found nothing");
  }
  OpenSource opened{.name = name, .has_stylus = true};
  std::unique_ptr<ByteStream> stream = open_line(line, options.fastrak.baud);
  if (options.clock) {
    auto reader = std::make_unique<StampedStream>(std::move(stream), options.clock);
    opened.start = [line = reader.get()] { line->start(); };  // within the driver
    stream = std::move(reader);
  }
  opened.source = std::make_unique<LiveFastrak>(std::move(stream), clocks, options.fastrak);
  return opened;
}

}  // namespace headpin::devices
