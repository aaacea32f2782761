#include <algorithm>
#include <cstring>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "devices/fastrak_emulator.h"

/// The start-up of every known Fastrak client, byte for byte, over a real pseudo-terminal: each
/// gets what it needs to go on. What they send and demand is from their sources (VRPN, Vrui, VR
/// Juggler, VESS, COVISE, cybergarage, Georgia Tech's daemon, and others). Waiting is simulated
/// time.
namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using testing::StartsWith;

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

/// A client's end of the line, and the unit at the other.
class Client {
 public:
  enum class Tty { kRaw, kLeftAsItIs };

  explicit Client(FastrakEmulatorOptions options, Tty tty = Tty::kRaw,
                  FastrakMotion motion = circling_motion)
      : emulator(std::move(options), std::move(motion)), counted_(pty_), tty_(tty) {
    open();
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void open() {
    fd_ = ::open(pty_.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    serve(emulator, counted_, now);
    received_ = counted_.written;
    if (tty_ == Tty::kRaw) {
      termios settings{};
      tcgetattr(fd_, &settings);
      cfmakeraw(&settings);
      cfsetspeed(&settings, B115200);
      tcsetattr(fd_, TCSANOW, &settings);
    }
  }
  /// What is sent from here on until `open` is lost, as on a real port.
  void close() { ::close(std::exchange(fd_, -1)); }

  void send(std::string_view text) {
    ASSERT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    pollfd state{pty_.descriptor(), POLLIN, 0};
    ASSERT_EQ(::poll(&state, 1, 2000), 1);
    serve(emulator, counted_, now);
  }

  /// Lets time pass and hands over all that came.
  std::string wait(Time span) {
    for (const Time end = now + span; now < end;) {
      now += Time{500};
      serve(emulator, counted_, now);
      receive(0);
    }
    while (fd_ >= 0 && received_ < counted_.written && receive(2000)) {
    }
    return std::exchange(heard_, {});
  }

  std::string ask(std::string_view text, Time patience) {
    send(text);
    return wait(patience);
  }

  /// tcflush: what has come up to now is thrown away.
  void flush() {
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

/// A command with '#' for the station.
std::string to(char station, std::string command) {
  std::replace(command.begin(), command.end(), '#', station);
  return command;
}

double float_at(const std::string& bytes, std::size_t at) {
  float value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return static_cast<double>(value);
}

// --- VRPN ------------------------------------------------------------------------------------

// As vrpn_Tracker_Fastrak takes a stream apart; returns records per station.
std::array<int, 4> read_as_vrpn(const std::string& stream, std::size_t length1,
                                std::size_t length2) {
  std::array<int, 4> count{};
  for (std::size_t at = 0; at < stream.size();) {
    EXPECT_EQ(stream[at], '0');
    const int station = stream[at + 1] - '0';
    EXPECT_TRUE(station >= 1 && station <= 4);
    const std::size_t length = station == 1 ? length1 : length2;
    if (at + length > stream.size()) break;
    EXPECT_EQ(stream[at + 2], ' ');
    EXPECT_EQ(stream[at + length - 1], ' ');
    ++count[static_cast<std::size_t>(station - 1)];
    at += length;
  }
  return count;
}

void vrpn_status(Client& client) {
  const std::string status = client.ask("S", 1s);
  ASSERT_EQ(status.size(), 55u);
  EXPECT_EQ(status.front(), '2');
  EXPECT_EQ(status.back(), '\n');
}

// From its transcript: four lists, filters, then binary and continuous in one write.
void vrpn_set_up(Client& client, const std::string& list1, const std::string& extra = "") {
  client.send("O1," + list1 + "\r");
  EXPECT_EQ(client.wait(50ms), "");
  for (const char station : {'2', '3', '4'}) {
    client.send(to(station, "O#,2,11,0\r"));
    client.wait(50ms);
  }
  if (list1 == "2,11,16,0") client.ask("e1,0\r", 50ms);
  client.ask("x0.2,0.2,0.8,0.8\r", 1s);
  client.ask("v0.2,0.2,0.8,0.8\r", 1s);
  if (!extra.empty()) client.ask(extra, 2s);
  client.flush();
  client.send("fC");
}

TEST(FastrakClientTest, Vrpn) {
  Client client(plugged(2));
  client.send("c");
  EXPECT_EQ(client.wait(4s), "");
  vrpn_status(client);
  vrpn_set_up(client, "2,11,0");
  client.wait(100ms);
  const auto count = read_as_vrpn(client.wait(10s), 32, 32);
  EXPECT_NEAR(count[0], 600, 1);
  EXPECT_NEAR(count[1], 600, 1);
  EXPECT_EQ(count[2] + count[3], 0);
}

TEST(FastrakClientTest, VrpnWithAStylusOnAUnitThatIsStreaming) {
  Client client(plugged(2));
  client.ask("fC", 1s);
  client.ask("O1,2,11,16,0\r", 50ms);
  client.send("c");
  client.wait(2s);
  client.flush();
  EXPECT_EQ(client.wait(2s), "");
  vrpn_status(client);
  vrpn_set_up(client, "2,11,16,0", "H1,0,0,-1\rH2,0,0,-1\r");
  const auto count = read_as_vrpn(client.wait(10s), 34, 32);
  EXPECT_NEAR(count[0], 600, 2);
  EXPECT_NEAR(count[1], 600, 2);
}

TEST(FastrakClientTest, VrpnAtAUnitDeafToTwoRequests) {
  Client client(plugged(2, "noise=0,deaf=2"));
  client.ask("c", 4s);
  EXPECT_EQ(client.ask("S", 1s), "");
  client.ask("\r", 2s);
  client.ask("c", 4s);
  EXPECT_EQ(client.ask("S", 1s), "");
  client.ask("\r", 2s);
  client.ask("\x19", 2s);
  client.ask("c", 2s);
  client.wait(20s);
  client.flush();
  client.wait(2s);
  vrpn_status(client);
  vrpn_set_up(client, "2,11,0");
  EXPECT_NEAR(read_as_vrpn(client.wait(5s), 32, 32)[0], 300, 2);
}

TEST(FastrakClientTest, VrpnThroughItsLastResort) {
  Client client(plugged(1, "noise=0,deaf=5"));
  for (const std::string reset : {"c", "\rc",
                                  "\r\x19"
                                  "c",
                                  "\r\x19"
                                  "c",
                                  "\rt\x19"
                                  "c",
                                  "\rYt\x19"
                                  "c"}) {
    for (const char c : reset) client.ask(std::string(1, c), 2s);
    if (reset.size() > 2) client.wait(20s);
    client.flush();
    client.wait(2s);
    const std::string status = client.ask("S", 1s);
    if (reset.size() == 5) {
      EXPECT_EQ(status.size(), 55u);  // the sixth
    }
  }
}

TEST(FastrakClientTest, VrpnReopensAPortThatFellSilent) {
  Client client(plugged(1, "noise=0,silence=4@15"));
  client.ask("c", 4s);
  vrpn_status(client);
  vrpn_set_up(client, "2,11,0");
  client.wait(10s);  // into the silence, past the 2 s of its watchdog
  client.close();
  client.wait(500ms);
  client.open();
  client.ask("c", 4s);  // falls into the silence, and the unit goes on streaming after it
  client.flush();
  EXPECT_NE(client.ask("S", 1s).size(), 55u);
  client.ask("\r", 2s);  // the second attempt
  client.ask("c", 2s);
  client.flush();
  client.wait(2s);
  const std::string status = client.ask("S", 1s);
  ASSERT_EQ(status.size(), 55u);
  EXPECT_EQ(status.substr(3, 3), "3F1");  // binary outlived the client
  vrpn_set_up(client, "2,11,0");
  EXPECT_NEAR(read_as_vrpn(client.wait(5s), 32, 32)[0], 600, 2);
}

// --- The others ------------------------------------------------------------------------------

TEST(FastrakClientTest, Vrui) {
  Client client(plugged(2));
  client.ask("c", 100ms);
  client.flush();
  const std::string status = client.ask("S", 10s);
  EXPECT_EQ(status.substr(0, 3), "21S");
  EXPECT_TRUE(status.ends_with("\r\n"));
  for (const char n : {'1', '2'}) {
    for (const char* command :
         {"l#,1\r\n", "R#\r\n", "b#\r\n", "H#,  1.0000,  0.0000,  0.0000\r\n", "O#,2,4,16,1\r\n"}) {
      EXPECT_EQ(client.ask(to(n, command), 100ms), "") << command;
    }
  }
  client.ask("e1,0\r\n", 100ms);
  client.ask("F", 100ms);
  EXPECT_EQ(client.ask("N1,\r\n", 5s), "21N   0.000   0.000   0.000\r\n");
  client.ask("d", 100ms);
  client.ask("U", 100ms);
  client.ask("f", 100ms);
  const std::string stream = client.ask("C", 2s);
  // It looks for CR LF, then '0', a station and an error byte.
  int records = 0;
  for (std::size_t at = 0; (at = stream.find("\r\n0", at)) != std::string::npos; at += 3) {
    if (at + 5 > stream.size()) break;
    EXPECT_THAT(stream[at + 3], testing::AnyOf('1', '2'));
    EXPECT_EQ(stream[at + 4], ' ');
    ++records;
  }
  EXPECT_NEAR(records, 240, 3);
  EXPECT_EQ(stream.size() % 31, 0u);
}

TEST(FastrakClientTest, VrJuggler2007FlushesRightAfterSending) {
  Client client(plugged(2));
  const auto command = [&](std::string_view text) {
    client.send(text);
    client.flush();  // an answer in zero time would be lost here
    return client.wait(2s);
  };
  command("c");
  command("f");
  const std::string status = command("S");
  ASSERT_EQ(status.size(), 55u);
  EXPECT_EQ(status.substr(9, 6), "      ");  // it insists on blanks in columns 10 to 15
  EXPECT_EQ(status.substr(3, 3), "3F1");
  command("O1,2,11,1\r");
  command("O2,2,11,1\r");
  EXPECT_EQ(command("l1\r"), "21l1100\r\n");  // ASCII although binary is on
  const std::string records = command("P");
  ASSERT_EQ(records.size(), 66u);
  for (const std::size_t at : {0u, 33u}) {
    EXPECT_EQ(records[at], '0');
    EXPECT_EQ(records[at + 2], ' ');
    EXPECT_EQ(records.substr(at + 31, 2), "\r\n");
  }
}

TEST(FastrakClientTest, VrJuggler2006) {
  Client client(plugged(2));
  client.ask("c", 100ms);
  const std::string status = client.ask("S", 500ms);
  EXPECT_THAT(status, StartsWith("21S"));
  EXPECT_TRUE(status.ends_with("\r\n"));
  client.ask("uf", 100ms);
  client.ask("e1,0\r", 100ms);
  client.ask("l1,1\rl2,1\r", 100ms);
  client.ask("O1,2,4,16\rO2,2,4\r", 100ms);
  const std::string records = client.ask("P", 100ms);
  EXPECT_EQ(records.size(), 29u + 27u);
  EXPECT_NEAR(float_at(records, 3 + 8), -10.0, 1e-4);  // centimetres
}

TEST(FastrakClientTest, VessReadsTheListBackAndTakesWholeSets) {
  Client client(plugged(2));
  client.ask("C", 500ms);
  client.ask("\r", 100ms);
  client.ask("c", 1s);
  client.flush();
  EXPECT_EQ(client.ask("l1\r", 1s), "21l1100\r\n");
  EXPECT_EQ(client.ask("O1\r", 1s), "21O 2 4 1\r\n");
  for (const char n : {'1', '2', '3', '4'}) client.ask(to(n, "O#,2,4,1\r"), 50ms);
  client.ask("f", 50ms);
  const std::string set = client.ask("P", 1s);
  EXPECT_EQ(set.size(), 58u);
  EXPECT_EQ(set.front(), '0');
  const std::string stream = client.ask("C", 1s);
  EXPECT_EQ(stream[0], '0');
  EXPECT_EQ(stream[1], '1');  // sets begin with the first station
  client.ask("\x19", 15s);    // on exit
  EXPECT_EQ(client.wait(1s), "");
}

TEST(FastrakClientTest, CoviseGetsNoByteItDidNotAskFor) {
  Client client(plugged(2), Client::Tty::kLeftAsItIs);
  EXPECT_EQ(client.ask("\n", 100ms), "");
  EXPECT_EQ(client.ask("c", 100ms), "");
  EXPECT_EQ(client.ask("u", 100ms), "");
  EXPECT_EQ(client.ask("F", 100ms), "");
  for (const char n : {'1', '2'}) {
    EXPECT_EQ(client.ask(to(n, "l#,1\r\n"), 10ms), "");
    EXPECT_EQ(client.ask(to(n, "R#\r\n"), 10ms), "");
    EXPECT_EQ(client.ask(to(n, "O#,2,11,16,1\r\n"), 10ms), "");
    EXPECT_EQ(client.ask(to(n, "H#,  1.000000,  0.000000,  0.000000\r\n"), 10ms), "");
  }
  EXPECT_EQ(client.ask("e1,0\r\n", 100ms), "");
  for (int i = 0; i < 20; ++i) {
    const std::string answer = client.ask("P", 60ms);
    ASSERT_EQ(answer.size(), 112u);
    EXPECT_EQ(answer[55], '\n');
    EXPECT_EQ(answer[111], '\n');
    EXPECT_EQ(answer.substr(0, 3) + answer.substr(56, 3), "01 02 ");
  }
}

TEST(FastrakClientTest, CybergaragePollsOncePerReceiver) {
  Client client(plugged(2));
  EXPECT_EQ(client.ask("l1\r", 100ms).size(), 9u);
  for (const char n : {'1', '2', '3', '4'}) client.ask(to(n, "O#,2,0,4,1\r"), 10ms);
  client.ask("F", 10ms);
  client.ask("c", 10ms);
  client.send("P");
  client.send("P");
  EXPECT_EQ(client.wait(200ms).size(), 2u * 2u * 48u);  // P answers for all stations each time
}

// Everything within microseconds, ended by LF.
TEST(FastrakClientTest, GeorgiaTechsDaemon) {
  Client client(plugged(2));
  client.send("P\nO1,52,61,50\nO2,52,61,50\nO3,52,61,50\nO4,52,61,50\nu\nf\nC\n");
  const std::string heard = client.wait(2s);
  EXPECT_EQ(heard.substr(0, 3), "01 ");
  EXPECT_EQ(heard.substr(45, 5), "\r\n02 ");  // two ASCII records of the list at that moment
  int frames = 0;
  for (std::size_t at = 94; at + 32 <= heard.size(); at += 32, ++frames) {
    EXPECT_EQ(heard[at], '0');
    EXPECT_EQ(heard[at + 1], frames % 2 == 0 ? '1' : '2');
    EXPECT_EQ(heard[at + 2], ' ');
    EXPECT_EQ(heard[at + 31], ' ');
    EXPECT_NEAR(float_at(heard, at + 3 + 8), -10.0, 1e-4);
  }
  EXPECT_NEAR(frames, 236, 4);
}

TEST(FastrakClientTest, NontrivialSolutionsSerialDriver) {
  Client client(plugged(2));
  client.ask("c", 100ms);
  for (const char n : {'1', '2', '3', '4'}) client.ask(to(n, "l#,0\n"), 100ms);
  client.ask("l2,1\n", 100ms);
  client.ask("f", 100ms);
  client.ask("O2,2,4,1\n", 100ms);
  const std::string record = client.ask("P", 1s);
  EXPECT_EQ(record.size(), 29u);
  EXPECT_EQ(record.substr(0, 3), "02 ");
  EXPECT_TRUE(record.ends_with("\r\n"));
  EXPECT_NEAR(static_cast<double>(client.ask("C", 1s).size()) / 29.0, 120.0, 2.0);
  client.ask("c", 50ms);
  EXPECT_EQ(client.wait(1s), "");
}

TEST(FastrakClientTest, PylhemusDigitisesWithTheStylus) {
  bool pressed = false;
  Client client(plugged(2), Client::Tty::kRaw, [&](int station, Time t) {
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

TEST(FastrakClientTest, LinaWaitsForFourStationsInOrder) {
  Client client(plugged(4));
  client.ask("O1,2,4,1\nO2,2,4,1\nO3,2,4,1\nO4,2,4,1\n", 1s);
  const std::string lines = client.ask("P\n", 1s);
  ASSERT_EQ(lines.size(), 4u * 47u);
  for (std::size_t s = 0; s < 4; ++s) {
    EXPECT_EQ(lines[47 * s + 1], static_cast<char>('1' + s));
  }
}

TEST(FastrakClientTest, BoardLabSendsReturnsUntilALineComes) {
  Client client(plugged(1));
  client.ask("c", 500ms);
  client.ask("\x19", 15s);
  client.flush();
  std::string line;
  int returns = 0;
  while (line.empty() && returns < 3) {
    line = client.ask("\r", 1s);
    ++returns;
  }
  EXPECT_TRUE(line.ends_with("\r\n"));
  EXPECT_EQ(client.ask("l1\r", 500ms), "21l1000\r\n");
  EXPECT_EQ(client.ask("H1\r", 500ms), "21H   1.00   0.00   0.00\r\n");
  EXPECT_EQ(client.ask("O1\r", 500ms), "21O 2 4 1\r\n");
  client.ask("H1,0,0,1\r", 500ms);
  client.ask("O1,0,2,0,0,11,1\r", 500ms);
  client.ask("u\r", 500ms);
  const std::string stream = client.ask("C", 1s);
  for (std::size_t at = 0; at + 57 <= stream.size(); at += 57) {
    EXPECT_EQ(stream.substr(at, 4), "01  ");
    EXPECT_EQ(stream.substr(at + 55, 2), "\r\n");
  }
}

TEST(FastrakClientTest, RosNodeOnlyListens) {
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

TEST(FastrakClientTest, FreeVr) {
  Client client(plugged(2));
  client.ask("c", 40ms);
  client.ask("F", 40ms);
  client.ask("U", 40ms);
  const std::string status = client.ask("S", 40ms);
  EXPECT_EQ(status.substr(0, 3), "21S");  // it insists on station 1, within 40 ms
  EXPECT_EQ(client.ask("l*\n", 40ms), "21l1100\r\n");
  client.ask("O1,2,4,16,1\n\r", 40ms);
  EXPECT_EQ(client.ask("O1\r", 40ms), "21O 2 416 1\r\n");
  EXPECT_EQ(client.ask("P", 40ms).size(), 49u + 47u);
}

}  // namespace
}  // namespace headpin::devices
