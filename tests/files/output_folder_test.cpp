#include "files/output_folder.h"

#include <csignal>
#include <map>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/output_text.h"
#include "tests/files/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::files {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFolderTest : public testing::Test {
 protected:
  /// Writes the named files, the last of which stands for the set.
  static void write(const std::string& path, const std::vector<std::string>& names,
                    OutputFolder::Options options = {}) {
    OutputFolder folder(path, options);
    for (const std::string& name : names) spit(folder.file(name), name);
    folder.commit(names.back());
  }
  /// Replaces 1.png, 2.png and index by 2.png, 3.png and index.
  void replace() const {
    OutputFolder folder(out_, force_);
    for (const char* name : {"2.png", "3.png", "index"}) spit(folder.file(name), "new");
    folder.commit("index");
  }
  std::string refused(const std::string& path, OutputFolder::Options options = {}) const {
    return complaint([&] { write(path, {"1.png", "index"}, options); });
  }
  /// All files in the test's folder and what is in them.
  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      all[fs::relative(entry.path(), folder_.path())] =
          entry.is_regular_file() ? slurp(entry.path()) : "";
    }
    return all;
  }

  TemporaryFolder folder_;
  const std::string out_ = folder_ / "out";
  const OutputFolder::Options force_{.overwrite = true, .others = {}};
};

TEST_F(OutputFolderTest, HoldsItsFilesWhenAllAreThere) {
  {
    OutputFolder folder(out_, {});
    spit(folder.file("1.png"), "half");
    EXPECT_FALSE(fs::exists(out_ + "/1.png"));
  }
  EXPECT_FALSE(fs::exists(out_)) << "dropped without commit()";
  write(out_, {"1.png", "index"});
  EXPECT_EQ(slurp(out_ + "/1.png"), "1.png");
  EXPECT_FALSE(fs::exists(out_ + "/.headpin.part"));
}

TEST_F(OutputFolderTest, ForcedItReplacesWhatItWroteAndNothingElse) {
  write(out_, {"1.png", "2.png", "index"});
  EXPECT_THAT(refused(out_), HasSubstr("out: exists already; --force replaces"));
  EXPECT_EQ(refused(out_, force_), "");
  EXPECT_FALSE(fs::exists(out_ + "/2.png"));
  spit(out_ + "/notes.txt", "precious");
  const auto before = everything();
  EXPECT_THAT(refused(out_, force_), HasSubstr("holds notes.txt, which headpin did not write"));
  EXPECT_EQ(everything(), before);
}

TEST_F(OutputFolderTest, AFolderOfOthersIsLeftAlone) {
  for (const char* name : {"notes.txt", ".hidden", ".headpin", ".headpin.part", "index"}) {
    fs::remove_all(out_);
    fs::create_directory(out_);
    spit(out_ + "/" + name, "precious");
    const auto before = everything();
    EXPECT_THAT(refused(out_), HasSubstr(std::string("holds ") + name));
    EXPECT_THAT(refused(out_, force_), HasSubstr(std::string("holds ") + name));
    EXPECT_EQ(everything(), before);
  }
}

TEST_F(OutputFolderTest, AListCannotNameWhatIsElsewhereOrNoFile) {
  write(out_, {"1.png", "index"});
  spit(folder_ / "precious", "precious");
  fs::create_directory(out_ + "/taken");
  spit(out_ + "/taken/x", "precious");
  const std::string list = slurp(out_ + "/.headpin");
  spit(out_ + "/.headpin", list + "../precious\ntaken\n");
  EXPECT_THAT(refused(out_, force_), HasSubstr("holds taken"));
  fs::remove_all(out_ + "/taken");
  EXPECT_EQ(refused(out_, force_), "");
  EXPECT_EQ(slurp(folder_ / "precious"), "precious");
}

TEST_F(OutputFolderTest, SlashesAtTheEndDotsAndLinksLeadToTheSameFolder) {
  EXPECT_EQ(refused(out_ + "//"), "");
  EXPECT_EQ(slurp(out_ + "/1.png"), "1.png");
  fs::create_symlink("out", folder_ / "link");
  EXPECT_THAT(refused(folder_ / "link/"), HasSubstr("exists already"));
  EXPECT_EQ(refused(folder_ / "link/", force_), "");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(refused(out_ + "/../out/.", force_), "");
  fs::create_symlink("new", folder_ / "dangling");
  EXPECT_EQ(refused(folder_ / "dangling"), "");
  EXPECT_TRUE(fs::exists(folder_ / "new/index"));
}

TEST_F(OutputFolderTest, AnEmptyFolderWillDoAndStaysWhenNothingComesOfIt) {
  fs::create_directory(out_);
  { OutputFolder folder(out_, {}); }
  EXPECT_TRUE(fs::is_empty(out_));
  EXPECT_EQ(refused(out_), "");
}

TEST_F(OutputFolderTest, InputsAndOtherOutputsInItAreRefused) {
  fs::create_directory(out_);
  for (const fs::path& other : {fs::path(out_ + "/in"), fs::path(out_ + "/deep/down/video.mkv"),
                                fs::path(out_), fs::path(out_ + "/../out/x")}) {
    EXPECT_THAT(refused(out_, {.overwrite = true, .others = {other}}),
                HasSubstr("which this command uses"));
  }
  EXPECT_TRUE(fs::is_empty(out_));
  EXPECT_EQ(refused(out_, {.others = {folder_ / "outside", folder_ / "out2/in"}}), "");
}

TEST_F(OutputFolderTest, TwoAtOnceAreOneAndOneRefused) {
  std::optional<OutputFolder> first(std::in_place, out_, OutputFolder::Options{});
  spit(first->file("index"), "the first's");
  EXPECT_THROW(OutputFolder(out_, {}), Busy);
  EXPECT_THROW(OutputFolder(out_, force_), Busy);
  first->commit("index");
  first.reset();
  EXPECT_EQ(slurp(out_ + "/index"), "the first's");
}

TEST_F(OutputFolderTest, WhatAKilledOneLeftIsTakenUp) {
  EXPECT_EXIT(
      {
        OutputFolder folder(out_, {});
        spit(folder.file("index"), "half");
        raise(SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  EXPECT_FALSE(fs::exists(out_ + "/index"));
  EXPECT_EQ(refused(out_), "");
  EXPECT_EQ(slurp(out_ + "/index"), "index");
  EXPECT_FALSE(fs::exists(out_ + "/.headpin.part"));
}

TEST_F(OutputFolderTest, WhatComesToStandThereMeanwhileIsNotReplaced) {
  {
    OutputFolder folder(out_, {});
    spit(folder.file("1.png"), "ours");
    spit(folder.file("index"), "ours");
    spit(out_ + "/1.png", "precious");
    EXPECT_THAT(complaint([&] { folder.commit("index"); }), HasSubstr("cannot move 1.png"));
  }
  EXPECT_EQ(slurp(out_ + "/1.png"), "precious");
  EXPECT_FALSE(fs::exists(out_ + "/index"));
}

TEST_F(OutputFolderTest, NoNameAFileAndAMissingPlaceAreRefused) {
  spit(folder_ / "file", "precious");
  EXPECT_THAT(refused(""), HasSubstr("expected a name"));
  EXPECT_THAT(refused("-"), HasSubstr("cannot go to standard output"));
  EXPECT_THAT(refused(folder_ / "file", force_), HasSubstr("is a file"));
  EXPECT_THAT(refused(folder_ / "file/", force_), HasSubstr("is a file"));
  EXPECT_THAT(refused("/proc/none/out"), HasSubstr("cannot be made"));
  EXPECT_EQ(slurp(folder_ / "file"), "precious");
  EXPECT_EQ(refused(folder_ / "deep/down"), "");
}

TEST_F(OutputFolderTest, WhenAnyCallOfACommitFailsTheOldOrTheNewOnesAreThere) {
  write(out_, {"1.png", "2.png", "index"});
  const auto old = everything();
  for (const char* call : {"renameat2", "fsync", "pwrite"}) {
    for (int number = 0;; ++number) {
      fail_call(call, number, EIO);
      const std::string said = complaint([&] { replace(); });
      const bool was_asked = !said.empty();
      let_all_succeed();
      EXPECT_EQ(was_asked && said.find("Input/output error") == std::string::npos, false) << said;
      if (slurp(out_ + "/index") == "index") {
        EXPECT_EQ(everything(), old) << call << " " << number;
      } else {
        EXPECT_EQ(slurp(out_ + "/2.png") + slurp(out_ + "/3.png"), "newnew") << call << number;
        EXPECT_FALSE(fs::exists(out_ + "/1.png"));
        write(out_, {"1.png", "2.png", "index"}, force_);
        EXPECT_EQ(everything(), old) << call << " " << number;
      }
      if (!was_asked) {
        EXPECT_GT(number, 0) << call << " is not called";
        break;
      }
    }
  }
}

TEST_F(OutputFolderTest, EndedAtAnyCallOfACommitTheNextFindsTheOldOrTheNewOnes) {
  write(out_, {"1.png", "2.png", "index"});
  const auto old = everything();
  for (int number = 0, whole = false; !whole; ++number) {
    const pid_t child = fork();
    if (child == 0) {
      end_at_call(number);
      replace();
      std::_Exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    whole = WIFEXITED(status);
    // The next one sees to it, whether it may replace them or not.
    EXPECT_THAT(refused(out_), HasSubstr("exists already")) << number;
    if (slurp(out_ + "/index") == "index") {
      EXPECT_EQ(slurp(out_ + "/1.png") + slurp(out_ + "/2.png"), "1.png2.png") << number;
      EXPECT_FALSE(fs::exists(out_ + "/3.png")) << number;
    } else {
      EXPECT_EQ(slurp(out_ + "/index") + slurp(out_ + "/2.png") + slurp(out_ + "/3.png"),
                "newnewnew")
          << number;
      EXPECT_FALSE(fs::exists(out_ + "/1.png")) << number;
    }
    write(out_, {"1.png", "2.png", "index"}, force_);
    EXPECT_EQ(everything(), old) << number;
  }
}

TEST_F(OutputFolderTest, OnADiskThatIsFullInTheMiddleOfTheListItIsAsBefore) {
  write(out_, {"1.png", "index"});
  const auto before = everything();
  OutputFolder folder(out_, force_);
  for (const char* name : {"1.png", "more.png", "index"}) spit(folder.file(name), "new");
  fail_call("pwrite", 1, ENOSPC);
  write_at_most(std::string(kListTitle).size() + 18);  // inside the new names
  EXPECT_THAT(complaint([&] { folder.commit("index"); }), HasSubstr("No space left"));
  let_all_succeed();
  EXPECT_EQ(slurp(out_ + "/.headpin"), before.at("out/.headpin"));
}

TEST_F(OutputFolderTest, TheFileThatStandsForAllGoesFirstAndComesLast) {
  write(out_, {"1.png", "2.png", "index"});
  std::vector<std::string> moved;
  for (const Change& c : changes_of([&] { write(out_, {"1.png", "2.png", "index"}, force_); })) {
    if (c.kind == Change::kRename) moved.push_back(c.other.substr(c.other.find("out/")));
  }
  EXPECT_THAT(moved, testing::ElementsAre("out/.headpin.old/index", "out/.headpin.old/1.png",
                                          "out/.headpin.old/2.png", "out/1.png", "out/2.png",
                                          "out/index", "out/.headpin.gone"));
}

// What is kept there meanwhile has names that nobody asked for.
TEST_F(OutputFolderTest, OnADiskThatIsFullFromTheStartTheFolderIsNamed) {
  fail_call("write", 0, ENOSPC);
  EXPECT_THAT(refused(out_), testing::EndsWith("/out: cannot be written: No space left on device"));
  let_all_succeed();
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(OutputFolderTest, TextThatTheDiskDoesNotTakeIsSaidUnderItsNameInTheEnd) {
  OutputFolder folder(out_, {});
  OutputText text(folder.file("a.csv"));
  fail_call("write", 0, ENOSPC);
  EXPECT_THAT(complaint([&] { text << std::string(1'000'000, 'x'); }),
              testing::EndsWith("out/a.csv: cannot be written: No space left on device"));
  let_all_succeed();
}

TEST_F(OutputFolderTest, TextIsThereToTheByte) {
  std::string all;
  {
    OutputFolder folder(out_, {});
    OutputText text(folder.file("a.csv"));
    for (int i = 0; i < 50'000; ++i) {
      all += std::to_string(i) + ",";
      text << i << ",";
    }
    text.close();
    folder.commit("a.csv");
  }
  EXPECT_EQ(slurp(out_ + "/a.csv"), all);
}

}  // namespace
}  // namespace headpin::files
