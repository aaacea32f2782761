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
  /// @param line  the stream within the driver, if it has a thread to start; else null
  LiveFastrak(const std::string& name, std::unique_ptr<ByteStream> stream, StampedStream* line,
              Clocks& clocks, const FastrakOptions& options)
      : LiveSource(name), line_(line), driver_(std::move(stream), clocks, options) {}

  void start() override {
    if (line_) line_->start();
  }
  void poll(Time now, std::vector<Sample>& out) override { driver_.poll(now, out); }
  bool exhausted() const override { return driver_.exhausted(); }
  std::string activity() const override { return driver_.activity(); }
  std::string trouble() const override { return driver_.trouble(); }
  bool has_stylus() const override { return true; }

  std::string report(Time) const override {
    const FastrakStatistics& f = driver_.statistics();
    std::string text = fmt::format("Fastrak {}, {} records missed, {} bytes skipped, {} restarts",
                                   activity(), f.missed, f.skipped_bytes, f.restarts);
    for (const std::string& setting : driver_.unconfirmed()) text += ", " + setting;
    return text;
  }
  Counts counts() const override {
    const FastrakStatistics& f = driver_.statistics();
    return {{"records", f.records},
            {"skipped_bytes", f.skipped_bytes},
            {"missed", f.missed},
            {"restarts", f.restarts}};
  }

 private:
  StampedStream* line_;
  FastrakDriver driver_;
};

}  // namespace

std::unique_ptr<LiveSource> live_fastrak(const std::string& name, const std::string& line,
                                         Clocks& clocks, const SourceOptions& options) {
  if (line.empty()) {
    throw std::invalid_argument(
        name +
        " expected the name of a serial port or tcp:HOST:PORT after the colon, found nothing");
  }
  std::unique_ptr<ByteStream> stream = open_line(line, options.fastrak.baud);
  StampedStream* stamped = nullptr;
  if (options.clock) {
    auto reader = std::make_unique<StampedStream>(std::move(stream), options.clock);
    stamped = reader.get();
    stream = std::move(reader);
  }
  return std::make_unique<LiveFastrak>(name, std::move(stream), stamped, clocks, options.fastrak);
}

}  // namespace headpin::devices
