#include "base/names.h"

#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/lock.h"
#include "base/output_file.h"
#include "base/temporary.h"
#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NamesTest : public testing::Test {
 protected:
  ~NamesTest() override { let_all_succeed(); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  TemporaryFolder folder_;
};

TEST_F(NamesTest, ALinkIsPlacedInOneStepAndInPlaceOfALinkAlone) {
  place_link("one", path("link"));
  EXPECT_EQ(fs::read_symlink(path("link")), "one");
  place_link("two", path("link"));
  EXPECT_EQ(fs::read_symlink(path("link")), "two");
  spit(path("file"), "precious");
  EXPECT_THAT(complaint([&] { place_link("two", path("file")); }),
              HasSubstr("file: cannot be created: File exists"));
  EXPECT_EQ(slurp(path("file")), "precious");
  EXPECT_EQ(entries(), 2u);
}

TEST_F(NamesTest, ALinkThatCannotBePlacedLeavesNothing) {
  EXPECT_THAT(
      complaint([&] { place_link("one", path("none/link")); }),
      testing::EndsWith("none/link: cannot be created: there is no folder " + path("none")));
  spit(path("file"), "precious");
  EXPECT_THAT(complaint([&] { place_link("one", path("file/link")); }),
              testing::EndsWith("link: cannot be created: " + path("file") + " is not a folder"));
  fs::remove(path("file"));
  place_link("old", path("link"));
  fail_call("rename", 0, EACCES);
  EXPECT_THAT(complaint([&] { place_link("new", path("link")); }),
              testing::EndsWith("link: cannot be created: Permission denied"));
  EXPECT_EQ(fs::read_symlink(path("link")), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(NamesTest, ALinkThatLeadsElsewhereByNowIsNotRemoved) {
  place_link("one", path("link"));
  remove_link("two", path("link"));
  remove_link("on", path("link"));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  spit(path("file"), "precious");
  remove_link("one", path("file"));
  EXPECT_EQ(slurp(path("file")), "precious");
  remove_link("one", path("link"));
  EXPECT_FALSE(fs::is_symlink(path("link")));
}

TEST_F(NamesTest, APipeThatIsAnotherByNowIsNotRemoved) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(path("other").c_str(), 0600), 0);
  spit(path("file"), "precious");
  const int pipe = open(path("pipe").c_str(), O_RDWR | O_CLOEXEC);
  const int file = open(path("file").c_str(), O_RDONLY | O_CLOEXEC);
  remove_pipe(path("other"), pipe);
  EXPECT_TRUE(fs::exists(path("other")));
  remove_pipe(path("file"), file);  // no pipe
  EXPECT_TRUE(fs::exists(path("file")));
  remove_pipe(path("pipe"), -1);
  EXPECT_TRUE(fs::exists(path("pipe")));
  remove_pipe(path("none"), pipe);
  fs::create_symlink("pipe", path("link"));
  remove_pipe(path("link"), pipe);
  EXPECT_TRUE(fs::is_symlink(path("link")));
  remove_pipe(path("pipe"), pipe);
  EXPECT_FALSE(fs::exists(path("pipe")));
  close(pipe);
  close(file);
}

TEST_F(NamesTest, FilesWithoutANameAndFoldersOfOursAreInTMPDIR) {
  const char* told = std::getenv("TMPDIR");
  const std::string before = told != nullptr ? told : "";
  const auto works = [&] {
    const int file = nameless_file();
    char byte = 0;
    const bool whole = write(file, "x", 1) == 1 && pread(file, &byte, 1, 0) == 1 && byte == 'x';
    struct stat is {
    }, folder{};
    const bool here = fstat(file, &is) == 0 && stat(folder_.path().c_str(), &folder) == 0 &&
                      is.st_dev == folder.st_dev && is.st_nlink == 0;
    const bool closes = (fcntl(file, F_GETFD) & FD_CLOEXEC) != 0;
    close(file);
    return whole && here && closes && entries() == 0;
  };
  setenv("TMPDIR", folder_.path().c_str(), 1);
  EXPECT_TRUE(works());
  fail_call("open", 0, EOPNOTSUPP);  // a file system without such files
  EXPECT_TRUE(works());
  let_all_succeed();
  {
    const PrivateFolder ours, another;
    EXPECT_EQ(entries(), 2u);
    EXPECT_EQ(ours.path().parent_path(), folder_.path());
    EXPECT_EQ(fs::status(ours.path()).permissions(), fs::perms::owner_all);
    spit((ours.path() / "file").string(), "x");
  }
  EXPECT_EQ(entries(), 0u);
  setenv("TMPDIR", path("none").c_str(), 1);
  EXPECT_THAT(complaint([] { PrivateFolder(); }), HasSubstr("none: no folder can be made there: "));
  EXPECT_THAT(complaint([] { close(nameless_file()); }),
              testing::AllOf(HasSubstr("TMPDIR: "), HasSubstr("none: no file can be made there: "
                                                              "No such file")));
  setenv("TMPDIR", "", 1);  // as if it were not set
  EXPECT_EQ(complaint([] { close(nameless_file()); }), "");
  if (told != nullptr) {
    setenv("TMPDIR", before.c_str(), 1);
  } else {
    unsetenv("TMPDIR");
  }
}

/// Moves from -> to in the folder.
int renamed(const TemporaryFolder& folder, const std::string& from, const std::string& to) {
  const int at = open(folder.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int result = rename_new(at, from, at, to);
  const int error = errno;
  close(at);
  errno = error;
  return result;
}

// Some file systems know no rename that refuses to replace; EINVAL and ENOSYS say so.
TEST_F(NamesTest, ANewNameReplacesNothingOnAnyFileSystem) {
  for (const int error : {0, EINVAL, ENOSYS}) {
    const auto on_such = [&](const std::string& from, const std::string& to) {
      if (error != 0) fail_call("renameat2", 0, error);
      const int result = renamed(folder_, from, to);
      const int why = errno;
      let_all_succeed();
      errno = why;
      return result;
    };
    spit(path("a"), "a");
    spit(path("b"), "precious");
    EXPECT_EQ(on_such("a", "b"), -1) << error;
    EXPECT_EQ(errno, EEXIST) << error;
    EXPECT_EQ(slurp(path("b")), "precious") << error;
    EXPECT_EQ(on_such("a", "c"), 0) << error;
    EXPECT_EQ(slurp(path("c")), "a") << error;
    EXPECT_FALSE(fs::exists(path("a"))) << error;
    EXPECT_EQ(on_such("none", "d"), -1) << error;
    fs::create_directory(path("folder"));
    EXPECT_EQ(on_such("folder", "other"), 0) << error;
    EXPECT_TRUE(fs::is_directory(path("other"))) << error;
    for (const char* name : {"b", "c", "other"}) fs::remove(path(name));
    EXPECT_EQ(entries(), 0u);
  }
  spit(path("a"), "a");
  fail_call("renameat2", 0, EACCES);  // any other error is one
  EXPECT_EQ(renamed(folder_, "a", "b"), -1);
  EXPECT_EQ(errno, EACCES);
  EXPECT_FALSE(fs::exists(path("b")));
}

TEST_F(NamesTest, TwoNamesOfAFileAreTheSameFile) {
  spit(path("a"), "x");
  spit(path("b"), "x");
  fs::create_hard_link(path("a"), path("twin"));
  fs::create_symlink("a", path("link"));
  EXPECT_TRUE(same_file(path("a"), path("twin")));
  EXPECT_TRUE(same_file(path("link"), path("a")));
  EXPECT_FALSE(same_file(path("a"), path("b")));
  EXPECT_FALSE(same_file(path("a"), path("none")));
  EXPECT_FALSE(same_file(path("none"), path("a")));
  EXPECT_FALSE(same_file(path("none"), path("none")));
}

// The first folders of two file systems often have the same number.
TEST_F(NamesTest, AFileOfTheSameNumberOnAnotherDiskIsAnother) {
  struct stat proc {
  }, sys{};
  if (stat("/proc", &proc) != 0 || stat("/sys", &sys) != 0 || proc.st_ino != sys.st_ino) {
    GTEST_SKIP() << "no two of the same number are known here";
  }
  EXPECT_FALSE(same_file("/proc", "/sys"));
}

TEST_F(NamesTest, ALockIsForOneAndOfAFileThatKnowsNoneForAll) {
  spit(path("a"), "x");
  const int one = open(path("a").c_str(), O_RDONLY | O_CLOEXEC);
  const int two = open(path("a").c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_TRUE(lock(one));
  EXPECT_FALSE(lock(two));
  close(one);
  EXPECT_TRUE(lock(two));
  close(two);
  EXPECT_TRUE(lock(-1));  // EBADF: no lock can be had
}

}  // namespace
}  // namespace headpin::base
