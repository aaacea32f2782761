// What the commands do to the user's files: nothing of theirs is lost, nothing half is left.

#include <sys/stat.h>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class Outputs : public CommandLine {
 protected:
  /// Names and contents of all files in the folder, without what the harness keeps there.
  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = fs::relative(entry.path(), folder_);
      if (name == "out.txt" || name == "err.txt") continue;
      all[name] = entry.is_regular_file() ? slurp(entry.path()) : "";
    }
    return all;
  }
  /// Refused with a reason, and every file is as it was.
  void expect_untouched(const std::string& arguments, int code, const std::string& says) const {
    const auto before = everything();
    const Result result = headpin(arguments);
    EXPECT_EQ(result.code, code) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(everything(), before) << arguments;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
};

TEST_F(Outputs, FramesForcedKeepsWhatIsNotItsOwn) {
  fs::create_directory(folder_ / "mine");
  write("mine/precious.txt", "precious");
  fs::copy_file(kDemo, folder_ / "mine/trial.lcmlog");
  const std::string few = " --frames 3 --force";
  expect_untouched("frames mine/trial.lcmlog -o mine" + few, 1, "mine: holds");
  expect_untouched("frames " + kDemo + " -o mine" + few, 1, "which headpin did not write");
  expect_untouched("frames " + kDemo + " -o ." + few, 1, "which headpin did not write");
  expect_untouched("frames " + kDemo + " -o new --video new/stereo.mkv" + few, 1,
                   "which this command uses");
  write("new.part", "precious");
  EXPECT_EQ(headpin("frames " + kDemo + " -o new/ --frames 3").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "new/left_000003.png"));
  EXPECT_EQ(slurp(folder_ / "new.part"), "precious");
  EXPECT_EQ(headpin("frames " + kDemo + " -o new/ --frames 4 --force").code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "new/left_000003.png"));
  EXPECT_TRUE(fs::exists(folder_ / "new/left_000004.png"));
}

TEST_F(Outputs, FramesFillTheFolderOneStandsIn) {
  fs::create_directory(folder_ / "here");
  const std::string line = "cd '" + (folder_ / "here").string() +
                           "' && '" HEADPIN_PROGRAM "' frames " + kDemo +
                           " -o . --frames 3 >/dev/null 2>&1";
  EXPECT_EQ(std::system(line.c_str()), 0);
  EXPECT_TRUE(fs::exists(folder_ / "here/frames.csv"));
}

TEST_F(Outputs, DevicesPipesAndLinksAreWrittenIntoAndStay) {
  for (const std::string& command :
       std::vector<std::string>{"replay " + kDemo + " -o ", std::string("synthesize -o ")}) {
    EXPECT_EQ(headpin(command + "/dev/null --force").code, 0);
    const Result full = headpin(command + "/dev/full --force");
    EXPECT_EQ(full.code, 1);
    EXPECT_THAT(full.err, HasSubstr("/dev/full: cannot write event 0: No space left"));
  }
  EXPECT_TRUE(fs::is_character_file("/dev/null") && fs::is_character_file("/dev/full"));
  ASSERT_EQ(mkfifo((folder_ / "pipe.mkv").c_str(), 0600), 0);
  expect_untouched("frames " + kDemo + " --frames 3 --force --video pipe.mkv", 1,
                   "pipe.mkv: is no regular file");

  write("old", "old");
  fs::create_symlink("old", folder_ / "link");
  expect_untouched("synthesize -o link", 1, "link: exists already");
  EXPECT_EQ(headpin("synthesize -o link --force").code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(json("info old --json")["complete"], true);
}

TEST_F(Outputs, TheInputIsNeverTheOutput) {
  fs::copy_file(kDemo, folder_ / "a.lcmlog");
  fs::create_symlink("a.lcmlog", folder_ / "link.lcmlog");
  write("room.csv", "");
  write("throw.csv", "x");
  const std::string says = "is an input of this command";
  expect_untouched("replay a.lcmlog -o a.lcmlog --force", 1, says);
  expect_untouched("replay a.lcmlog -o link.lcmlog --force", 1, says);
  expect_untouched("replay link.lcmlog -o ./a.lcmlog --force", 1, says);
  expect_untouched("synthesize --scenario room.csv -o room.csv --force", 1, says);
}

TEST_F(Outputs, AnEmptyNameIsRefusedAndADashIsStandardOutput) {
  for (const std::string& command : std::vector<std::string>{
           "replay " + kDemo + " -o ''", std::string("synthesize -o ''"),
           "frames " + kDemo + " -o ''", "frames " + kDemo + " --video ''",
           std::string("import x.csv -o ''"), std::string("live --lcm memq:// --record ''")}) {
    expect_untouched(command, 2, "expected a name");
  }
  expect_untouched("frames " + kDemo + " -o - --frames 3", 1, "-: cannot go to standard output");
  const Result made = headpin("synthesize -o - --seed 7");
  EXPECT_EQ(made.code, 0);
  EXPECT_THAT(made.err, HasSubstr("planned speed"));
  write("trial.lcmlog", made.out);
  ASSERT_EQ(headpin("synthesize -o b.lcmlog --seed 7").code, 0);
  EXPECT_EQ(made.out, slurp(folder_ / "b.lcmlog"));
}

TEST_F(Outputs, APlotSaysWhatItWroteButNotIntoThePicture) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  const nlohmann::json made = json("plot game.lcmlog -o game.svg --json");
  EXPECT_EQ(made["ticks"], json("info game.lcmlog --json")["ticks"]);
  EXPECT_EQ(made["output"], "game.svg");
  EXPECT_EQ(headpin("plot game.lcmlog -o -").out, slurp(folder_ / "game.svg"));
  expect_untouched("plot game.lcmlog -o - --json", 2, "both write to standard output");
}

TEST_F(Outputs, OddNamesAreNames) {
  const std::string odd = "a b'\"\n\xff:%s -x";
  std::string quoted = "\"$(printf 'a b\\047\\042\\nx\\377:%%s -x')\"";
  fs::create_directory(folder_ / "odd place");
  const Result made = headpin("synthesize --json -o " + quoted);
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_TRUE(nlohmann::json::accept(made.out)) << made.out;
  EXPECT_EQ(headpin("frames " + quoted + " --frames 3 -o 'odd place/" + "f:1' --video " +
                    "'odd place/v:1.mkv'")
                .code,
            0);
  EXPECT_TRUE(fs::exists(folder_ / "odd place/v:1.mkv"));
  // To ffmpeg, without a word before it, this is a part of another file.
  fs::create_directory(folder_ / "subfile,x");
  EXPECT_EQ(headpin("frames " + kDemo + " --frames 3 --video 'subfile,x/a:b.mkv'").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "subfile,x/a:b.mkv"));
  const Result missing = headpin("info 'no\nsuch'");
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
}

// No file may become longer than 8 blocks of 1024 bytes: as on a disk that is full.
TEST_F(Outputs, OnAFullDiskTheReasonAndTheFileAreSaid) {
  const auto on_full_disk = [&](const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() +
                                "' && (trap '' XFSZ; ulimit -f 8; '" HEADPIN_PROGRAM "' " +
                                arguments + " >out.txt 2>err.txt)";
    const int status = std::system(("bash -c \"" + command + "\"").c_str());
    return Result{WEXITSTATUS(status), "", slurp(folder_ / "err.txt")};
  };
  const std::vector<std::pair<std::string, std::string>> commands = {
      {"export " + kDemo + " -o tables", "tables/trackers.csv"},
      {"export " + kDemo + " --gltf full.glb", "full.glb"},
      {"export " + kDemo + " --mcap full.mcap", "full.mcap"},
      {"export " + kDemo + " --xdf full.xdf", "full.xdf"},
      {"frames " + kDemo + " -o drawn --frames 200", "drawn/left_000200.png"},
      {"frames " + kDemo + " -o parts --frames 200-259 --jobs 2", "parts/left_000200.png"},
      {"stream " + kDemo + " --speed 0 --lcm 'file://sent.log?mode=w'", "sent.log"}};
  for (const auto& [command, file] : commands) {
    const Result result = on_full_disk(command);
    EXPECT_EQ(result.code, 1) << command;
    EXPECT_THAT(result.err, HasSubstr(file + ": cannot be written: File too large")) << command;
    EXPECT_THAT(result.err, testing::Not(HasSubstr(".headpin"))) << command;
    EXPECT_THAT(result.err, testing::Not(HasSubstr(".parts"))) << command;
  }
}

TEST_F(Outputs, NamesThatAreTooLongAreRefusedByName) {
  const std::string name(300, 'n');
  for (const std::string& command : std::vector<std::string>{
           "info " + name, "replay " + kDemo + " -o " + name, "export " + kDemo + " -o " + name,
           "frames " + kDemo + " --frames 3 -o " + name,
           "frames " + kDemo + " --frames 3 -o drawn --video " + name + ".mkv",
           "emulate --duration 0.1 --link " + name, "emulate --duration 0.1 --control " + name,
           "stream " + kDemo + " --lcm 'file://" + name + "?mode=w'"}) {
    const Result result = headpin(command);
    EXPECT_EQ(result.code, 1) << command;
    EXPECT_THAT(result.err, testing::ContainsRegex(name + ".*: File name too long")) << command;
  }
}

TEST_F(Outputs, WhereNoThreadCanBeBegunThatIsSaid) {
  const auto drawn = [&](const std::string& environment) {
    const std::string command = "cd '" + folder_.string() + "' && " + environment +
                                " LD_PRELOAD='" NO_THREADS "' timeout 60 '" HEADPIN_PROGRAM
                                "' frames " +
                                kDemo + " -o drawn --frames 3 2>err.txt >out.txt";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << "it waits for ever";
    return slurp(folder_ / "err.txt");
  };
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "sanitizers have to be loaded first";
#endif
  EXPECT_THAT(drawn("true;"), HasSubstr("cannot start a thread"));
  EXPECT_THAT(drawn("LP_NUM_THREADS=2"), HasSubstr("LP_NUM_THREADS is 2, but only 0 threads"));
}

TEST_F(Outputs, AFloodOnTheControlLineNeitherFillsTheMemoryNorKeepsTheEmulator) {
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "sanitizers take terabytes of addresses";
#endif
  const std::string command = "cd '" + folder_.string() +
                              "' && ulimit -v 500000 && timeout 60 '" HEADPIN_PROGRAM
                              "' emulate --control - --duration 1 </dev/zero >out.txt 2>err.txt";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("lines longer than 4096 bytes"));
}

TEST_F(Outputs, AFirmwareIsSixCharactersThatCanBeSeen) {
  expect_refusal("emulate --duration 0.1 --firmware 1234567", 2, "expected 6 characters, found 7");
  expect_refusal("emulate --duration 0.1 --firmware \"$(printf '1\\t2345')\"", 2, "ASCII");
}

// The raw video had its name already, also that of an older one, when ffmpeg failed at its end.
TEST_F(Outputs, FramesNameNothingBeforeAllIsWritten) {
  fs::create_directory(folder_ / "bin");
  write("bin/ffmpeg", "#!/bin/sh\ncat >/dev/null; exit 1\n");
  fs::permissions(folder_ / "bin/ffmpeg", fs::perms::owner_all);
  write("stereo.y4m", "older");
  const auto before = everything();
  const std::string command = "cd '" + folder_.string() + "' && PATH=\"$PWD/bin:$PATH\" '" +
                              HEADPIN_PROGRAM + "' frames " + kDemo +
                              " --frames 3 --force -o drawn --video stereo.mkv --y4m stereo.y4m" +
                              " --cameras seen.json >out.txt 2>err.txt";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("ffmpeg has stopped"));
  EXPECT_EQ(everything(), before);
}

}  // namespace
}  // namespace headpin
