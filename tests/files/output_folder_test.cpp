#include "files/output_folder.h"

#include <csignal>
#include <map>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
    for (const std::string& name : names) spit(folder.part() / name, name);
    folder.commit(names.back());
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
    spit(folder.part() / "1.png", "half");
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
                HasSubstr("used by this very command"));
  }
  EXPECT_TRUE(fs::is_empty(out_));
  EXPECT_EQ(refused(out_, {.others = {folder_ / "outside", folder_ / "out2/in"}}), "");
}

TEST_F(OutputFolderTest, TwoAtOnceAreOneAndOneRefused) {
  std::optional<OutputFolder> first(std::in_place, out_, OutputFolder::Options{});
  spit(first->part() / "index", "the first's");
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
        spit(folder.part() / "index", "half");
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
    spit(folder.part() / "1.png", "ours");
    spit(folder.part() / "index", "ours");
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

}  // namespace
}  // namespace headpin::files
