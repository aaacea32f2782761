// Links, devices and pipes where an output shall go: followed, written into, or refused.

#include <array>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/output_file.h"
#include "tests/base/failing_calls.h"
#include "tests/base/output_file_fixture.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(OutputFileTest, LinksAreFollowedNotReplaced) {
  fs::create_directory(folder_ / "far");
  spit(folder_ / "far/a", "old");
  fs::create_symlink("far/a", folder_ / "link");
  fs::create_symlink("far/b", folder_ / "dangling");
  fs::create_symlink("round", folder_ / "round");
  EXPECT_EQ(refused(folder_ / "link", force_), "");
  EXPECT_EQ(refused(folder_ / "dangling"), "");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "dangling"));
  EXPECT_EQ(slurp(folder_ / "far/a"), "new");
  EXPECT_EQ(slurp(folder_ / "far/b"), "new");
  EXPECT_THAT(refused(folder_ / "round"), HasSubstr("links in a circle"));
}

TEST_F(OutputFileTest, DevicesAndPipesAreWrittenIntoNeverReplaced) {
  EXPECT_EQ(refused("/dev/null", force_), "");
  EXPECT_THAT(refused("/dev/full", force_), HasSubstr("/dev/full: cannot be written: No space"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_THAT(refused("/dev/null", {.overwrite = true, .regular = true}),
              HasSubstr("no regular file"));

  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = slurp(pipe); });
  EXPECT_EQ(refused(pipe, force_), "");
  reader.join();
  EXPECT_EQ(read, "new");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFileTest, ALinkPlantedByAnotherUserInAnOpenFolderIsNotFollowed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a link to another user";
  const fs::path open = folder_ / "open", target = folder_ / "target";
  fs::create_directory(open);
  ASSERT_EQ(chmod(open.c_str(), 01777), 0);
  for (const bool there : {false, true}) {
    if (there) spit(target, "precious");
    fs::create_symlink(target, open / "link");
    constexpr uid_t kAnother = 12345;
    ASSERT_EQ(lchown((open / "link").c_str(), kAnother, kAnother), 0);
    EXPECT_THAT(refused(open / "link", force_),
                testing::AnyOf(HasSubstr("is a link of another user"),
                               HasSubstr("cannot be reached: Permission denied")));
    EXPECT_EQ(slurp(target), there ? "precious" : "");
    fs::remove(open / "link");
  }
}

// As the kernel has it (protected_symlinks): what one can remove there anyway, and what the
// folder's own user put there.
TEST_F(OutputFileTest, ALinkOfAnotherUserIsFollowedWhereThatPlantsNothing) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a link to another user";
  constexpr uid_t kAnother = 12345;
  const fs::path open = folder_ / "open";
  for (const auto& [mode, owner] :
       {std::pair<mode_t, uid_t>{0777, 0}, {01755, 0}, {01777, kAnother}}) {
    fs::create_directory(open);
    fs::create_symlink(folder_ / "target", open / "link");
    ASSERT_EQ(lchown((open / "link").c_str(), kAnother, kAnother), 0);
    ASSERT_EQ(chown(open.c_str(), owner, owner), 0);
    ASSERT_EQ(chmod(open.c_str(), mode), 0);
    EXPECT_EQ(refused(open / "link", force_), "") << std::oct << mode;
    EXPECT_EQ(slurp(folder_ / "target"), "new");
    fs::remove_all(open);
    fs::remove(folder_ / "target");
  }
}

TEST_F(OutputFileTest, APipePlantedByAnotherUserInAnOpenFolderIsNotWrittenInto) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a pipe to another user";
  const fs::path open = folder_ / "open", pipe = open / "pipe";
  fs::create_directory(open);
  ASSERT_EQ(chmod(open.c_str(), 01777), 0);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0666), 0);
  ASSERT_EQ(chown(pipe.c_str(), 12345, 12345), 0);
  EXPECT_THAT(refused(pipe, force_), HasSubstr("is a pipe or device of another user"));
}

TEST_F(OutputFileTest, ALinkThatTakesThePlaceOfAPipeMeanwhileIsNotFollowed) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  spit(folder_ / "precious", "precious");
  do_before_call("open", 0, [&] {
    fs::remove(folder_ / "pipe");
    fs::create_symlink("precious", folder_ / "pipe");
  });
  EXPECT_THAT(refused(folder_ / "pipe", force_), HasSubstr("pipe: cannot write"));
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "precious"), "precious");
}

TEST_F(OutputFileTest, ALinkThatComesToStandThereMeanwhileIsNotFollowed) {
  write(folder_ / "a", "old", {});
  spit(folder_ / "precious", "precious");
  do_before_call("openat", 0, [&] {
    fs::remove(folder_ / "a");
    fs::create_symlink("precious", folder_ / "a");
  });
  EXPECT_THAT(refused(folder_ / "a", force_), HasSubstr("cannot be replaced"));
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "precious"), "precious");
}

TEST_F(OutputFileTest, AsManyLinksAreFollowedAsLinuxFollows) {
  fs::path last = "target";
  for (int i = 1; i <= 41; ++i) {
    const std::string link = "link" + std::to_string(i);
    fs::create_symlink(last, folder_ / link);
    last = link;
  }
  EXPECT_EQ(refused(folder_ / "link40"), "");
  EXPECT_EQ(slurp(folder_ / "target"), "new");
  EXPECT_THAT(refused(folder_ / "link41", force_), HasSubstr("links in a circle"));
}

TEST_F(OutputFileTest, APipeWithoutANameIsWrittenInto) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
  EXPECT_EQ(refused("/proc/self/fd/" + std::to_string(ends[1]), force_), "");
  std::array<char, 8> bytes{};
  EXPECT_EQ(read(ends[0], bytes.data(), bytes.size()), 3);
  EXPECT_STREQ(bytes.data(), "new");
  for (const int end : ends) close(end);
}

}  // namespace
}  // namespace headpin::base
