#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "base/lock.h"
#include "devices/lines/byte_stream.h"
#include "tests/devices/line_ends.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;

/// A terminal that another program serves.
struct OthersTerminal {
  OthersTerminal() {
    EXPECT_EQ(grantpt(master), 0);
    EXPECT_EQ(unlockpt(master), 0);
    name = ptsname(master);
    client = ::open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  }
  ~OthersTerminal() {
    ::close(client);
    ::close(master);
  }
  OthersTerminal(const OthersTerminal&) = delete;
  OthersTerminal& operator=(const OthersTerminal&) = delete;

  void change(void (*edit)(termios&)) const {
    termios settings{};
    EXPECT_EQ(tcgetattr(client, &settings), 0);
    edit(settings);
    EXPECT_EQ(tcsetattr(client, TCSANOW, &settings), 0);
  }

  int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  int client = -1;  ///< a client that was there before
  std::string name;
};

/// A client that sets nothing up and discards nothing.
int plain_client(const PseudoTerminal& pty) {
  return ::open(pty.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
}

TEST(SerialTest, IsRaw8N1WithoutFlowControlWhateverItWasBefore) {
  const OthersTerminal terminal;
  terminal.change([](termios& settings) {
    settings.c_cflag |= CSTOPB | CRTSCTS;
    settings.c_cflag &= ~static_cast<tcflag_t>(CLOCAL);
    settings.c_iflag |= IXON | ICRNL;
    settings.c_lflag |= ECHO | ICANON;
    cfsetspeed(&settings, B19200);
  });
  const auto port = open_serial(terminal.name, 4800);
  termios now{};
  ASSERT_EQ(tcgetattr(port->descriptor(), &now), 0);
  EXPECT_EQ(now.c_cflag & (CSIZE | CSTOPB | PARENB | CRTSCTS), static_cast<tcflag_t>(CS8));
  EXPECT_EQ(now.c_cflag & CLOCAL, static_cast<tcflag_t>(CLOCAL)) << "it needs no carrier";
  EXPECT_EQ(now.c_cflag & CREAD, static_cast<tcflag_t>(CREAD));
  EXPECT_EQ(now.c_iflag & (IXON | ICRNL), 0u);
  EXPECT_EQ(now.c_lflag & (ECHO | ICANON), 0u);
  EXPECT_EQ(cfgetospeed(&now), static_cast<speed_t>(B4800));
  EXPECT_EQ(cfgetispeed(&now), static_cast<speed_t>(B4800));
}

TEST(SerialTest, DiscardsWhatArrivedBefore) {
  const OthersTerminal terminal;
  terminal.change([](termios& settings) { cfmakeraw(&settings); });
  ASSERT_EQ(::write(terminal.master, "old", 3), 3);
  ASSERT_TRUE(has_news(terminal.client));
  const auto port = open_serial(terminal.name, 9600);
  ASSERT_EQ(::write(terminal.master, "new", 3), 3);
  EXPECT_EQ(hear(*port, 3), "new");
}

TEST(SerialTest, NeitherWhatIsBehindAFileNorACircleOfLinksIsAPort) {
  const fs::path folder = fresh_folder("port");
  const std::string behind = folder / "file" / "port", circle = folder / "circle";
  spit(folder / "file", "text");
  fs::create_symlink(circle, circle);
  const auto said = [](const std::string& name) {
    return complaint([&] { open_serial(name, 9600); });
  };
  EXPECT_EQ(said(behind),
            behind +
                ": there is no such serial port; expected a serial port such as /dev/ttyUSB0, or "
                "tcp:HOST:PORT");
  EXPECT_EQ(said(circle), circle + ": cannot be opened: Too many levels of symbolic links");
}

TEST(SerialTest, AFailureLeavesNothingOpen) {
  const PseudoTerminal pty;
  const auto first = open_serial(pty.name(), 9600);
  const std::set<int> before = descriptors();
  EXPECT_THROW(open_serial(pty.name(), 9600), base::Busy);
  EXPECT_EQ(descriptors(), before);
  EXPECT_THROW(open_serial("/dev/null", 9600), std::runtime_error);
  EXPECT_EQ(descriptors(), before);
  first->set_baud(115200);
  EXPECT_EQ(descriptors(), before);
}

TEST(SerialTest, APortThatHasNothingToSayIsNotClosed) {
  PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  std::array<std::uint8_t, 8> bytes{};
  errno = ENOENT;  // of something else
  EXPECT_EQ(port->read(bytes), 0u);
  EXPECT_EQ(port->write({}), 0u);
  EXPECT_FALSE(port->closed());

  say(pty, "later");
  ASSERT_TRUE(has_news(port->descriptor()));
  EXPECT_EQ(port->read({}), 0u);
  EXPECT_FALSE(port->closed());
  EXPECT_EQ(hear(*port, 5), "later");
}

// With `stty min 1`, a silent port gives an error.
TEST(SerialTest, APortThatAnotherProgramSetsUpDifferentlyIsNotClosed) {
  PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  termios settings{};
  ASSERT_EQ(tcgetattr(port->descriptor(), &settings), 0);
  settings.c_cc[VMIN] = 1;
  ASSERT_EQ(tcsetattr(port->descriptor(), TCSANOW, &settings), 0);
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(port->read(bytes), 0u);
  EXPECT_FALSE(port->closed());
  say(pty, "here");
  EXPECT_EQ(hear(*port, 4), "here");
}

TEST(SerialTest, APortThatIsFullTakesNothingAndIsNotClosed) {
  const PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  while (say(*port, std::string(1000, 'x')) > 0) {
  }
  EXPECT_FALSE(port->closed());
}

TEST(SerialTest, APortThatIsPulledOutIsClosedByAReadOrAWriteWhateverFailedBefore) {
  std::array<std::uint8_t, 8> bytes{};
  for (const bool reads : {true, false}) {
    auto pty = std::make_unique<PseudoTerminal>();
    const auto port = open_serial(pty->name(), 9600);
    pty.reset();
    errno = EAGAIN;  // of another line
    EXPECT_EQ(reads ? port->read(bytes) : say(*port, "S"), 0u);
    EXPECT_TRUE(port->closed()) << reads;
  }
}

TEST(SerialTest, APortWhoseDriverGivesAnErrorIsClosed) {
  const PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  const int folder = ::open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);  // cannot be read so either
  ASSERT_EQ(dup3(folder, port->descriptor(), O_CLOEXEC), port->descriptor());
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(port->read(bytes), 0u);
  EXPECT_TRUE(port->closed());
  ::close(folder);
}

TEST(SerialTest, NoDescriptorWaitsOrGoesToOtherPrograms) {
  const std::set<int> before = descriptors();
  const PseudoTerminal pty;
  const auto port = open_serial(pty.name(), 9600);
  std::set<int> ours = descriptors();
  EXPECT_EQ(ours.size(), before.size() + 4);
  for (const int fd : before) ours.erase(fd);
  for (const int fd : ours) {
    EXPECT_FALSE(waits(fd)) << fd;
    EXPECT_FALSE(is_inherited(fd)) << fd;
  }
}

/// Whether an action gives a terminal to a session that has none, as that of a service: its
/// interrupt character would end the program.
template <typename Action>
bool takes_a_terminal(Action action) {
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    action();
    _exit(::open("/dev/tty", O_RDWR | O_NOCTTY) < 0 && errno == ENXIO ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  return status != 0;
}

TEST(SerialTest, NoLineBecomesTheTerminalOfTheSession) {
  const std::string link = fresh_folder("terminal") / "link";
  PseudoTerminal pty(link);
  EXPECT_TRUE(takes_a_terminal([&] { ::open(link.c_str(), O_RDWR); }));
  EXPECT_FALSE(takes_a_terminal([&] { open_serial(link, 9600); }));
  EXPECT_FALSE(takes_a_terminal([&] { PseudoTerminal another; }));
  EXPECT_FALSE(takes_a_terminal([&] { complaint([&] { PseudoTerminal second(link); }); }));
}

TEST(SerialTest, WorksInAProgramWithoutStandardInput) {
  PseudoTerminal pty;
  const OtherInput none;
  {
    const auto port = open_serial(pty.name(), 9600);
    EXPECT_EQ(port->descriptor(), STDIN_FILENO);
    say(pty, "first");
    EXPECT_EQ(hear(*port, 5), "first");
  }
  EXPECT_FALSE(has_input());
}

TEST(PseudoTerminalTest, WorksInAProgramWithoutStandardInput) {
  const fs::path folder = fresh_folder("without");
  const std::string link = folder / "link", file = folder / "file";
  const PseudoTerminal first(link);
  spit(file, "mine");
  PseudoTerminal second;
  const OtherInput none;
  {
    const PseudoTerminal pty;
    EXPECT_EQ(pty.descriptor(), STDIN_FILENO);
  }
  EXPECT_FALSE(has_input());
  EXPECT_THROW(PseudoTerminal refused(file), std::runtime_error);
  EXPECT_FALSE(has_input());
  EXPECT_EQ(complaint([&] { second.link_at(link); }), link + ": another emulator uses it");
  EXPECT_FALSE(has_input());
}

TEST(PseudoTerminalTest, SaysWhoseTerminalIsBehindALinkAndLeavesNothingOpen) {
  const std::string ours = fresh_folder("whose") / "ours", shells = ours + "-shells";
  const PseudoTerminal first(ours);
  const OthersTerminal shell;
  fs::create_symlink(shell.name, shells);
  const std::set<int> before = descriptors();
  EXPECT_EQ(complaint([&] { PseudoTerminal second(ours); }), ours + ": another emulator uses it");
  EXPECT_EQ(
      complaint([&] { PseudoTerminal second(shells); }),
      shells + ": another program's terminal is behind it; remove the link, or take another name");
  EXPECT_EQ(descriptors(), before);
}

/// As long as this lives, the process gets no other descriptor.
class NoMoreDescriptors {
 public:
  NoMoreDescriptors() {
    EXPECT_EQ(getrlimit(RLIMIT_NOFILE, &usual_), 0);
    const rlimit none{.rlim_cur = 0, .rlim_max = usual_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  ~NoMoreDescriptors() { setrlimit(RLIMIT_NOFILE, &usual_); }
  NoMoreDescriptors(const NoMoreDescriptors&) = delete;
  NoMoreDescriptors& operator=(const NoMoreDescriptors&) = delete;

 private:
  rlimit usual_{};
};

TEST(PseudoTerminalTest, SaysWhyThereIsNone) {
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "sanitizers need a descriptor to look at memory";
#endif
  const auto make = [] {
    const NoMoreDescriptors none;
    PseudoTerminal pty;
  };
  EXPECT_EQ(complaint(make), "no pseudo-terminal: Too many open files");
}

TEST(PseudoTerminalTest, WhatWasSaidToNobodyIsGoneOnceTheUnitHasLookedAtItsLine) {
  PseudoTerminal pty;
  say(pty, "old");
  const int client = plain_client(pty);
  ASSERT_TRUE(has_news(client));
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(pty.read(bytes), 0u);
  pollfd state{client, POLLIN, 0};
  EXPECT_EQ(::poll(&state, 1, 0), 0);
  ::close(client);
}

// Much more than a terminal holds, so that some of it waits on its way to the client.
TEST(PseudoTerminalTest, NothingOfAFloodThatNobodyHeardIsLeftForTheNext) {
  PseudoTerminal pty;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(say(pty, std::string(100, 'x')), 100u);
  const int client = plain_client(pty);
  EXPECT_TRUE(pty.renewed());
  EXPECT_EQ(say(pty, "new"), 3u);
  std::string heard;
  while (heard.find("new") == std::string::npos && has_news(client)) {
    std::array<char, 4096> bytes{};
    heard.append(bytes.data(), static_cast<std::size_t>(
                                   std::max<ssize_t>(0, ::read(client, bytes.data(), 4096))));
  }
  EXPECT_EQ(heard, "new");
  ::close(client);
}

// Who came may have come in place of the one who did not read: openings may be told as one.
TEST(PseudoTerminalTest, WhoComesToAFullTerminalFindsNothingOld) {
  for (const std::string& piece : {std::string(1000, 'x'), std::string()}) {
    const bool fills = !piece.empty();
    PseudoTerminal pty;
    const int first = plain_client(pty);
    EXPECT_TRUE(pty.renewed());
    while (say(pty, piece) > 0) {
    }
    EXPECT_FALSE(pty.renewed());
    const int second = plain_client(pty);
    EXPECT_EQ(pty.renewed(), fills);
    ::close(first);
    ::close(second);
  }
}

TEST(PseudoTerminalTest, AtAnotherRateBothHearOtherBytes) {
  std::string all;
  for (int b = 0; b < 256; ++b) all += static_cast<char>(b);
  PseudoTerminal pty;
  pty.expect_baud(9600);
  const auto port = open_serial(pty.name(), 19200);
  ASSERT_EQ(say(pty, all), 256u);
  const std::string to_client = hear(*port, 256);
  ASSERT_EQ(say(*port, all), 256u);
  const std::string from_client = hear(pty, 256);
  for (const std::string& heard : {to_client, from_client}) {
    ASSERT_EQ(heard.size(), 256u);
    std::set<int> kinds;
    for (const char c : heard) {
      kinds.insert(static_cast<unsigned char>(c));
      EXPECT_GE(static_cast<unsigned char>(c), 0xE0);  // high bits are set
    }
    EXPECT_EQ(kinds.size(), 32u);  // and the others are mixed
    EXPECT_NE(heard.substr(0xE0), all.substr(0xE0));
  }
  port->set_baud(9600);
  say(pty, all);
  EXPECT_EQ(hear(*port, 256), all);
  port->set_baud(115200);
  pty.expect_baud(0);
  say(*port, all);
  EXPECT_EQ(hear(pty, 256), all);
}

}  // namespace
}  // namespace headpin::devices
