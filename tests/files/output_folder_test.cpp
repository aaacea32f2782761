#include "files/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <map>
#include <optional>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/lock.h"
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
      EXPECT_EQ(was_asked, has_failed()) << call << " " << number;
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

TEST_F(OutputFolderTest, ItsListIsWholeWhateverTheDiskTakesAtOnce) {
  const auto list_after = [&](const auto& meddle) {
    fs::remove_all(out_);
    meddle();
    write(out_, {"1.png", "2.png", "index"});
    let_all_succeed();
    return slurp(out_ + "/.headpin");
  };
  const std::string whole = std::string(kListTitle) + "1.png\n2.png\nindex\n";
  EXPECT_EQ(list_after([] {}), whole);
  EXPECT_EQ(list_after([] { fail_call("pwrite", 0, EINTR); }), whole);
  EXPECT_EQ(list_after([] { fail_call("pwrite", 1, EINTR); }), whole);
  fs::remove_all(out_);
  OutputFolder folder(out_, {});
  for (const char* name : {"1.png", "2.png", "index"}) spit(folder.file(name), name);
  write_at_most(5);
  folder.commit("index");
  let_all_succeed();
  EXPECT_EQ(slurp(out_ + "/.headpin"), whole);
}

TEST_F(OutputFolderTest, AFolderThatAnotherMakesMeanwhileWillDo) {
  do_before_call("mkdir", 0, [&] { fs::create_directory(folder_ / "deep"); });
  EXPECT_EQ(refused(folder_ / "deep/down"), "");
  let_all_succeed();
}

TEST_F(OutputFolderTest, OfFoldersThatCannotAllBeMadeNoneIsLeft) {
  for (const int number : {0, 1, 2}) {
    fail_call("mkdir", number, EACCES);
    EXPECT_THAT(refused(folder_ / "deep/er/down"),
                HasSubstr("deep/er/down: cannot be made: Permission denied"));
    let_all_succeed();
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
}

TEST_F(OutputFolderTest, WhatCannotBeReachedIsNotNothing) {
  EXPECT_THAT(refused(folder_ / (std::string(300, 'n') + "/out")),
              HasSubstr("cannot be written: File name too long"));
  fs::create_symlink("round", folder_ / "round");
  fs::create_directory(out_);
  EXPECT_THAT(refused(out_, {.others = {folder_ / "round" / "a"}}), HasSubstr("round/a: Too many"));
}

// As one that is just done does.
TEST_F(OutputFolderTest, AListThatIsRemovedBeforeItIsLockedIsMadeAgain) {
  do_before_call("flock", 0, [&] { fs::remove(out_ + "/.headpin"); });
  OutputFolder folder(out_, {});
  let_all_succeed();
  EXPECT_TRUE(fs::exists(out_ + "/.headpin"));
  EXPECT_THROW(OutputFolder(out_, force_), Busy);
  for (const char* name : {"1.png", "index"}) spit(folder.file(name), "new");
  folder.commit("index");
  EXPECT_EQ(slurp(out_ + "/.headpin"), std::string(kListTitle) + "1.png\nindex\n");
}

TEST_F(OutputFolderTest, AListThatAnotherMakesBeforeItIsLockedIsTheOneThatCounts) {
  const std::string list = out_ + "/.headpin";
  do_before_call("flock", 0, [&] {
    spit(out_ + "/another", "");
    fs::rename(out_ + "/another", list);
  });
  OutputFolder folder(out_, {});
  let_all_succeed();
  const int counts = open(list.c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_FALSE(lock(counts));
  close(counts);
}

TEST_F(OutputFolderTest, FewFilesAreSyncedOneByOneAndManyAtOnce) {
  for (const std::size_t many : {32u, 33u}) {
    fs::remove_all(out_);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < many; ++i) names.push_back(std::to_string(i) + ".png");
    std::size_t single = 0, all = 0;
    for (const Change& c : changes_of([&] { write(out_, names); })) {
      if (c.kind == Change::kSync && c.path.ends_with(".png")) ++single;
      if (c.kind == Change::kSyncAll) ++all;
    }
    EXPECT_EQ(single, many == 32 ? 32u : 0u);
    EXPECT_EQ(all, many == 32 ? 0u : 1u);
  }
  std::vector<std::string> names;
  for (int i = 0; i < 33; ++i) names.push_back(std::to_string(i) + ".png");
  fs::remove_all(out_);
  fail_call("syncfs", 0, EIO);
  EXPECT_THAT(complaint([&] { write(out_, names); }),
              HasSubstr("out: cannot be written: Input/output error"));
  let_all_succeed();
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(OutputFolderTest, AFileThatWasNotWrittenIsSaid) {
  OutputFolder folder(out_, {});
  spit(folder.file("index"), "new");
  folder.file("1.png");
  EXPECT_THAT(complaint([&] { folder.commit("index"); }),
              HasSubstr("1.png cannot be written: No such file"));
}

// The disk fails in the middle and does not come back until the next run.
TEST_F(OutputFolderTest, WhatCannotBeMovedBackIsSaidAndComesBackWithTheNext) {
  write(out_, {"1.png", "2.png", "index"});
  const auto before = everything();
  for (int number = 1; number < 7; ++number) {
    fail_calls_from("renameat2", number, EIO);
    const std::string said = complaint([&] { replace(); });
    let_all_succeed();
    EXPECT_THAT(
        said, testing::AllOf(HasSubstr("Input/output error"),
                             HasSubstr("; and these could not be moved back:"), HasSubstr(" index"),
                             testing::EndsWith("; the old ones are in " + out_ + "/.headpin.old")))
        << number;
    const std::string stuck = said.substr(said.find("moved back:"));
    EXPECT_EQ(stuck.find(" 1.png") != std::string::npos, number > 1) << number;
    EXPECT_THAT(refused(out_), HasSubstr("exists already")) << number;
    const auto now = everything();
    for (const auto& [name, text] : before) {
      if (name != "out/.headpin") {
        EXPECT_EQ(now.count(name) == 1 ? now.at(name) : "none", text) << number << name;
      }
    }
    EXPECT_FALSE(fs::exists(out_ + "/3.png")) << number;
    EXPECT_FALSE(fs::exists(out_ + "/.headpin.old")) << number;
    EXPECT_FALSE(fs::exists(out_ + "/.headpin.part")) << number;
    write(out_, {"1.png", "2.png", "index"}, force_);
    EXPECT_EQ(everything(), before) << number;
  }
}

// Until they are back they are nowhere else.
TEST_F(OutputFolderTest, OldFilesThatCannotBeMovedBackByTheNextEitherWait) {
  write(out_, {"1.png", "2.png", "index"});
  const auto before = everything();
  for (int number = 0; number < 4; ++number) {
    fail_calls_from("renameat2", 4, EIO);
    EXPECT_NE(complaint([&] { replace(); }), "");
    fail_calls_from("renameat2", number, EIO);
    EXPECT_THAT(refused(out_), HasSubstr("Input/output error")) << number;
    let_all_succeed();
    EXPECT_THAT(refused(out_), HasSubstr("exists already")) << number;
    for (const char* name : {"1.png", "2.png", "index"}) EXPECT_EQ(slurp(out_ + "/" + name), name);
    write(out_, {"1.png", "2.png", "index"}, force_);
    EXPECT_EQ(everything(), before);
  }
}

TEST_F(OutputFolderTest, WhileAnotherIsWritingThereNothingIsMovedBack) {
  write(out_, {"1.png", "2.png", "index"});
  fail_calls_from("renameat2", 4, EIO);
  EXPECT_NE(complaint([&] { replace(); }), "");
  let_all_succeed();
  const int list = open((out_ + "/.headpin").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_TRUE(lock(list));
  const auto before = everything();
  EXPECT_THROW(OutputFolder(out_, force_), Busy);
  EXPECT_EQ(everything(), before);
  close(list);
}

TEST_F(OutputFolderTest, WhatAnotherPutsThereBeforeItIsLockedIsForeign) {
  do_before_call("flock", 0, [&] { spit(out_ + "/notes.txt", "precious"); });
  EXPECT_THAT(refused(out_), HasSubstr("holds notes.txt"));
  let_all_succeed();
  EXPECT_EQ(slurp(out_ + "/notes.txt"), "precious");
}

TEST_F(OutputFolderTest, NewFilesThatCannotBeMovedBackAreTheNextOnesToReplace) {
  fail_calls_from("renameat2", 1, EIO);
  EXPECT_THAT(refused(out_), HasSubstr("could not be moved back: 1.png;"));
  let_all_succeed();
  EXPECT_EQ(refused(out_, force_), "");
  EXPECT_EQ(slurp(out_ + "/1.png") + slurp(out_ + "/index"), "1.pngindex");
  EXPECT_EQ(slurp(out_ + "/.headpin"), std::string(kListTitle) + "1.png\nindex\n");
}

TEST_F(OutputFolderTest, WhenAnyCallOfItsMakingFailsWhatIsThereStays) {
  for (const bool was_there : {false, true}) {
    if (was_there) write(out_, {"1.png", "index"});
    const auto before = everything();
    for (const char* call : {"mkdir", "openat", "readdir", "read", "write", "pwrite"}) {
      for (int number = 0, failed = 1; failed != 0; ++number) {
        fail_call(call, number, call == std::string("flock") ? EWOULDBLOCK : EIO);
        failed = complaint([&] { OutputFolder(out_, force_); }).empty() ? 0 : 1;
        let_all_succeed();
        if (failed != 0) {
          EXPECT_EQ(everything(), before) << call << " " << number;
        }
        if (number > 200) FAIL() << call;
      }
      // What could not be removed in the end is removed by the next.
      if (was_there) OutputFolder(out_, force_);
      if (!was_there) fs::remove_all(out_);
    }
    fs::remove_all(out_);
  }
}

TEST_F(OutputFolderTest, TextReplacesWhatIsThereAndDoesNotWaitForTheDisk) {
  spit(folder_ / "a.csv", "old");
  const auto changes = changes_of([&] {
    OutputText text(folder_ / "a.csv");
    text << "new";
    text.close();
  });
  EXPECT_EQ(slurp(folder_ / "a.csv"), "new");
  EXPECT_EQ(std::ranges::count(changes, Change::kSync, &Change::kind), 0);
}

}  // namespace
}  // namespace headpin::files
