#include "devices/lines/byte_stream.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/lock.h"
#include "devices/lines/lasting_line.h"
#include "devices/lines/tcp.h"
#include "tests/devices/line_ends.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;

std::size_t put(ByteStream& stream, const std::string& text) {
  return stream.write(Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

// What arrives until `count` bytes are there, or nothing came for two seconds.
std::string get(ByteStream& stream, std::size_t count) {
  std::string heard;
  int waited_ms = 0;
  while (heard.size() < count && waited_ms < 2000) {
    std::array<std::uint8_t, 256> bytes{};
    const std::size_t n = stream.read(bytes);
    heard.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    if (n > 0) waited_ms = 0;
    if (n > 0) continue;
    pollfd state{stream.descriptor(), POLLIN, 0};  // without a descriptor, nothing says when
    const int wait_ms = state.fd < 0 ? 1 : 2000;
    if (::poll(&state, 1, wait_ms) == 0) waited_ms += wait_ms;
  }
  return heard;
}

fs::path scratch(const std::string& name) {
  static const fs::path folder = fresh_folder("stream");
  return folder / name;
}

std::string every_byte() {
  std::string all;
  for (int b = 0; b < 256; ++b) all += static_cast<char>(b);
  return all;
}

TEST(MemoryStreamTest, CarriesBytesBothWaysUpToItsCapacity) {
  auto [a, b] = memory_streams(10);
  EXPECT_EQ(put(*a, "hello"), 5u);
  EXPECT_EQ(put(*a, "hello, world"), 5u);
  EXPECT_EQ(put(*b, "back"), 4u);
  EXPECT_EQ(get(*b, 10), "hellohello");
  EXPECT_EQ(get(*a, 4), "back");
  EXPECT_EQ(get(*a, 1), "");
}

TEST(MemoryStreamTest, ClosesWhenTheOtherEndIsGoneAndAllIsRead) {
  auto [a, b] = memory_streams();
  put(*a, "last");
  a.reset();
  EXPECT_FALSE(b->closed());
  EXPECT_EQ(get(*b, 4), "last");
  EXPECT_TRUE(b->closed());
}

TEST(PseudoTerminalTest, EveryByteGoesThroughUnchangedBothWays) {
  PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  put(pty, every_byte());
  EXPECT_EQ(get(*port, 256), every_byte());
  put(*port, every_byte());
  EXPECT_EQ(get(pty, 256), every_byte());
}

// A client that does not set its terminal up must not hear itself, nor lose control bytes.
TEST(PseudoTerminalTest, IsRawWithoutEchoForAClientThatSetsNothing) {
  PseudoTerminal pty;
  const int fd = ::open(pty.name().c_str(), O_RDWR | O_NOCTTY);
  const std::string typed = every_byte();
  ASSERT_EQ(::write(fd, typed.data(), typed.size()), 256);
  EXPECT_EQ(get(pty, 256), typed);
  pollfd state{fd, POLLIN, 0};
  EXPECT_EQ(::poll(&state, 1, 50), 0);
  ::close(fd);
}

TEST(PseudoTerminalTest, SettingsAndServiceOutliveTheClients) {
  PseudoTerminal pty;
  for (int i = 0; i < 3; ++i) {
    const auto port = open_serial(pty.name(), 38400);
    put(*port, "c");
    EXPECT_EQ(get(pty, 1), "c");
    put(pty, "ok");
    EXPECT_EQ(get(*port, 2), "ok");
  }
  EXPECT_EQ(pty.client_baud(), 38400);
}

TEST(PseudoTerminalTest, WhatWasSaidToNobodyIsLost) {
  PseudoTerminal pty;
  { const auto port = open_serial(pty.name(), 9600); }
  std::string old(10000, 'x');
  put(pty, old);
  const int fd = ::open(pty.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);  // does not flush
  std::array<std::uint8_t, 1> none{};
  pty.read(none);  // the unit looks at its line
  put(pty, "new");
  pollfd state{fd, POLLIN, 0};
  ASSERT_EQ(::poll(&state, 1, 2000), 1);
  std::array<char, 64> heard{};
  const ssize_t n = ::read(fd, heard.data(), heard.size());
  EXPECT_EQ(std::string(heard.data(), static_cast<std::size_t>(n)), "new");
  ::close(fd);
}

// `stty` and the like open a terminal for a moment: what waits for its reader must stay.
TEST(PseudoTerminalTest, WhoOpensItForAMomentTakesNothingFromTheReader) {
  PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  EXPECT_TRUE(pty.renewed());
  put(pty, "waiting ");
  for (int i = 0; i < 3; ++i) {
    ::close(::open(pty.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    put(pty, "more ");
  }
  EXPECT_EQ(get(*port, 23), "waiting more more more ");
  EXPECT_FALSE(pty.renewed());
}

TEST(PseudoTerminalTest, WithNobodyThereItNeverFills) {
  PseudoTerminal pty;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(put(pty, std::string(100, 'x')), 100u);
  const auto port = open_serial(pty.name(), 9600);
  EXPECT_TRUE(pty.renewed());
  put(pty, "new");
  EXPECT_EQ(get(*port, 3), "new");
}

TEST(PseudoTerminalTest, AReaderWhoDoesNotReadStopsTheWriterAndNotTheProgram) {
  PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += put(pty, std::string(100, 'x'));
  EXPECT_LT(taken, 100'000u);
  EXPECT_GT(taken, 1000u);
}

TEST(PseudoTerminalTest, LinkPointsToItAndGoesWithIt) {
  const fs::path link = scratch("link");
  {
    PseudoTerminal pty(link);
    EXPECT_EQ(fs::read_symlink(link), pty.name());
  }
  EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
}

TEST(PseudoTerminalTest, LinkReplacesALeftOverButNoFile) {
  const fs::path stale = scratch("stale"), file = scratch("file");
  fs::create_symlink("/dev/pts/nowhere", stale);
  EXPECT_NO_THROW(PseudoTerminal pty(stale));
  std::ofstream(file) << "mine";
  EXPECT_THROW(PseudoTerminal pty(file), std::runtime_error);
  EXPECT_EQ(fs::file_size(file), 4u);
  for (const char* port :
       {"/dev/ttyS0", "/dev/tty", "/dev/ttyUSB77"}) {  // somebody's name for a real one
    const fs::path theirs = scratch("theirs");
    fs::create_symlink(port, theirs);
    EXPECT_THROW(PseudoTerminal pty(theirs), std::runtime_error);
    EXPECT_EQ(fs::read_symlink(theirs), port);
    fs::remove(theirs);
  }
  EXPECT_THROW(PseudoTerminal pty("/no/such/folder/link"), std::runtime_error);
}

// After a kill, the next terminal often has the name of the dead one, to which its link still points.
TEST(PseudoTerminalTest, LinkOfAKilledOneIsTakenOverThoughItNamesTheNewOne) {
  const std::string link = scratch("left").string();
  bool same = false;
  for (int i = 0; i < 100 && !same; ++i) {  // another process may have taken the name meanwhile
    const std::string name = PseudoTerminal("").name();
    fs::remove(link);
    fs::create_symlink(name, link);
    try {
      same = PseudoTerminal(link).name() == name;
    } catch (const base::Busy&) {
      continue;
    }
  }
  EXPECT_TRUE(same);
}

TEST(PseudoTerminalTest, ALinkToTheTerminalOfAnotherProgramIsItsOwn) {
  const std::string link = scratch("shell").string();
  const int other = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(other, 0);
  ASSERT_EQ(grantpt(other), 0);
  ASSERT_EQ(unlockpt(other), 0);
  const std::string name = ptsname(other);
  fs::create_symlink(name, link);
  EXPECT_THROW(PseudoTerminal pty(link), base::Busy);
  EXPECT_EQ(fs::read_symlink(link), name);
  ::close(other);
}

TEST(PseudoTerminalTest, ASecondOneAtALinkIsRefusedAndTheFirstServesOn) {
  const std::string link = scratch("taken").string();
  {
    PseudoTerminal first(link);
    const auto client = open_serial(link, 115200);
    EXPECT_THROW(PseudoTerminal second(link), base::Busy);
    EXPECT_EQ(fs::read_symlink(link), first.name());
    put(*client, "still here");
    EXPECT_EQ(get(first, 10), "still here");
  }
  const PseudoTerminal next(link);
  EXPECT_EQ(fs::read_symlink(link), next.name());
}

TEST(SerialTest, ASecondSessionOnALineIsRefusedAndTheFirstHearsOn) {
  PseudoTerminal unit;
  auto first = open_serial(unit.name(), 9600);
  put(unit, "a record");
  EXPECT_THROW(open_serial(unit.name(), 115200), base::Busy);
  EXPECT_EQ(unit.client_baud(), 9600);
  EXPECT_EQ(get(*first, 8), "a record");  // not thrown away
  first.reset();
  EXPECT_NO_THROW(open_serial(unit.name(), 115200));
}

TEST(SerialTest, WhatIsNoTerminalIsRefusedByName) {
  EXPECT_THROW(open_serial("/no/such/port", 9600), std::runtime_error);
  EXPECT_THROW(open_serial("/dev/null", 9600), std::runtime_error);
  PseudoTerminal pty;
  EXPECT_THROW(open_serial(pty.name(), 12345), std::runtime_error);
}

TEST(SerialTest, SaysWhatIsThereInPlaceOfAPort) {
  const auto said = [](const std::string& name) {
    return complaint([&] { open_serial(name, 9600); });
  };
  const std::string none =
      ": there is no such serial port; expected a serial port such as /dev/ttyUSB0, or "
      "tcp:HOST:PORT";
  const std::string file = scratch("text.txt").string(), folder = scratch("folder").string();
  std::ofstream(file) << "text";
  fs::create_directory(folder);
  EXPECT_EQ(said("/dev/no-such-port"), "/dev/no-such-port" + none);
  EXPECT_EQ(said("udp:127.0.0.1:1"), "udp:127.0.0.1:1" + none);
  EXPECT_EQ(said(file), file + ": expected a serial port, found a file");
  EXPECT_EQ(said(folder), folder + ": expected a serial port, found a folder");
  EXPECT_EQ(said("/dev/null"), "/dev/null: expected a serial port, found another device");
}

TEST(SerialTest, APortThatIsPulledOutIsClosed) {
  auto pty = std::make_unique<PseudoTerminal>();
  const auto port = open_serial(pty->name(), 9600);
  EXPECT_EQ(get(*port, 0), "");
  EXPECT_FALSE(port->closed());
  pty.reset();
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(port->read(bytes), 0u);
  EXPECT_TRUE(port->closed());
}

// A driver that starts a unit again sets the rate first, at whatever moment the unit goes.
TEST(LastingLineTest, ALineThatHangsUpBeforeItsRateIsSetComesBackAtThatRate) {
  const std::string link = scratch("going").string();
  auto unit = std::make_unique<PseudoTerminal>(link);
  const auto line = open_line(link, 115200);
  unit.reset();
  EXPECT_NO_THROW(line->set_baud(9600));
  EXPECT_FALSE(line->closed());
  EXPECT_EQ(line->trouble(), link + " hung up; waiting for it to come back");
  EXPECT_EQ(put(*line, "lost"), 0u);

  unit = std::make_unique<PseudoTerminal>(link);
  while (put(*line, "S") == 0) poll(nullptr, 0, 10);  // it looks for the line now and then
  EXPECT_EQ(get(*unit, 1), "S");
  EXPECT_EQ(unit->client_baud(), 9600);
  EXPECT_EQ(line->trouble(), "");
  EXPECT_THROW(line->set_baud(12345), std::invalid_argument);
}

TEST(TcpServerTest, OneClientAfterTheOther) {
  OpenDoor server(0);
  ASSERT_GT(server.port(), 0);
  for (int i = 0; i < 3; ++i) {
    const auto client = connect_tcp("127.0.0.1", server.port());
    put(*client, "S");
    EXPECT_EQ(get(server, 1), "S");
    put(server, every_byte());
    EXPECT_EQ(get(*client, 256), every_byte());
  }
}

// As a serial line, which has one end: who comes later must not end the session that is under way.
TEST(TcpServerTest, ASecondClientIsHungUpAndTheFirstKeepsTheLine) {
  OpenDoor server(0);
  const std::string name = "tcp:127.0.0.1:" + std::to_string(server.port());
  const auto first = connect_tcp("127.0.0.1", server.port());
  put(*first, "S");
  EXPECT_EQ(get(server, 1), "S");
  const auto second = open_line(name, 115200);
  while (second->trouble().empty()) {
    put(server, "x");
    std::array<std::uint8_t, 8> bytes{};
    second->read(bytes);
  }
  EXPECT_EQ(second->trouble(),
            name +
                " hung up without a word, as where another client has it; waiting "
                "for it to come back");
  put(*first, "P");
  EXPECT_EQ(get(server, 1), "P");
}

int option_of(const ByteStream& stream, int level, int name) {
  int value = 0;
  socklen_t size = sizeof value;
  EXPECT_EQ(getsockopt(stream.descriptor(), level, name, &value, &size), 0);
  return value;
}

// A session waited for a unit whose machine was gone until the system gave it up, after a quarter of an
// hour, or the unit's machine refused the old connection.
TEST(TcpClientTest, AsksASilentUnitForASignOfLifeAndGivesUpAfterEightSeconds) {
  const TcpServer server(0);
  const auto client = connect_tcp("127.0.0.1", server.port());
  EXPECT_EQ(option_of(*client, SOL_SOCKET, SO_KEEPALIVE), 1);
  EXPECT_EQ(option_of(*client, IPPROTO_TCP, TCP_KEEPIDLE), 4);
  EXPECT_EQ(option_of(*client, IPPROTO_TCP, TCP_USER_TIMEOUT), 8000);
}

TEST(TcpServerTest, NobodyThereLosesTheBytes) {
  OpenDoor server(0);
  EXPECT_EQ(put(server, "nobody"), 6u);
  const auto client = connect_tcp("127.0.0.1", server.port());
  EXPECT_EQ(put(server, "somebody"), 8u);
  EXPECT_EQ(get(*client, 8), "somebody");
}

TEST(TcpServerTest, AReaderWhoDoesNotReadStopsTheWriter) {
  OpenDoor server(0);
  const auto client = connect_tcp("127.0.0.1", server.port());
  std::size_t taken = 0;
  for (int i = 0; i < 100'000; ++i) taken += put(server, std::string(100, 'x'));
  EXPECT_LT(taken, 10'000'000u);
}

/// A client whose machine holds few bytes that were not read.
int client_with_little_room(int port) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  const int few = 4096;
  setsockopt(client, SOL_SOCKET, SO_RCVBUF, &few, sizeof few);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(client, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  return client;
}

// Records that wait in the machine are old when they are read. What one machine holds for another is
// what the writer's socket takes and what the reader's takes; the latter is made small here.
TEST(TcpServerTest, WhoReadsLateFindsFewRecordsThatWaited) {
  OpenDoor server(0);
  const int client = client_with_little_room(server.port());
  std::size_t taken = 0;
  for (int i = 0; i < 100'000; ++i) taken += put(server, std::string(100, 'x'));
  EXPECT_GT(taken, 0u);
  EXPECT_LT(taken, 50'000u);  // unlimited, Linux takes millions
  close(client);
}

TEST(TcpServerTest, SaysThatAnotherClientHasCome) {
  TcpServer server(0);
  EXPECT_FALSE(server.renewed());
  for (int i = 0; i < 2; ++i) {
    const auto client = connect_tcp("127.0.0.1", server.port());
    std::array<std::uint8_t, 8> bytes{};
    while (!server.renewed()) server.read(bytes);
    EXPECT_FALSE(server.renewed());
  }
}

// The system asks such a client now and then, and less and less often. That it is asked rarely was
// taken for its absence.
TEST(TcpServerTest, AClientThatDoesNotReadKeepsTheLineWhileItsMachineAnswers) {
  OpenDoor server(0);
  const int first = client_with_little_room(server.port());
  tcp_info info{};
  while (info.tcpi_last_ack_recv <= 11'000) {  // ms; after about half a minute
    put(server, std::string(100, 'x'));
    poll(nullptr, 0, 1);
    socklen_t size = sizeof info;
    ASSERT_EQ(getsockopt(server.descriptor(), IPPROTO_TCP, TCP_INFO, &info, &size), 0);
  }
  const int line = server.descriptor();
  const auto second = connect_tcp("127.0.0.1", server.port());
  std::array<std::uint8_t, 8> bytes{};
  while (!second->closed()) {
    put(server, "x");
    second->read(bytes);
  }
  EXPECT_EQ(server.descriptor(), line);
  ::close(first);
}

TEST(TcpServerTest, ATakenPortIsAnError) {
  TcpServer server(0);
  EXPECT_THROW(TcpServer second(server.port()), base::Busy);
  EXPECT_EQ(complaint([&] { TcpServer second(server.port()); }),
            "this port cannot be opened: Address already in use");
  EXPECT_EQ(complaint([] { connect_tcp("127.0.0.1", 1); }),
            "tcp:127.0.0.1:1: nobody answers there: Connection refused");
}

TEST(TcpServerTest, AnAddressThatIsNoneOfThisComputerIsRefused) {
  for (const std::string address : {"localhost", "", "nobody", "198.51.100.77", "::1"}) {
    EXPECT_THROW(TcpServer server(5555, address), std::invalid_argument);
    EXPECT_EQ(complaint([&] { TcpServer server(5555, address); }),
              "expected an IPv4 address of this computer in numbers, such as 127.0.0.1:5555, found "
              "'" +
                  address + "'");
  }
}

TEST(TcpServerTest, TheClientSeesTheEnd) {
  auto server = std::make_unique<OpenDoor>(0);
  const auto client = connect_tcp("127.0.0.1", server->port());
  put(*server, "x");
  EXPECT_EQ(get(*client, 1), "x");
  server.reset();
  pollfd state{client->descriptor(), POLLIN, 0};
  ::poll(&state, 1, 2000);
  std::array<std::uint8_t, 8> bytes{};
  client->read(bytes);
  EXPECT_TRUE(client->closed());
}

// `printf S | nc -N` shuts its half at once. It was hung up before the answer was due, which is after
// 3 s while a Fastrak saves.
TEST(TcpServerTest, AClientThatSendsNoMoreGetsItsAnswerAndIsHungUpAfterThat) {
  OpenDoor server(0);
  const auto client = connect_tcp("127.0.0.1", server.port());
  put(*client, "S");
  EXPECT_EQ(get(server, 1), "S");
  pollfd end{server.descriptor(), POLLIN, 0};
  ASSERT_EQ(::shutdown(client->descriptor(), SHUT_WR), 0);
  ASSERT_EQ(::poll(&end, 1, -1), 1);
  std::array<std::uint8_t, 64> bytes{};
  EXPECT_EQ(server.read(bytes), 0u);
  pollfd news{server.descriptor(), POLLIN, 0};
  EXPECT_EQ(::poll(&news, 1, 0), 0);  // its end is no news any more
  using Clock = std::chrono::steady_clock;
  const auto saved = Clock::now() + std::chrono::milliseconds(3100);
  while (Clock::now() < saved) {
    server.read(bytes);
    ::poll(nullptr, 0, 10);
  }
  for (int i = 0; i < 3; ++i) EXPECT_EQ(put(server, "answer"), 6u);
  EXPECT_EQ(get(*client, 18), "answeransweranswer");
  const auto patience = Clock::now() + std::chrono::seconds(30);
  while (!client->closed()) {
    if (Clock::now() > patience) FAIL() << "is never hung up";
    server.read(bytes);
    client->read(bytes);
    ::poll(nullptr, 0, 1);
  }
}

TEST(TcpServerTest, ANewcomerTakesThePlaceOfAClientThatSendsNoMore) {
  OpenDoor server(0);
  const auto first = connect_tcp("127.0.0.1", server.port());
  put(*first, "S");
  EXPECT_EQ(get(server, 1), "S");
  ASSERT_EQ(::shutdown(first->descriptor(), SHUT_WR), 0);
  const auto second = connect_tcp("127.0.0.1", server.port());
  put(*second, "P");
  EXPECT_EQ(get(server, 1), "P");
  put(server, "answer");
  EXPECT_EQ(get(*second, 6), "answer");
}

}  // namespace
}  // namespace headpin::devices
