#include "base/output_folder.h"

#include <algorithm>
#include <csignal>
#include <optional>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/lock.h"
#include "base/output_text.h"
#include "tests/base/failing_calls.h"
#include "tests/base/output_folder_fixture.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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
  EXPECT_THAT(refused(out_), HasSubstr("out: exists already"));
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

TEST_F(OutputFolderTest, AFolderThatAnotherMakesMeanwhileWillDo) {
  do_before_call("mkdir", 0, [&] { fs::create_directory(folder_ / "deep"); });
  EXPECT_EQ(refused(folder_ / "deep/down"), "");
  let_all_succeed();
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

TEST_F(OutputFolderTest, AFileThatWasNotWrittenIsSaid) {
  OutputFolder folder(out_, {});
  spit(folder.file("index"), "new");
  folder.file("1.png");
  EXPECT_THAT(complaint([&] { folder.commit("index"); }),
              HasSubstr("1.png cannot be written: No such file"));
}

TEST_F(OutputFolderTest, WhatAnotherPutsThereBeforeItIsLockedIsForeign) {
  do_before_call("flock", 0, [&] { spit(out_ + "/notes.txt", "precious"); });
  EXPECT_THAT(refused(out_), HasSubstr("holds notes.txt"));
  let_all_succeed();
  EXPECT_EQ(slurp(out_ + "/notes.txt"), "precious");
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
}  // namespace headpin::base
