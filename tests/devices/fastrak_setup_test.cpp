// A unit's settings as a driver makes them and reads them back, and what a station reports with them.

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/setup.h"
#include "devices/fastrak/solution.h"
#include "tests/devices/fastrak_bench.h"
#include "tests/devices/fastrak_unit.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using testing::StartsWith;

Bytes as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(FastrakSetupTest, AZenithIsSetForTheFirstStationAndTheLast) {
  FastrakZeniths zeniths = zeniths_ahead();
  read_zenith("1:0,0,1", zeniths);
  read_zenith("4:0,1,0", zeniths);
  EXPECT_THAT(zeniths,
              testing::ElementsAre(Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitY()));
}

// Three rows of a matrix, plain or extended; two of them are no orientation.
TEST(FastrakSetupTest, AnOrientationIsTheBestFormInTheList) {
  EXPECT_EQ(attitude_of({2, 4, 5, 6, 7, 11, 1}), FastrakAttitude::quaternion);
  EXPECT_EQ(attitude_of({2, 4, 5, 6, 7, 1}), FastrakAttitude::matrix);
  EXPECT_EQ(attitude_of({2, 55, 6, 57, 1}), FastrakAttitude::matrix);
  for (const std::vector<int>& rows : {std::vector<int>{5, 6}, {6, 7}, {5, 7}, {5}, {6}, {7}, {}}) {
    std::vector<int> items = rows;
    EXPECT_THROW(attitude_of(items), std::invalid_argument);
    items.push_back(4);
    EXPECT_EQ(attitude_of(items), FastrakAttitude::angles);
  }
}

TEST(FastrakSetupTest, AListMayNameTheCompactItemsOfEarlyFirmware) {
  EXPECT_NO_THROW(check_items({18, 20, 0}));
  EXPECT_NO_THROW(check_items({18, 19, 1}));
  EXPECT_THROW(check_items({18, 21, 0}), std::invalid_argument);
}

TEST(FastrakSetupTest, APositionBeyondThePossibleOneIsNone) {
  FastrakRecord record{.error = 'k', .position = Vec3(0.0, -kFastrakFarthest, 0.0)};
  const FastrakFormat format = {{2, 4, 1}, true, true};
  EXPECT_NEAR(pose_of(record, format).p.y(), -100.0, 1e-9);  // metres
  record.position.y() = -1.0001 * kFastrakFarthest;
  EXPECT_EQ(pose_of(record, format).p, Vec3::Zero());
}

TEST(FastrakSetupTest, TheUnitIsSetUpIfItsStatusSaysSoInEveryFlag) {
  const auto verdict = [](bool centimetres, bool binary, bool continuous) {
    FastrakStatus status;
    status.centimetres = centimetres;
    status.binary = binary;
    status.continuous = continuous;
    const std::string answer = encode_status(status);
    return judge({}, {}, as_bytes(answer));
  };
  EXPECT_EQ(verdict(true, false, false), FastrakVerdict::as_said);
  EXPECT_EQ(verdict(false, false, false), FastrakVerdict::otherwise);
  EXPECT_EQ(verdict(true, true, false), FastrakVerdict::otherwise);
  EXPECT_EQ(verdict(true, false, true), FastrakVerdict::otherwise);
}

TEST(FastrakSetupTest, AnAnswerIsOneWhenItsLineHasEnded) {
  const FastrakCheck check{'H', 1, {1.0, 0.0, 0.0}};
  const std::string line = "21H   1.00   0.00   0.00\r\n";
  EXPECT_EQ(judge(check, {}, as_bytes(line)), FastrakVerdict::as_said);
  const std::string before = "\r\n" + line;
  EXPECT_EQ(judge(check, {}, as_bytes(before)), FastrakVerdict::as_said);
  for (std::size_t length = 0; length < line.size(); ++length) {
    const std::string part = line.substr(0, length);
    EXPECT_EQ(judge(check, {}, as_bytes(part)), FastrakVerdict::no_answer) << length;
  }
}

// 200 cm along the axes of an unaligned frame are 78.74 in.
TEST(FastrakSetupTest, ADriverInInchesIsServedAsOneInCentimetres) {
  FastrakOptions options;
  options.centimetres = false;
  test::Bench bench(test::unit("noise=0"), options);
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_EQ(bench.driver.statistics().attempts, 1);
  EXPECT_THAT(bench.driver.unconfirmed(), testing::IsEmpty());
  EXPECT_FALSE(bench.driver.unit()->centimetres);
  bench.sent.clear();
  bench.run(500ms);
  ASSERT_GT(bench.samples.size(), 20u);
  for (std::size_t i = 0; i < bench.samples.size(); ++i) {
    const TrackerSample& s = test::tracker(bench.samples[i]);
    const Pose truth = circling_motion(s.station, bench.sent[i].measured).X_TS;
    EXPECT_LT((s.X_TS.p - truth.p).norm(), 1e-6);
  }
}

/// A line on which the commands with this beginning are lost.
class Losing : public ByteStream {
 public:
  Losing(std::unique_ptr<ByteStream> line, std::string command)
      : line_(std::move(line)), command_(std::move(command)) {}
  std::size_t read(std::span<std::uint8_t> out) override { return line_->read(out); }
  std::size_t write(Bytes bytes) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.starts_with(command_) ? bytes.size() : line_->write(bytes);
  }
  bool closed() const override { return line_->closed(); }

 private:
  std::unique_ptr<ByteStream> line_;
  std::string command_;
};

// Their records are right as far as they come: an increment holds some back, an envelope flags some.
TEST(FastrakSetupTest, AnIncrementOrAnEnvelopeThatIsNotSetIsOnlyMentioned) {
  for (const std::string letter : {"I", "V", "Q"}) {
    auto [line, host] = memory_streams();
    test::Bench bench(test::unit("noise=0"), {},
                      {std::move(line), std::make_unique<Losing>(std::move(host), letter + "1,")});
    const std::string left = "I1,1\rQ1,170,80,170,-170,-80,-170\r";
    bench.emulator.receive(as_bytes(left), bench.now);
    ASSERT_TRUE(bench.run_until_streaming());
    EXPECT_EQ(bench.driver.statistics().attempts, 1);
    EXPECT_THAT(bench.driver.unconfirmed(),
                testing::ElementsAre(letter + "1: set, and reads otherwise"));
  }
}

// --- What a station reports ------------------------------------------------------------------

TEST(FastrakSolutionTest, AQuaternionIsOfUnitLengthAndItsScalarIsNotNegative) {
  const auto sent = [](const Quat& q) {
    const FastrakSolution solution{.X_TS = {q, Vec3(0.4, 0.0, 0.0)}};
    const FastrakRecord record = record_of({}, solution, Vec3::Zero(), kMetrePerInch);
    EXPECT_LT((record.attitude * record.attitude.transpose() - Mat3::Identity()).norm(), 1e-12);
    return record.quaternion;
  };
  using testing::DoubleNear;
  const auto reads = [](double w, double x, double y, double z) {
    return testing::ElementsAre(DoubleNear(w, 1e-12), DoubleNear(x, 1e-12), DoubleNear(y, 1e-12),
                                DoubleNear(z, 1e-12));
  };
  EXPECT_THAT(sent(Quat(2.0, 0.0, 0.0, 0.0)), reads(1.0, 0.0, 0.0, 0.0));
  EXPECT_THAT(sent(Quat(-0.6, 0.0, 0.8, 0.0)), reads(0.6, 0.0, -0.8, 0.0));
  EXPECT_THAT(sent(Quat(0.0, 1.0, 0.0, 0.0)), reads(0.0, 1.0, 0.0, 0.0));  // half a turn stays
}

TEST(FastrakMotionTest, APoseIsSeenFromTheNewPlace) {
  const FastrakMotion moved = seen_from({.p_TP = Vec3(1.0, -2.0, 3.0)}, circling_motion);
  const Pose before = circling_motion(2, 1s).X_TS, after = moved(2, 1s).X_TS;
  EXPECT_EQ(after.p, before.p - Vec3(1.0, -2.0, 3.0));
  EXPECT_EQ(after.q.coeffs(), before.q.coeffs());
}

TEST(FastrakHearingTest, ALineOf254BytesIsOneAndOf255TooLong) {
  const auto line = [](std::size_t length) {
    const std::string begin = "H1,", end = "3,0,0";
    return begin + std::string(length - begin.size() - end.size(), ' ') + end;
  };
  Unit unit;
  EXPECT_THAT(unit.ask(line(255) + "\r"), testing::HasSubstr("EC -5"));
  EXPECT_EQ(unit.ask("H1\r"), "21H   1.00   0.00   0.00\r\n");
  EXPECT_EQ(unit.ask(line(254) + "\r"), "");
  EXPECT_EQ(unit.ask("H1\r"), "21H   3.00   0.00   0.00\r\n");
}

TEST(FastrakFaultTest, ANumberIsReadToItsEnd) {
  for (const char* spec : {"noise=3x", "noise=1e999", "noise=", "deaf=2 3", "silence=4s@1"}) {
    EXPECT_THROW(parse_faults(spec), std::invalid_argument) << spec;
  }
}

}  // namespace
}  // namespace headpin::devices
