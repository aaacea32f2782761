// Lines that are on the disk or not there.

#include "base/line_file.h"

#include <cerrno>
#include <csignal>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "base/left_parts.h"
#include "base/lock.h"
#include "base/output_file.h"
#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

TEST(LineFile, LinesAreAddedAndReadAgain) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  {
    LineFile file(path);
    EXPECT_EQ(file.text(), "");
    file.append("one\n");
    file.append("two\nthree\n");
  }
  EXPECT_EQ(LineFile(path).text(), "one\ntwo\nthree\n");
}

TEST(LineFile, HalfALineIsCutOffWhereThatIsAskedFor) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  spit(path, "one\ntw");
  {
    LineFile file(path);
    EXPECT_EQ(file.text(), "one\ntw");
    EXPECT_EQ(file.whole_lines(), "one\n");
    file.cut_last_line();
    file.append("two\n");
  }
  EXPECT_EQ(slurp(path), "one\ntwo\n");
}

// As editors leave them: without the last end, or with the ends of old Macintoshes.
TEST(LineFile, ALastLineWithoutAnEndIsKeptAndGetsItsEnd) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  for (const auto& [before, after] : {std::pair{"one\ntwo", "one\ntwo\nthree\n"},
                                      {"one", "one\nthree\n"},
                                      {"one\rtwo\r", "one\rtwo\rthree\n"},
                                      {"one\r\n", "one\r\nthree\n"}}) {
    spit(path, before);
    {
      LineFile file(path);
      EXPECT_EQ(slurp(path), before) << "it was only opened";
      file.append("three\n");
    }
    EXPECT_EQ(slurp(path), after);
  }
}

TEST(LineFile, IsOpenForOneAlone) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  std::optional<LineFile> file(path);
  EXPECT_THROW(LineFile other(path), Busy);
  file.reset();
  EXPECT_NO_THROW(LineFile other(path));
}

// A limit on the size of files is a disk that is full after so many bytes.
TEST(LineFile, OnAFullDiskTheFileIsAsBefore) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  LineFile file(path);
  file.append("12345\n");
  const rlimit small{10, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_NE(complaint([&] { file.append("67890\n"); }), "");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(slurp(path), "12345\n");
  file.append("67890\n");
  EXPECT_EQ(slurp(path), "12345\n67890\n");
}

// Whatever the disk does: a line is there to the byte, or none of it is.
TEST(LineFile, ALineIsWholeWhateverTheDiskDoes) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  LineFile file(path);
  file.append("one\n");
  for (const char* call : {"write", "fdatasync"}) {
    fail_call(call, 0, EIO);
    EXPECT_THAT(complaint([&] { file.append("two\n"); }),
                testing::EndsWith("lines: cannot be written: Input/output error"));
    let_all_succeed();
    EXPECT_EQ(slurp(path), "one\n") << call;
  }
  fail_call("write", 0, EINTR);
  file.append("two\n");
  let_all_succeed();
  write_at_most(4);  // and three in the end
  file.append("three and four\n");
  let_all_succeed();
  EXPECT_EQ(slurp(path), "one\ntwo\nthree and four\n");
}

TEST(LineFile, ThatIsNewHasItsNameOnTheDisk) {
  const TemporaryFolder folder;
  std::vector<std::string> synced;
  for (const Change& change : changes_of([&] { LineFile((folder / "lines").string()); })) {
    if (change.kind == Change::kSync) synced.push_back(change.path);
  }
  EXPECT_EQ(synced, std::vector<std::string>{folder.path().string()});
}

TEST(LineFile, ThatCannotBeOpenedIsSaid) {
  const TemporaryFolder folder;
  EXPECT_THAT(complaint([&] { LineFile((folder / "none/lines").string()); }),
              testing::HasSubstr("lines: cannot be opened: No such file"));
  spit(folder / "lines", "half");
  fail_call("ftruncate", 0, EIO);
  EXPECT_THAT(complaint([&] { LineFile((folder / "lines").string()).cut_last_line(); }),
              testing::HasSubstr("cannot be written: Input/output error"));
  let_all_succeed();
  EXPECT_NO_THROW(LineFile((folder / "lines").string()));  // nobody has it locked
}

TEST(LeftParts, AreRemovedWhereTheirProcessIsGone) {
  const TemporaryFolder folder;
  const std::string mine = "a.txt." + std::to_string(getpid()) + "-0.part";
  for (const std::string& name : {mine, std::string("a.txt.999999999-0.part"),
                                  std::string("notes.part"), std::string("b.999999999-1.parts")}) {
    spit(folder / name, "x");
  }
  std::filesystem::create_directory(folder / "c.999999999-0.part");
  remove_left_parts(folder.path().string());
  EXPECT_TRUE(std::filesystem::exists(folder / "c.999999999-0.part"));
  EXPECT_TRUE(std::filesystem::exists(folder / mine));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.999999999-0.part"));
  EXPECT_TRUE(std::filesystem::exists(folder / "notes.part"));
  EXPECT_TRUE(std::filesystem::exists(folder / "b.999999999-1.parts"));
}

// Whoever opens a file just before it is replaced has one without a name, whose lines nobody reads.
TEST(LineFile, ThatIsReplacedWhileItIsOpenedIsTheNewOne) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  spit(path, "old\n");
  do_before_call("flock", 0, [&] {
    std::filesystem::remove(path);
    spit(path, "new\n");
  });
  LineFile file(path);
  let_all_succeed();
  EXPECT_EQ(file.text(), "new\n");
  EXPECT_THROW(LineFile other(path), Busy);
  file.append("more\n");
  EXPECT_EQ(slurp(path), "new\nmore\n");
}

TEST(LineFile, IsReplacedByWhoeverHasItLockedWithoutATimeInWhichOthersGetIt) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  spit(path, "old\n");
  std::optional<LineFile> file(path);
  EXPECT_THROW(write_text({path, {.overwrite = true}}, "new\n"), Busy);
  do_before_call("renameat", 0, [&] { EXPECT_THROW(LineFile other(path), Busy); });
  write_text({path, {.overwrite = true, .locked = true}}, "new\n");
  let_all_succeed();
  EXPECT_EQ(LineFile(path).text(), "new\n");
  file.emplace(path);
  EXPECT_EQ(file->text(), "new\n");
}

}  // namespace
}  // namespace headpin::base
