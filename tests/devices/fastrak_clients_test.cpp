#include <algorithm>
#include <cstring>
#include <functional>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "devices/fastrak/clients.h"
#include "devices/fastrak/readings.h"
#include "devices/fastrak/serving.h"
#include "devices/recordings/recorded_motion.h"
#include "tests/support/samples_of_log.h"

/// The start-up of every known Fastrak client, byte for byte, over a real pseudo-terminal: each
/// gets what it needs to go on, and then the whole bundled trial.
namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

/// Counts what goes out, so that the reader can wait for just that.
class Counted : public ByteStream {
 public:
  explicit Counted(ByteStream& stream) : stream_(stream) {}
  std::size_t read(std::span<std::uint8_t> out) override { return stream_.read(out); }
  std::size_t write(Bytes bytes) override {
    const std::size_t n = stream_.write(bytes);
    written += n;
    return n;
  }
  bool closed() const override { return stream_.closed(); }
  std::size_t written = 0;

 private:
  ByteStream& stream_;
};

FastrakEmulatorOptions plugged(int receivers, const std::string& faults = "noise=0") {
  FastrakEmulatorOptions options;
  options.receivers = receivers;
  options.faults = parse_faults(faults);
  return options;
}

/// A client's end of the line, and the unit at the other; waiting is simulated time.
class Client : public FastrakLine {
 public:
  enum class Tty { raw, left_as_it_is };

  explicit Client(FastrakEmulatorOptions options, Tty tty = Tty::raw,
                  FastrakMotion motion = circling_motion)
      : emulator(std::move(options), std::move(motion)), counted_(pty_), tty_(tty) {
    open();
  }
  ~Client() override { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void open() {
    fd_ = ::open(pty_.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    serve(emulator, counted_, now);
    received_ = counted_.written;
    if (tty_ == Tty::raw) {
      termios settings{};
      tcgetattr(fd_, &settings);
      cfmakeraw(&settings);
      cfsetspeed(&settings, B115200);
      tcsetattr(fd_, TCSANOW, &settings);
    }
  }
  /// What is sent from here on until `open` is lost, as on a real port.
  void close() { ::close(std::exchange(fd_, -1)); }

  void put(std::string_view text) override {
    ASSERT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    pollfd state{pty_.descriptor(), POLLIN, 0};
    ASSERT_EQ(::poll(&state, 1, 2000), 1);
    serve(emulator, counted_, now);
  }

  std::string wait(Time span, std::size_t enough = std::string::npos) override {
    for (const Time end = now + span; now < end && heard_.size() < enough;) {
      now += Time{500};
      serve(emulator, counted_, now);
      receive(0);
    }
    while (fd_ >= 0 && received_ < counted_.written && receive(2000)) {
    }
    const std::string rest = heard_.size() > enough ? heard_.substr(enough) : "";
    return std::exchange(heard_, rest).substr(0, enough);
  }

  void flush() override {
    while (received_ < counted_.written && receive(2000)) {
    }
    heard_.clear();
    tcflush(fd_, TCIFLUSH);
  }

  Time now{};
  FastrakEmulator emulator;

 private:
  bool receive(int patience_ms) {
    pollfd state{fd_, POLLIN, 0};
    if (fd_ < 0 || ::poll(&state, 1, patience_ms) != 1) return false;
    std::array<char, 1024> bytes{};
    const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
    if (n <= 0) return false;
    heard_.append(bytes.data(), static_cast<std::size_t>(n));
    received_ += static_cast<std::size_t>(n);
    return true;
  }

  PseudoTerminal pty_;
  Counted counted_;
  Tty tty_;
  int fd_ = -1;
  std::size_t received_ = 0;
  std::string heard_;
};

const FastrakClient& client_named(std::string_view name) {
  return *std::ranges::find(fastrak_clients(), name, &FastrakClient::name);
}

/// Start-up and records of a client, all of whose demands are met.
std::vector<FastrakRecord> expect_served(Client& line, std::string_view name, int stations,
                                         Time span) {
  std::vector<FastrakDemand> demands;
  const auto records = run_client(client_named(name), line, stations, span, demands);
  for (const FastrakDemand& demand : demands) {
    EXPECT_TRUE(demand.met) << demand.what << "; found " << demand.found;
  }
  return records;
}

std::string test_name(const testing::TestParamInfo<std::string_view>& info) {
  std::string name(info.param);
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> all;
  for (const FastrakClient& client : fastrak_clients()) all.push_back(client.name);
  return all;
}

/// A unit that does not do as it is told.
class Faulty : public Client {
 public:
  using Client::Client;
  void put(std::string_view text) override {
    if (text != ignores) Client::put(text);
  }
  std::string wait(Time span, std::size_t enough = std::string::npos) override {
    const std::size_t own = enough == std::string::npos ? enough : enough - (echoes ? 1 : 0);
    std::string heard = Client::wait(span, own);
    if (cuts && heard.size() >= 55) heard.erase(20, 1);
    if (spoils && sent() == "P") spoils(heard);
    return (echoes ? sent().substr(0, 1) : "") + heard;
  }
  std::string ignores;
  bool echoes = false, cuts = false;
  std::function<void(std::string& records)> spoils;
};

/// The first demand that a reading of the unit does not meet, whole.
std::string first_unmet(Faulty& line) {
  std::vector<FastrakDemand> demands;
  examine_readings(line, demands);
  const auto unmet = std::ranges::find(demands, false, &FastrakDemand::met);
  if (unmet == demands.end()) return "";
  return "sent " + unmet->sent + ", wanted " + unmet->what + ", got " + unmet->found;
}

TEST(FastrakClientsTest, AReadingIsHeldAgainstOneInTheOtherUnit) {
  for (int stations = 1; stations <= 4; ++stations) {
    Faulty good(plugged(stations, ""));
    std::vector<FastrakDemand> demands;
    EXPECT_EQ(examine_readings(good, demands), stations);
    EXPECT_EQ(first_unmet(good), "");
  }
  Faulty inches(plugged(2));
  inches.ignores = "u";
  EXPECT_THAT(
      first_unmet(inches),
      testing::MatchesRegex("sent 1 bytes 'u', wanted in centimetres the pose that it is in ASCII, "
                            "inches and angles, got station 1: .* m, and .* m in that form"));
  Faulty ascii(plugged(2));
  ascii.ignores = "f";
  EXPECT_THAT(first_unmet(ascii),
              testing::HasSubstr("wanted a set of 58 bytes, 29 for each station, got"));
}

// Places alone would not show it.
TEST(FastrakClientsTest, TheOrientationIsHeldAgainstEveryOtherForm) {
  const auto unmet_with = [](std::function<void(std::string&)> fault) {
    Faulty line(plugged(1), Client::Tty::raw, still_motion);
    line.spoils = std::move(fault);
    return first_unmet(line);
  };
  const auto rolled = [](std::string& records) {
    if (records.size() != 29) return;  // binary: the head, six numbers, CR LF
    const float roll = 90.0f;
    std::memcpy(records.data() + 23, &roll, sizeof roll);
  };
  EXPECT_THAT(unmet_with(rolled), testing::HasSubstr("wanted in binary the pose that"));
  const auto scalar_last = [](std::string& records) {
    if (records.size() == 54) std::rotate(&records[24], &records[31], &records[52]);
  };
  EXPECT_THAT(unmet_with(scalar_last), testing::HasSubstr("wanted as a quaternion the pose that"));
  const auto left_handed = [](std::string& records) {
    if (records.size() == 89) records.replace(80, 7, "-1.0000");
  };
  EXPECT_THAT(unmet_with(left_handed),
              testing::MatchesRegex(".*wanted as direction cosines the pose that .*, got station "
                                    "1: axes .*-1.000.* in that form"));
}

TEST(FastrakClientsTest, WhatAUnitSaysInsteadIsShownByteByByte) {
  Faulty echo(plugged(1));
  echo.echoes = true;
  EXPECT_THAT(first_unmet(echo),
              testing::StartsWith("sent 1 bytes 'S', wanted a status record of 55 "
                                  "bytes, got 56 bytes 'S21S"));
  Faulty cut(plugged(1));
  cut.cuts = true;
  EXPECT_THAT(first_unmet(cut),
              testing::StartsWith("sent 1 bytes 'S', wanted a status record of 55 "
                                  "bytes, got 54 bytes '21S"));
  std::vector<FastrakDemand> demands;
  EXPECT_EQ(examine_readings(cut, demands), 1);  // it goes on
  EXPECT_GT(demands.size(), 8u);
  // Each client says as much of what it lacks.
  Faulty deaf(plugged(1));
  deaf.ignores = "S";
  demands.clear();
  run_client(client_named("VRPN"), deaf, 1, 1s, demands);
  const auto unmet = std::ranges::find(demands, false, &FastrakDemand::met);
  ASSERT_NE(unmet, demands.end());
  EXPECT_EQ(unmet->sent, "1 bytes 'S'");
  EXPECT_EQ(unmet->found, "nothing");
}

class FastrakClientTest : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(All, FastrakClientTest, testing::ValuesIn(names()), test_name);

TEST_P(FastrakClientTest, GetsWhatItNeedsToGoOn) {
  for (int stations = client_named(GetParam()).least_stations; stations <= 4; ++stations) {
    SCOPED_TRACE(std::to_string(stations) + " receivers");
    Client line(plugged(stations), Client::Tty::left_as_it_is);
    EXPECT_GT(expect_served(line, GetParam(), stations, 2s).size(), 30u);
  }
}

/// A client's end of a line at another rate, which the unit has too.
class AtRate : public Client {
 public:
  explicit AtRate(FastrakEmulatorOptions options, FastrakMotion motion = still_motion)
      : Client(std::move(options), Tty::raw, std::move(motion)), baud_(emulator.baud()) {}
  int baud() const override { return baud_; }

 private:
  int baud_;
};

// Slow lines made good units fail: a unit drops whole records, so that two receivers have 40 records
// a second at 19200 baud, where the bytes alone would fit 60; a set takes longer than 60 ms, and 55 bytes
// longer than 40 ms.
TEST_P(FastrakClientTest, GetsAsMuchAsASlowLineCarries) {
  for (const int baud : {2400, 9600, 19200}) {
    for (int stations = 2; stations <= 4; stations += 2) {
      if (stations < client_named(GetParam()).least_stations) continue;
      SCOPED_TRACE(std::to_string(stations) + " receivers, " + std::to_string(baud) + " baud");
      FastrakEmulatorOptions options = plugged(stations);
      options.baud = baud;
      AtRate line(options);
      EXPECT_GT(expect_served(line, GetParam(), stations, 4s).size(), 10u);
    }
  }
}

TEST(FastrakClientsTest, ReadingsAgreeOnTheSlowestLine) {
  FastrakEmulatorOptions options = plugged(4);
  options.baud = 2400;
  AtRate line(options);
  std::vector<FastrakDemand> demands;
  EXPECT_EQ(examine_readings(line, demands), 4);
  for (const FastrakDemand& demand : demands) EXPECT_TRUE(demand.met) << demand.what;
  EXPECT_TRUE(std::ranges::none_of(demands, &FastrakDemand::receivers_move));
  // Receivers that make most of a turn between two readings: it was called a fault of the unit.
  AtRate turning(options, [](int, Time t) {
    return FastrakTruth{{rotation(Vec3(0.0, 0.0, 2.4 * seconds(t))), Vec3(0.4, 0.0, -0.1)}};
  });
  demands.clear();
  EXPECT_EQ(examine_readings(turning, demands), 4);
  for (const FastrakDemand& demand : demands) EXPECT_TRUE(demand.met) << demand.found;
  EXPECT_TRUE(std::ranges::any_of(demands, &FastrakDemand::receivers_move));
}

/// A unit that leaves out every other record of its stream.
class HalfAsFast : public Client {
 public:
  using Client::Client;
  std::string wait(Time span, std::size_t enough = std::string::npos) override {
    std::string heard = Client::wait(span, enough);
    if (sent() != "C") return heard;
    std::string half;
    const auto length = fastrak_record_length({{2, 4, 1}, false, false});
    for (std::size_t at = 0; at + length <= heard.size(); at += 2 * length) {
      half += heard.substr(at, length);
    }
    return half;
  }
};

TEST(FastrakClientsTest, AUnitThatSendsTooFewRecordsIsToldTheirNumberASecond) {
  HalfAsFast line(plugged(1));
  std::vector<FastrakDemand> demands;
  run_client(client_named("ROS 2 node"), line, 1, 2s, demands);
  ASSERT_FALSE(demands.empty());
  EXPECT_FALSE(demands.back().met);
  EXPECT_EQ(demands.back().what, "about 120 records a second");
  EXPECT_EQ(demands.back().found, "60 a second");
}

// A unit as `emulate TRIAL` makes it, at clients that set neither envelope nor, most, hemisphere.
TEST_P(FastrakClientTest, GetsTheWholeBundledTrial) {
  const FastrakClient& client = client_named(GetParam());
  const std::vector<Sample> samples =
      test::samples_of(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  const FastrakPlace place = place_for(samples);
  const Time length = last_time(samples);
  const FastrakMotion played = seen_from(place, recorded_motion(samples));
  const auto motion = [&](int station, Time t) { return played(station, t % length); };

  std::vector<FastrakSent> sent;
  const int stations = std::max(2, client.least_stations);
  FastrakEmulatorOptions options = plugged(stations);
  options.stylus = 0;
  options.envelope = place.envelope;
  options.on_record = [&](const FastrakSent& record) { sent.push_back(record); };
  Client line(options, Client::Tty::raw, motion);
  const auto records = expect_served(line, GetParam(), stations, length);
  ASSERT_GT(records.size(), 100u);
  ASSERT_LE(records.size(), sent.size());
  const std::size_t before = sent.size() - records.size();  // its start-up had some
  for (std::size_t i = 0; i < records.size(); ++i) {
    const FastrakRecord& record = records[i];
    ASSERT_EQ(record.station, sent[before + i].station);
    ASSERT_FALSE(record.pressed);
    if (GetParam().starts_with("VRPN")) continue;  // its filters trail behind
    const FastrakFormat& format = record.station == 1 ? client.first : client.others;
    const Vec3 p = record.position * format.metre_per_unit();
    // BoardLab tells the unit that the receiver is below the transmitter.
    const Vec3 truth = motion(record.station, sent[before + i].measured).X_TS.p;
    const bool flipped = client.name == "BoardLab" && record.station == 1 && truth.z() < 0.0;
    const double rounding = format.binary ? 1e-6 : 0.01 * format.metre_per_unit();
    ASSERT_LT((p - (flipped ? Vec3(-truth) : truth)).norm(), rounding) << i;
  }
}

// Plain VRPN leaves the stylus switch in point mode; a trial's trigger must not stop the stream.
TEST(FastrakClientsTest, ATriggerIsNoSwitchOfAStylusThatNobodyPluggedIn) {
  const auto motion = [](int station, Time t) {
    FastrakTruth truth = circling_motion(station, t);
    truth.pressed = t > 15s;
    return truth;
  };
  FastrakEmulatorOptions options = plugged(2);
  options.stylus = 0;
  Client line(options, Client::Tty::raw, motion);
  expect_served(line, "VRPN", 2, 10s);
  EXPECT_GT(line.wait(5s).size(), 590u * 32u);
  options.stylus = kHandStation;
  Client with(options, Client::Tty::raw, motion);
  std::vector<FastrakDemand> demands;
  run_client(client_named("VRPN"), with, 2, 10s, demands);
  EXPECT_EQ(with.wait(5s), "");  // as the real one does, in its factory's set-up
}

// --- VRPN's worse days -----------------------------------------------------------------------

TEST(FastrakClientsTest, VrpnWithAStylusOnAUnitThatIsStreaming) {
  Client line(plugged(2));
  line.ask("fC", 1s);
  line.ask("O1,2,11,16,0\r", 50ms);
  line.send("c");
  line.wait(2s);
  line.flush();
  EXPECT_EQ(line.wait(2s), "");
  expect_served(line, "VRPN with a stylus", 2, 10s);
}

TEST(FastrakClientsTest, VrpnAtAUnitDeafToTwoRequests) {
  Client line(plugged(2, "noise=0,deaf=2"));
  line.ask("c", 4s);
  EXPECT_EQ(line.ask("S", 1s), "");
  line.ask("\r", 2s);
  line.ask("c", 4s);
  EXPECT_EQ(line.ask("S", 1s), "");
  line.ask("\r", 2s);
  line.ask("\x19", 2s);
  line.ask("c", 2s);
  line.wait(20s);
  line.flush();
  expect_served(line, "VRPN", 2, 5s);
}

TEST(FastrakClientsTest, VrpnThroughItsLastResort) {
  Client line(plugged(1, "noise=0,deaf=5"));
  for (const std::string reset : {"c", "\rc",
                                  "\r\x19"
                                  "c",
                                  "\r\x19"
                                  "c",
                                  "\rt\x19"
                                  "c",
                                  "\rYt\x19"
                                  "c"}) {
    for (const char c : reset) line.ask(std::string(1, c), 2s);
    if (reset.size() > 2) line.wait(20s);
    line.flush();
    line.wait(2s);
    const std::string status = line.ask("S", 1s);
    if (reset.size() == 5) {
      EXPECT_EQ(status.size(), 55u);  // the sixth
    }
  }
}

TEST(FastrakClientsTest, VrpnReopensAPortThatFellSilent) {
  Client line(plugged(1, "noise=0,silence=4@15"));
  std::vector<FastrakDemand> demands;
  run_client(client_named("VRPN"), line, 1, 10s, demands);  // into it, past its watchdog's 2 s
  line.close();
  line.wait(500ms);
  line.open();
  line.ask("c", 4s);  // falls into the silence, and the unit goes on streaming after it
  line.flush();
  EXPECT_NE(line.ask("S", 1s).size(), 55u);
  line.ask("\r", 2s);  // the second attempt
  line.ask("c", 2s);
  line.flush();
  line.wait(2s);
  const std::string status = line.ask("S", 1s);
  ASSERT_EQ(status.size(), 55u);
  EXPECT_EQ(status.substr(3, 3), "3F1");  // binary outlived the client
  expect_served(line, "VRPN", 1, 5s);
}

// --- What takes more than a start-up ---------------------------------------------------------

TEST(FastrakClientsTest, PylhemusDigitisesWithTheStylus) {
  bool pressed = false;
  Client client(plugged(2), Client::Tty::raw, [&](int station, Time t) {
    FastrakTruth truth = still_motion(station, t);
    truth.pressed = pressed && station == 1;
    return truth;
  });
  client.ask("W", 100ms);
  client.ask("u", 100ms);
  pressed = true;
  const std::string lines = client.wait(350ms);
  pressed = false;
  ASSERT_GE(lines.size(), 94u);
  EXPECT_EQ(lines.substr(0, 2), "01");
  EXPECT_EQ(lines.substr(3, 7), "  40.00");  // its columns, in centimetres
  EXPECT_EQ(lines.substr(10, 7), " -10.00");
  EXPECT_EQ(lines.substr(47, 2), "02");
}

TEST(FastrakClientsTest, ARosNodeListensToAUnitThatSavedAStreamingSetUp) {
  Client client(plugged(1));
  client.ask("C\x0b", 5s);  // somebody saved a streaming unit
  client.emulator.power_cycle(client.now);
  client.flush();
  client.close();
  client.wait(11s);
  client.open();
  const std::string stream = client.wait(1s);
  EXPECT_GT(stream.size() / 47, 100u);
  const std::size_t first = stream.find("\r\n") + 2;
  EXPECT_EQ(stream.substr(first, 3), "01 ");
}

}  // namespace
}  // namespace headpin::devices
