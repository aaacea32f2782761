// Lines that are on the disk or not there.

#include "files/line_file.h"

#include <csignal>
#include <optional>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "files/left_parts.h"
#include "files/lock.h"
#include "tests/support/folder.h"

namespace headpin::files {
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

TEST(LineFile, HalfALineOfACrashIsCutOff) {
  const TemporaryFolder folder;
  const std::string path = (folder / "lines").string();
  spit(path, "one\ntw");
  {
    LineFile file(path);
    EXPECT_EQ(file.text(), "one\n");
    file.append("two\n");
  }
  EXPECT_EQ(slurp(path), "one\ntwo\n");
  spit(path, "on");
  EXPECT_EQ(LineFile(path).text(), "");
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

TEST(LeftParts, AreRemovedWhereTheirProcessIsGone) {
  const TemporaryFolder folder;
  const std::string mine = "a.txt." + std::to_string(getpid()) + "-0.part";
  for (const std::string& name : {mine, std::string("a.txt.999999999-0.part"),
                                  std::string("notes.part"), std::string("b.999999999-1.parts")}) {
    spit(folder / name, "x");
  }
  remove_left_parts(folder.path().string());
  EXPECT_TRUE(std::filesystem::exists(folder / mine));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.999999999-0.part"));
  EXPECT_TRUE(std::filesystem::exists(folder / "notes.part"));
  EXPECT_TRUE(std::filesystem::exists(folder / "b.999999999-1.parts"));
}

}  // namespace
}  // namespace headpin::files
