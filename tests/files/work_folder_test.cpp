#include "files/work_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/output_folder.h"
#include "tests/files/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::files {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(WorkFolderTest, RemovesWhatItsListNamesAndNothingElse) {
  const TemporaryFolder folder;
  {
    WorkFolder work(folder / "work");
    spit(work.file("a"), "ours");
    OutputFolder inner(work.folder("inner").string(), {});
    spit(inner.file("index"), "ours");
    inner.commit("index");
  }
  EXPECT_FALSE(fs::exists(folder / "work"));
  {
    WorkFolder work(folder / "work");
    spit(work.file("a"), "ours");
    spit(folder / "work/thesis.tex", "precious");
    fs::create_directory(folder / "precious");
    spit(folder / "precious/a", "precious");
    fs::create_directory_symlink(folder / "precious", work.folder("link"));
  }
  EXPECT_FALSE(fs::exists(folder / "work/a"));
  EXPECT_EQ(slurp(folder / "work/thesis.tex"), "precious");
  EXPECT_EQ(slurp(folder / "precious/a"), "precious");
}

TEST(WorkFolderTest, AFolderOfAnotherIsNotTaken) {
  const TemporaryFolder folder;
  spit(folder / "full/what", "n");
  EXPECT_THAT(complaint([&] { WorkFolder work(folder / "full"); }),
              HasSubstr("full: exists already, and headpin did not make it"));
  EXPECT_EQ(slurp(folder / "full/what"), "n");
  {
    WorkFolder ours(folder / "ours");
    ours.keep(true);
  }
  fs::create_directory_symlink("ours", folder / "link");
  EXPECT_THAT(complaint([&] { WorkFolder work(folder / "link"); }),
              HasSubstr("link: exists already, and headpin did not make it"));
  spit(folder / "ours/thesis.tex", "precious");
  EXPECT_THAT(complaint([&] { WorkFolder work(folder / "ours"); }), HasSubstr("holds thesis.tex"));
}

// A folder whose reading fails is not an empty one, which would be taken over.
TEST(WorkFolderTest, AFolderThatCannotBeReadIsNotTaken) {
  const TemporaryFolder folder;
  const std::string path = folder / "taken";
  fs::create_directory(path);
  spit(path + "/precious", "precious");
  fail_call("readdir", 0, EIO);
  EXPECT_THAT(complaint([&] { WorkFolder(path).clear(); }), testing::HasSubstr("cannot be read"));
  let_all_succeed();
  EXPECT_EQ(slurp(path + "/precious"), "precious");
}

}  // namespace
}  // namespace headpin::files
