// headpin conformance at a unit whose receivers move.

#include <algorithm>
#include <array>
#include <chrono>
#include <stop_token>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "devices/fastrak/motion.h"
#include "devices/fastrak/serving.h"
#include "devices/lines/tcp.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

/// A line that counts the readings (P) of a try that were answered. The receivers move after each.
class CountedReadings : public devices::ByteStream {
 public:
  std::size_t read(std::span<std::uint8_t> out) override {
    const std::size_t n = server.read(out);
    if (std::ranges::count(out.first(n), std::uint8_t{'W'}) > 0) {  // a try begins
      answered = 0;
      asked_ = false;
    }
    asked_ |= std::ranges::count(out.first(n), std::uint8_t{'P'}) > 0;
    return n;
  }
  std::size_t write(devices::Bytes bytes) override {
    if (!bytes.empty() && std::exchange(asked_, false)) ++answered;
    return server.write(bytes);
  }
  bool renewed() override { return server.renewed(); }
  bool closed() const override { return server.closed(); }

  devices::TcpServer server{0};
  std::size_t answered = 0;

 private:
  bool asked_ = false;
};

/// About z [rad], at each of the 15 readings. Where the form is the first one, the receivers go and come
/// back, so that the readings around it show no motion; the others do.
constexpr std::array<double, 15> kTurned = {0, 2, 0, 0, 2, 2, 0, 0, 2, 2, 0, 0, 2, 2, 0};

// It exited with 0 though it had skipped the readings, and nothing else shows these.
TEST_F(CommandLine, ConformanceFailsWhereReceiversMoveTooFarToTellAnything) {
  CountedReadings line;
  devices::FastrakEmulatorOptions options;
  options.faults = devices::parse_faults("noise=0");
  devices::FastrakEmulator unit(options, [&line](int station, Time time) {
    devices::FastrakTruth truth = devices::still_motion(station, time);
    truth.X_TS.q = rotation(kTurned[line.answered % kTurned.size()] * Vec3::UnitZ());
    return truth;
  });
  std::jthread serving([&](const std::stop_token& over) {
    const auto start = std::chrono::steady_clock::now();
    while (!over.stop_requested()) {
      devices::serve(unit, line,
                     std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const Result result =
      headpin("conformance " + line.server.name() + " --client VESS --seconds 0.5 --json");
  serving.request_stop();
  serving.join();
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("of the readings: hold the receivers still\n"));
  const nlohmann::json told = nlohmann::json::parse(result.out);
  const nlohmann::json& readings = told["clients"][0];
  EXPECT_EQ(readings["skipped"], true) << told;
  EXPECT_EQ(readings["why"], "the receivers move: hold them still for the readings");
  EXPECT_EQ(readings["tries"], 2);
  EXPECT_EQ(told["clients"][1]["why"], nullptr);
  EXPECT_EQ(told["clients"][1]["unmet"].size(), 0u) << told;
}

}  // namespace
}  // namespace headpin
