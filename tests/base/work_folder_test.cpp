#include "base/work_folder.h"

#include <cerrno>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/output_folder.h"
#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
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
  EXPECT_THAT(complaint([&] { WorkFolder work(folder / "full/what"); }),
              HasSubstr("what: exists already, and headpin did not make it"));
  fail_call("openat", 0, EMFILE);
  EXPECT_THAT(complaint([&] { WorkFolder work(folder / "new"); }),
              HasSubstr("new: cannot be opened: Too many open files"));
  let_all_succeed();
}

// A folder whose reading fails is not an empty one, which would be taken over.
TEST(WorkFolderTest, AFolderThatCannotBeReadIsNotTaken) {
  const TemporaryFolder folder;
  const std::string path = folder / "taken";
  fs::create_directory(path);
  spit(path + "/precious", "precious");
  for (const char* call : {"readdir", "fdopendir"}) {
    fail_call(call, 0, EIO);
    EXPECT_THAT(complaint([&] { WorkFolder(path).clear(); }),
                HasSubstr("a folder cannot be read: Input/output error"));
    let_all_succeed();
    EXPECT_EQ(slurp(path + "/precious"), "precious");
  }
}

constexpr const char* kTitle = kListTitle;

// A crash may cut it anywhere.
TEST(WorkFolderTest, AListThatIsCutIsWrittenOn) {
  const std::string title = kTitle;
  for (const auto& [cut, now] : {std::pair{title.substr(0, 10), title + "a\n"},
                                 {std::string(), title + "a\n"},
                                 {title, title + "a\n"},
                                 {title + "1.pn", title + "1.pn\na\n"},
                                 {title + "1.png\n", title + "1.png\na\n"}}) {
    const TemporaryFolder folder;
    spit(folder / "work/.headpin", cut);
    WorkFolder work(folder / "work");
    work.file("a");
    work.keep(true);
    EXPECT_EQ(slurp(folder / "work/.headpin"), now) << cut;
  }
}

std::set<std::string> listed_in(const std::string& text, bool expected) {
  const TemporaryFolder folder;
  spit(folder / ".headpin", text);
  const int at = open_folder(AT_FDCWD, folder.path().string());
  std::set<std::string> names;
  EXPECT_EQ(read_list(at, names), expected) << text;
  close(at);
  return names;
}

TEST(WorkFolderTest, OnItsListIsWhatIsInIt) {
  const std::string title = kTitle;
  EXPECT_EQ(
      listed_in(
          title + "a\nb/\n\n/\n.\n./\n..\n../\n./c\n../d\n/etc/passwd\ne/f\n.hidden\n..g\nlast",
          true),
      (std::set<std::string>{"a", "b/", ".hidden", "..g"}));
  EXPECT_TRUE(listed_in(title, true).empty());
  EXPECT_TRUE(listed_in(title.substr(0, 5), true).empty());
  EXPECT_TRUE(listed_in("shopping\na\n", false).empty());
}

TEST(WorkFolderTest, ALinkThatTakesThePlaceOfItsListMeanwhileIsNotFollowed) {
  const TemporaryFolder folder;
  spit(folder / "other", std::string(kTitle) + "a\n");
  spit(folder / ".headpin", kTitle);
  const int at = open_folder(AT_FDCWD, folder.path().string());
  do_before_call("openat", 0, [&] {
    fs::remove(folder / ".headpin");
    fs::create_symlink("other", folder / ".headpin");
  });
  std::set<std::string> names;
  EXPECT_THAT(complaint([&] { read_list(at, names); }), HasSubstr(".headpin: Too many levels"));
  let_all_succeed();
  EXPECT_TRUE(names.empty());
  close(at);
}

TEST(WorkFolderTest, ForeignIsWhatIsNeitherListedNorAPartOfThatNorABook) {
  const std::set<std::string> names = {"a", "b/"};
  const auto foreign = [&](const std::string& name, bool is_folder) {
    const TemporaryFolder folder;
    if (is_folder) fs::create_directory(folder / name);
    if (!is_folder) spit(folder / name, "x");
    const int at = open_folder(AT_FDCWD, folder.path().string());
    const std::string found = find_foreign(at, names);
    close(at);
    EXPECT_TRUE(found.empty() || found == name) << found;
    return !found.empty();
  };
  for (const char* name : {"a", "a.12-3.part", ".headpin"}) EXPECT_FALSE(foreign(name, false));
  for (const char* name : {"b", ".headpin.part", ".headpin.old", ".headpin.gone"}) {
    EXPECT_FALSE(foreign(name, true)) << name;
  }
  for (const char* name : {"c", ".headpine", "a.part", ".part", "x.12-3.part", "a.12-3.parts",
                           "a.12x3.part", "a12-3.part", "aa.12-3.part"}) {
    EXPECT_TRUE(foreign(name, false)) << name;
  }
  for (const char* name : {"a", "c", "a.12-3.part"}) EXPECT_TRUE(foreign(name, true)) << name;
}

TEST(WorkFolderTest, IsForOneAlone) {
  const TemporaryFolder folder;
  WorkFolder work(folder / "work");
  spit(work.file("a"), "ours");
  EXPECT_THROW(WorkFolder(folder / "work"), Busy);
  EXPECT_EQ(slurp(folder / "work/a"), "ours");
}

// Nor is one that another run of ours has put results into.
TEST(WorkFolderTest, ALinkToAFolderOfOursIsNotFollowed) {
  for (const bool clears : {false, true}) {
    const TemporaryFolder folder;
    {
      WorkFolder other(folder / "other");
      spit(other.file("a"), "precious");
      other.keep(true);
    }
    {
      WorkFolder work(folder / "work");
      fs::create_directory_symlink(folder / "other", work.folder("link"));
      if (clears) {
        EXPECT_THAT(complaint([&] { work.clear(); }), HasSubstr("link: cannot be removed"));
      }
    }
    EXPECT_EQ(slurp(folder / "other/a"), "precious");
    EXPECT_TRUE(fs::is_symlink(folder / "work/link"));
  }
}

TEST(WorkFolderTest, ClearedItIsEmptyAndStillOurs) {
  const TemporaryFolder folder;
  WorkFolder work(folder / "work");
  spit(work.file("a"), "ours");
  spit(folder / "work/a.12-3.part", "ours");
  {
    WorkFolder inner(work.folder("inner"));
    spit(inner.file("b"), "ours");
    inner.keep(true);
  }
  work.clear();
  EXPECT_TRUE(work.names().empty());
  EXPECT_EQ(slurp(folder / "work/.headpin"), kTitle);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "work"), fs::directory_iterator()), 1);
  EXPECT_THROW(WorkFolder(folder / "work"), Busy);
  work.file("c");
  EXPECT_EQ(slurp(folder / "work/.headpin"), std::string(kTitle) + "c\n");
}

TEST(WorkFolderTest, WhatCannotBeClearedIsSaid) {
  const TemporaryFolder folder;
  WorkFolder work(folder / "work");
  const fs::path inner = work.folder("inner");
  spit(inner / "thesis.tex", "precious");
  fs::create_symlink("nowhere", work.file("a"));
  EXPECT_THAT(complaint([&] { work.clear(); }),
              testing::AnyOf(HasSubstr("work/inner: cannot be removed"),
                             HasSubstr("work/a: cannot be removed")));
  EXPECT_EQ(slurp(inner / "thesis.tex"), "precious");
  EXPECT_TRUE(fs::is_symlink(folder / "work/a"));
  fs::remove_all(inner);
  fs::remove(folder / "work/a");
  fail_call("ftruncate", 0, EIO);
  EXPECT_THAT(complaint([&] { work.clear(); }),
              HasSubstr("work: cannot be written: Input/output error"));
  let_all_succeed();
}

TEST(WorkFolderTest, ItsListTakesWhatTheDiskTakesAndSaysWhatItDoesNot) {
  const TemporaryFolder folder;
  WorkFolder work(folder / "work");
  EXPECT_EQ(complaint([&] { work.sync(); }), "");
  for (const int number : {0, 1}) {  // its list, its names
    fail_call("fsync", number, EIO);
    EXPECT_THAT(complaint([&] { work.sync(); }),
                HasSubstr("work: cannot be written: Input/output error"));
  }
  write_at_most(3);
  work.file("first");
  let_all_succeed();
  fail_call("write", 0, EINTR);
  work.file("second");
  EXPECT_EQ(slurp(folder / "work/.headpin"), std::string(kTitle) + "first\nsecond\n");
  fail_call("write", 0, ENOSPC);
  EXPECT_THAT(complaint([&] { work.file("a"); }), HasSubstr("work: cannot be written: No space"));
  let_all_succeed();
}

TEST(WorkFolderTest, WhenAnyCallOfItsMakingFailsAllIsAsBefore) {
  for (const bool was_there : {false, true}) {
    const TemporaryFolder folder;
    if (was_there) {
      WorkFolder before(folder / "work");
      spit(before.file("a"), "ours");
      before.keep(true);
      spit(folder / "work/.headpin", std::string(kTitle) + "a\nb");  // cut by a crash
    }
    for (const char* call :
         {"mkdir", "openat", "readdir", "read", "write", "ftruncate", "pread", "flock"}) {
      for (int number = 0, failed = 1; failed != 0; ++number) {
        fail_call(call, number, call == std::string("flock") ? EWOULDBLOCK : EIO);
        failed = complaint([&] { WorkFolder(folder / "work").keep(true); }).empty() ? 0 : 1;
        let_all_succeed();
        EXPECT_EQ(fs::exists(folder / "work"), was_there || failed == 0) << call << number;
        EXPECT_EQ(fs::exists(folder / "work/a"), was_there) << call << number;
        if (!was_there) fs::remove_all(folder / "work");
      }
    }
  }
}

TEST(WorkFolderTest, FilesThatTellOfAFolderAreNotForeign) {
  const TemporaryFolder folder;
  for (const char* name : {"README.md", "readme.txt", "LICENSE", "Licence.md", "COPYING", ".git"}) {
    spit(folder / name, "theirs");
  }
  fs::create_symlink("docs/README.md", folder / "README");
  const auto begun = [&] { require_no_foreign(folder.path(), {}); };
  EXPECT_EQ(complaint(begun), "");
  fs::create_directory(folder / "readme-pictures");
  EXPECT_THAT(complaint(begun), HasSubstr("holds readme-pictures, which headpin did not write"));
}

// A link to a given file, or to the folder in which it is given, was one of others.
TEST(WorkFolderTest, LinksToWhatIsGivenAreNotForeign) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "mine");
  spit(folder / "shared/design.toml", "theirs");
  fs::create_symlink("../shared/design.toml", folder / "mine/design.toml");
  fs::create_directory_symlink("../shared", folder / "mine/linked");
  const auto complaint_with = [&](const std::vector<fs::path>& given) {
    return complaint([&] { require_no_foreign(folder / "mine", {"design.toml"}, given); });
  };
  const fs::path inside = folder / "mine/linked/design.toml";
  EXPECT_EQ(complaint_with({inside}), "");
  EXPECT_THAT(complaint_with({}), HasSubstr("holds design.toml"));
  fs::remove(folder / "mine/linked");
  EXPECT_EQ(complaint_with({folder / "shared/design.toml"}), "");
}

}  // namespace
}  // namespace headpin::base
