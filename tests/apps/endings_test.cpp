// How commands end: their exit code, what they say, and what is left when they are stopped.

#include <csignal>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/stop.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Two signals in one moment, as `timeout` sends them, and two kinds so that both arrive: that with the
/// higher number first.
void tell_twice(pid_t process, int signal) {
  kill(process, SIGSTOP);
  kill(process, signal);
  kill(process, SIGHUP);
  kill(process, SIGCONT);
}

class Endings : public CommandLine {
 protected:
  /// Runs a line of shell in the folder, with $headpin the program.
  Result shell(const std::string& line) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && headpin='" HEADPIN_PROGRAM "' && { " + line +
                                "; } 2>err.txt </dev/null";
    const int status = std::system(("bash -c '" + quoted(command) + "'").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, "",
            slurp(folder_ / "err.txt")};
  }
  static std::string quoted(const std::string& text) {
    std::string all;
    for (const char c : text) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return all;
  }

  /// Starts `headpin WORDS` in the folder, both streams into files there.
  pid_t start(std::vector<std::string> words) const {
    words.insert(words.begin(), "headpin");
    const pid_t process = fork();
    if (process != 0) return process;
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (chdir(folder_.c_str()) == 0 && std::freopen("/dev/null", "r", stdin) &&
        std::freopen("out.txt", "w", stdout) && std::freopen("err.txt", "w", stderr)) {
      execv(HEADPIN_PROGRAM, argv.data());
    }
    std::_Exit(99);
  }
  static int wait_for(pid_t process) {
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  template <typename Condition>
  static void wait_until(pid_t process, const Condition& condition) {
    while (!condition() && kill(process, 0) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  bool holds(const std::string& end) const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.path().filename().string().ends_with(end)) return true;
    }
    return false;
  }
  /// What is in the folder beside the streams' files.
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename();
      if (name != "out.txt" && name != "err.txt") names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
  }
};

const char* const kSayingCommands[] = {"--help", "--version", "replay --help", "info --help",
                                       "doctor --json"};

TEST_F(Endings, WhatCannotBeSaidIsAFailureThatSaysSo) {
  for (std::string command : kSayingCommands) {
    for (const auto& [stream, reason] :
         {std::pair{">/dev/full", "standard output: No space left"},
          std::pair{">&-", "standard output: Bad file descriptor"}}) {
      const Result result = shell("$headpin " + command + " " + stream);
      EXPECT_EQ(result.code, 1) << command << stream;
      EXPECT_THAT(result.err, HasSubstr(reason)) << command;
      EXPECT_THAT(result.err, StartsWith("headpin")) << command;
    }
  }
  for (const std::string& command : std::vector<std::string>{
           "info --json " + kDemo, "info " + kDemo, "info --scenario " + kDemo, "replay " + kDemo,
           "replay --json " + kDemo, "frames " + kDemo + " -o frames --force --frames 3",
           "synthesize --force -o made", "stream --speed 0 --lcm memq:// " + kDemo}) {
    const Result result = shell("$headpin " + command + " >/dev/full");
    EXPECT_EQ(result.code, 1) << command;
    EXPECT_THAT(result.err, HasSubstr("standard output: No space left")) << command;
  }
}

TEST_F(Endings, AReaderThatGoesAwayIsNoNews) {
  for (const std::string& command : std::vector<std::string>{"--help", "info --json"}) {
    // The reader is gone before a byte is written: it ends first, by a named pipe.
    const Result run =
        shell("mkfifo pipe; (exec 3<pipe; :) & exec 4>pipe; wait; $headpin " + command + " " +
              (command == "--help" ? "" : kDemo) + " >&4; code=$?; rm pipe; exit $code");
    EXPECT_EQ(run.code, 128 + SIGPIPE) << command;
    EXPECT_EQ(run.err, "") << command;
  }
}

TEST_F(Endings, EveryErrorBeginsWithItsCommandAndIsAnObjectToo) {
  const std::vector<std::pair<std::string, int>> wrong = {
      {"replay missing.lcmlog", 1},
      {"info missing.lcmlog", 1},
      {"frames missing.lcmlog -o new", 1},
      {"compare missing.lcmlog other.lcmlog", 1},
      {"import missing.csv -o new", 1},
      {"synthesize -o none/new", 1},
      {"stream missing.lcmlog", 1},
      {"emulate missing.lcmlog", 1},
      {"replay", 2},
      {"frames " + kDemo, 2},
      {"synthesize --speed nan -o new", 2},
      {"live", 2},
      {"replay --bogus", 2},
      {"info", 2}};
  for (const auto& [arguments, code] : wrong) {
    const std::string name = "headpin " + arguments.substr(0, arguments.find(' '));
    const Result result = headpin(arguments + " --json");
    EXPECT_EQ(result.code, code) << arguments;
    EXPECT_THAT(result.err, StartsWith(name + ": ")) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const nlohmann::json told = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_TRUE(told.is_object()) << arguments << "\n" << result.out;
    EXPECT_EQ(told["command"], name);
    EXPECT_EQ(told["exit_code"], code);
    EXPECT_EQ(result.err, name + ": " + told["error"].get<std::string>() + "\n");
  }
  EXPECT_THAT(headpin("").err, StartsWith("headpin: "));
  EXPECT_THAT(headpin("bowl").err, StartsWith("headpin: unknown command 'bowl'"));
}

TEST_F(Endings, AMessageIsShortHoweverLongItsReason) {
  const std::string name(100'000, 'x');
  const Result set = shell("$headpin replay " + kDemo + " --set $(printf x%.0s {1..100000})=1");
  EXPECT_EQ(set.code, 2);
  EXPECT_LT(set.err.size(), 1700u);
  std::ofstream(folder_ / "key.toml") << name << " = 1\n" << name << "\n";
  const Result key = headpin("synthesize -o new --scenario key.toml");
  EXPECT_EQ(key.code, 1);
  EXPECT_LT(key.err.size(), 1700u);
}

TEST_F(Endings, NumbersThatAreNoneAreRefused) {
  const std::string replay = "replay " + kDemo;
  for (const std::string& arguments : std::vector<std::string>{
           replay + " --elasticity nan", replay + " --friction nan", replay + " --friction inf",
           replay + " --set ball.mass=nan", std::string("synthesize -o new --duration nan"),
           std::string("synthesize -o new --duration inf"),
           std::string("synthesize -o new --duration 1e308"),
           std::string("synthesize -o new --speed nan"), std::string("synthesize -o new --aim nan"),
           std::string("synthesize -o new --seed -1"),
           std::string("synthesize -o new --seed 18446744073709551616"),
           std::string("synthesize -o new --seed 1.5"), std::string("emulate --duration nan"),
           std::string("emulate --seed -1"), std::string("live --lcm memq:// --duration nan"),
           "stream " + kDemo + " --lcm memq:// --speed nan"}) {
    const Result result = headpin(arguments);
    EXPECT_EQ(result.code, 2) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr("number")) << arguments;
  }
  EXPECT_TRUE(left().empty());
  EXPECT_EQ(headpin("synthesize -o new --seed 18446744073709551615").code, 0);
}

TEST_F(Endings, TheProgressLineIsGoneBeforeTheResultIsSaid) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
  const std::string name = ptsname(terminal);
  const std::string command =
      "'" HEADPIN_PROGRAM "' replay " + kDemo + " >" + name + " 2>&1 </dev/null";
  std::string said;
  std::thread reader([&] {
    char bytes[4096];
    for (ssize_t n = 0; (n = read(terminal, bytes, sizeof bytes)) > 0;) {
      said.append(bytes, static_cast<std::size_t>(n));
    }  // ends when the last one that has the terminal open is gone
  });
  EXPECT_EQ(std::system(command.c_str()), 0);
  reader.join();
  close(terminal);
  const std::size_t erased = said.find("\r\033[K");
  ASSERT_NE(erased, std::string::npos) << said;
  EXPECT_LT(erased, said.find("version")) << said;
  EXPECT_NE(said.find("state hash"), std::string::npos) << said;
}

TEST_F(Endings, StoppedFramesAndVideoLeaveNothing) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t process = start({"frames", kDemo, "-o", "frames", "--video", "stereo.mkv"});
    wait_until(process, [&] { return holds("left_000002.png"); });
    tell_twice(process, signal);
    // Two came at once: which of the threads takes which, and so which is the first, is open.
    EXPECT_THAT(wait_for(process), testing::AnyOf(128 + signal, 128 + SIGHUP))
        << slurp(folder_ / "err.txt");
    EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("headpin frames: stopped by SIG"));
    EXPECT_THAT(left(), testing::IsEmpty());
  }
}

// `timeout` signals its command and, at once, its whole group: a recording gets its end all the same.
TEST_F(Endings, ASessionThatIsToldTwiceGetsItsEnd) {
  const pid_t process = start({"live", kDemo, "--eyes", "none", "--record", "live.lcmlog"});
  std::error_code error;
  wait_until(process, [&] { return fs::file_size(folder_ / "live.lcmlog", error) + 1 > 100'000; });
  tell_twice(process, SIGINT);
  EXPECT_EQ(wait_for(process), 0) << slurp(folder_ / "err.txt");
  const nlohmann::json info = json("info live.lcmlog --json");
  EXPECT_EQ(info["complete"], true);
  EXPECT_EQ(info["participant"], "demo");  // of the trial that was played
  EXPECT_EQ(info["seed"], json("info " + kDemo + " --json")["seed"]);
}

// A command that does not heed the first signal is ended by another, but not by the same one again.
TEST(StopSignals, TheSameWishTwiceIsOneAndALaterOneEndsTheProcess) {
  int line[2];
  ASSERT_EQ(pipe(line), 0);
  const pid_t process = fork();
  if (process == 0) {
    apps::watch_stop_signals();
    const auto say = [&](char c) { return write(line[1], &c, 1); };
    say('w');
    while (apps::stop_signal() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    say(apps::stop_signal() == SIGINT ? 's' : '?');
    while (true) pause();
  }
  close(line[1]);  // what it no longer can say is then the end of the line
  char said = 0;
  EXPECT_EQ(read(line[0], &said, 1), 1);
  tell_twice(process, SIGINT);
  EXPECT_EQ(read(line[0], &said, 1), 1) << "the second signal ended it";
  EXPECT_EQ(said, 's');
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {  // until one counts as another
    kill(process, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  close(line[0]);
}

TEST_F(Endings, AStoppedReplayLeavesNothing) {
  // A long one, so that there is time to stop it.
  ASSERT_EQ(headpin("synthesize -o long.lcmlog --duration 600").code, 0);
  const pid_t process = start({"replay", "long.lcmlog", "-o", "new.lcmlog", "--json"});
  wait_until(process, [&] { return holds(".part"); });
  kill(process, SIGTERM);
  EXPECT_EQ(wait_for(process), 128 + SIGTERM) << slurp(folder_ / "err.txt");
  EXPECT_THAT(left(), testing::ElementsAre("long.lcmlog"));
  EXPECT_EQ(nlohmann::json::parse(slurp(folder_ / "out.txt"))["exit_code"], 128 + SIGTERM);
}

TEST_F(Endings, ATrialForAReaderThatWentAwayIsAFailureThatSaysSo) {
  for (const std::string& command :
       std::vector<std::string>{"synthesize -o -", "replay " + kDemo + " -o -",
                                "import " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o -"}) {
    const Result run = shell("mkfifo pipe; (exec 3<pipe; :) & exec 4>pipe; wait $!; $headpin " +
                             command + " >&4; code=$?; rm pipe; exit $code");
    EXPECT_EQ(run.code, 1) << command;
    EXPECT_THAT(run.err, HasSubstr("-: cannot write event 0: Broken pipe")) << command;
  }
}

TEST_F(Endings, AnOutputThatIsTakenAwayWhileItIsMadeIsAFailureThatSaysSo) {
  ASSERT_EQ(headpin("synthesize -o long.lcmlog --duration 60").code, 0);
  const pid_t replay = start({"replay", "long.lcmlog", "-o", "new.lcmlog"});
  wait_until(replay, [&] { return holds(".part"); });
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (entry.path().extension() == ".part") fs::remove(entry.path());
  }
  EXPECT_EQ(wait_for(replay), 1);
  EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("headpin replay: new.lcmlog: "));

  const pid_t frames = start({"frames", kDemo, "-o", "frames"});
  wait_until(frames, [&] { return holds("left_000002.png"); });
  std::error_code busy;
  while (fs::exists(folder_ / "frames")) fs::remove_all(folder_ / "frames", busy);
  EXPECT_EQ(wait_for(frames), 1);
  EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("headpin frames: "));
  EXPECT_THAT(left(), testing::ElementsAre("long.lcmlog"));
}

TEST_F(Endings, AStoppedStreamSaysHowFarItWas) {
  const pid_t process = start({"stream", kDemo, "--lcm", "memq://", "--speed", "0.01"});
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // it lasts twelve minutes
  kill(process, SIGINT);
  const int code = wait_for(process);
  // Before it watches for signals, one ends it as any program.
  EXPECT_TRUE(code == 128 + SIGINT || code == 1000 + SIGINT) << code;
  if (code == 128 + SIGINT) {
    EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("headpin stream: stopped by SIGINT after"));
  }
}

TEST_F(Endings, AScriptCanInterruptWhatItStartedInTheBackground) {
  const Result run = shell(
      "$headpin emulate --link line & until [ -L line ]; do sleep 0.01; done; kill -INT $!; wait "
      "$!");
  EXPECT_EQ(run.code, 0);
  EXPECT_FALSE(fs::is_symlink(folder_ / "line"));
}

TEST_F(Endings, AStoppedEmulatorTakesItsLinkAway) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t process = start({"emulate", "--link", "line"});
    wait_until(process, [&] { return fs::is_symlink(folder_ / "line"); });
    tell_twice(process, signal);
    EXPECT_EQ(wait_for(process), 0) << slurp(folder_ / "err.txt");
    EXPECT_THAT(left(), testing::IsEmpty());
  }
}

}  // namespace
}  // namespace headpin
