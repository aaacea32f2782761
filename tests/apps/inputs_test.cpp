// A trial that comes through a pipe, and names that say what is in a file.

#include <csignal>

#include <sys/ioctl.h>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class Inputs : public CommandLine {
 protected:
  /// `WRITER | headpin ARGUMENTS`, in the folder.
  Result piped(const std::string& writer, const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && { " + writer +
                                "; } | '" HEADPIN_PROGRAM "' " + arguments +
                                " >out.txt 2>err.txt; echo $? >code.txt";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return {std::stoi(slurp(folder_ / "code.txt")), slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }
  /// The same trial by its name and through a pipe: the same words, but for the name.
  void expect_same(const std::string& before, const std::string& after) const {
    const Result named = headpin(before + " game.lcmlog" + after);
    const Result dash = piped("cat game.lcmlog", before + " -" + after);
    EXPECT_EQ(named.code, 0) << before << named.err;
    EXPECT_EQ(dash.code, 0) << before << dash.err;
    EXPECT_EQ(nameless(dash.out), nameless(named.out)) << before;
  }

 private:
  static std::string nameless(std::string text) {
    for (std::size_t at; (at = text.find("game.lcmlog")) != std::string::npos;) {
      text.replace(at, 11, "-");
    }
    return text;
  }
};

TEST_F(Inputs, ATrialComesThroughAPipe) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  expect_same("info", "");
  EXPECT_EQ(piped("cat game.lcmlog", "replay - --verify").code, 0);
  expect_same("compare game.lcmlog", " --json");
  expect_same("plot", " -o -");
  const Result whole = piped("cat game.lcmlog", "export - -o tables");
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_EQ(headpin("export game.lcmlog -o named").code, 0);
  EXPECT_EQ(slurp(folder_ / "tables/states.csv"), slurp(folder_ / "named/states.csv"));
  // A file is read where it is; of one that another has begun to read, the rest.
  EXPECT_EQ(piped("true", "replay - --verify <game.lcmlog").code, 0);
  EXPECT_EQ(piped("true", "compare - - <game.lcmlog").code, 0);
  const std::string rest = "{ head -c 20 >/dev/null; '" HEADPIN_PROGRAM "' info - --json; }";
  std::ofstream(folder_ / "behind") << std::string(20, '#') << slurp(folder_ / "game.lcmlog");
  EXPECT_EQ(std::system(("cd '" + folder_.string() + "' && " + rest + " <behind >out.txt").c_str()),
            0);
  EXPECT_EQ(nlohmann::json::parse(slurp(folder_ / "out.txt"))["complete"], true);
}

TEST_F(Inputs, ProcessesThatDrawReadTheSamePipe) {
  const std::string draw = " --look 1997 --frames 170-299 -o ";
  const Result dash = piped("cat '" + kDemo + "'", "frames -" + draw + "dash --jobs 2");
  ASSERT_EQ(dash.code, 0) << dash.err;
  ASSERT_EQ(headpin("frames " + kDemo + draw + "named").code, 0);
  for (const char* name : {"frames.csv", "left_000170.png", "right_000299.png"}) {
    EXPECT_EQ(slurp(folder_ / "dash" / name), slurp(folder_ / "named" / name)) << name;
  }
}

TEST_F(Inputs, APipeWithoutATrialIsRefused) {
  const auto expect_failure = [&](const std::string& writer, const std::string& arguments,
                                  const std::string& says) {
    const Result result = piped(writer, arguments);
    EXPECT_EQ(result.code, 1) << arguments;
    EXPECT_THAT(result.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  expect_failure("true", "info -", "-: is empty; expected an LCM event log");
  expect_failure("head -c 1000 '" + kDemo + "'", "replay -", "no whole event in 1000 bytes");
  expect_failure("true", "info - <&-", "-: ");
  expect_failure("true", "info - </", "-: cannot be read: Is a directory");
  const std::string no_space = "cd '" + folder_.string() + "' && cat '" + kDemo +
                               "' | (ulimit -f 1; '" HEADPIN_PROGRAM
                               "' info -) 2>&1 >/dev/null | cat >err.txt";
  EXPECT_EQ(std::system(no_space.c_str()), 0);
  EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("-: cannot be kept in TMPDIR: "));
}

TEST_F(Inputs, WhoWaitsForAPipeCanBeStopped) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  const pid_t process = started({"replay", "-"}, ends[0]);
  ASSERT_EQ(write(ends[1], "#", 1), 1);
  int unread = 1;
  while (unread != 0) {  // then it waits for more
    usleep(1000);
    ASSERT_EQ(ioctl(ends[0], FIONREAD, &unread), 0);
  }
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    kill(process, SIGTERM);
    usleep(10'000);
  }
  close(ends[0]);
  close(ends[1]);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
}

// What other programs take for a picture, a page or a table is one.
TEST_F(Inputs, AnEndingThatDoesNotFitIsRefused) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  const std::string plot = "expected a name that ends in .svg, .png or .pdf, found OUT";
  expect_refusal("plot game.lcmlog -o OUT.gif", 2, plot + ".gif");
  expect_refusal("plot game.lcmlog -o OUT.SVG", 2, plot + ".SVG");
  expect_refusal("plot game.lcmlog -o OUT.PNG", 2, plot + ".PNG");
  expect_refusal("report game.lcmlog -o OUT.pdf", 2, "ends in .html or .htm, found OUT.pdf");
  expect_refusal("replay game.lcmlog -o OUT.csv", 2, "ends in .lcmlog, found OUT.csv");
  expect_refusal("synthesize -o OUT.json", 2, "ends in .lcmlog or .csv, found OUT.json");
  expect_refusal("live --record OUT.txt", 2, "ends in .lcmlog, found OUT.txt");
  expect_refusal("frames game.lcmlog --video OUT.gif", 2, "ends in .mkv, found OUT.gif");
  expect_refusal("experiment power -o OUT.gif", 2,
                 "ends in .csv, .svg, .png or .pdf, found OUT.gif");
  for (const char* command : {"export", "whatif", "frames"}) {
    expect_refusal(std::string(command) + " game.lcmlog -o OUT.csv", 2,
                   "expected the name of a folder, found OUT.csv");
  }
  // An ending that says nothing is a name like any other.
  for (const char* name : {"plain", "p001.2026", "a.log"}) {
    EXPECT_EQ(headpin(std::string("replay game.lcmlog -o ") + name).code, 0) << name;
  }
  EXPECT_EQ(headpin("export game.lcmlog -o p001.tables").code, 0);
}

}  // namespace
}  // namespace headpin
