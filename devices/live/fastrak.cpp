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
  LiveFastrak(std::unique_ptr<ByteStream> line, Clocks& clocks, const SourceOptions& options)
      : driver_(stamped(std::move(line), options.clock), clocks, options.fastrak) {}

  void start() override {
    if (stamps_) stamps_->start();
  }
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
  /// With a clock, the line is read by a thread that notes when bytes arrive.
  std::unique_ptr<ByteStream> stamped(std::unique_ptr<ByteStream> line,
                                      const std::function<Time()>& clock) {
    if (!clock) return line;
    auto stream = std::make_unique<StampedStream>(std::move(line), clock);
    stamps_ = stream.get();
    return stream;
  }

  StampedStream* stamps_ = nullptr;  ///< within the driver; before it, as it is set with it
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
  return {.name = name,
          .source =
              std::make_unique<LiveFastrak>(open_line(line, options.fastrak.baud), clocks, options),
          .has_stylus = true};
}

}  // namespace headpin::devices
