#include "base/output_file.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/left_parts.h"
#include "base/lock.h"
#include "tests/base/failing_calls.h"
#include "tests/base/output_file_fixture.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(OutputFileTest, AppearsWhenItIsWhole) {
  {
    OutputFile file(folder_ / "a", {});
    file.write("x", 1);
    EXPECT_FALSE(fs::exists(folder_ / "a"));
    EXPECT_EQ(entries(), 1u);
  }
  EXPECT_EQ(entries(), 0u) << "dropped without commit()";
  write(folder_ / "a", "whole", {});
  EXPECT_EQ(slurp(folder_ / "a"), "whole");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFileTest, BelongsToWhoeverItIsHandedTo) {
  {
    OutputFile opened(folder_ / "a", {.overwrite = true});
    opened.write("by one, ", 8);
    OutputFile taken = std::move(opened);
    EXPECT_EQ(taken.path(), folder_ / "a");
    taken.write("and the other", 13);
    taken.commit();
  }
  EXPECT_EQ(slurp(folder_ / "a"), "by one, and the other");
  {
    OutputFile opened(folder_ / "b", {});
    const OutputFile taken = std::move(opened);
  }
  EXPECT_EQ(entries(), 1u) << "dropped without commit()";
}

TEST_F(OutputFileTest, APartOfAnotherIsNeverTaken) {
  const std::string part = "a." + std::to_string(getpid()) + "-0.part";
  spit(folder_ / part, "somebody's");
  spit(folder_ / "a.part", "somebody's");
  OutputFile one(folder_ / "a", {}), two(folder_ / "a", {});
  EXPECT_NE(one.part(), two.part());
  one.commit();
  EXPECT_THAT(complaint([&] { two.commit(); }), HasSubstr("was created in the meantime"));
  EXPECT_EQ(slurp(folder_ / part), "somebody's");
  EXPECT_EQ(slurp(folder_ / "a.part"), "somebody's");
  EXPECT_EQ(entries(), 3u);
}

// SIGKILL leaves no time to clear up; the next one for the same output does it.
TEST_F(OutputFileTest, WhatAKilledRunLeftIsRemovedByTheNextAndSaid) {
  OutputFile running(folder_ / "a", {});
  for (const char* name : {"a", "b"}) {
    const pid_t killed = fork();
    if (killed == 0) {
      OutputFile file(folder_ / name, {});
      file.write("half", 4);
      raise(SIGKILL);
    }
    ASSERT_EQ(waitpid(killed, nullptr, 0), killed);
  }
  // What is still written stays, and what only looks alike.
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  ASSERT_EQ(waitpid(gone, nullptr, 0), gone);
  const std::string process = std::to_string(gone);
  const std::string elsewhere = "a." + process + "-7.part";  // written on another machine
  spit(folder_ / elsewhere, "theirs");
  const int held = open((folder_ / elsewhere).c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_TRUE(lock(held));
  const std::vector<std::string> others = {"a.1-0.part",
                                           "a." + process + ".part",
                                           "a." + process + "-0.part.txt",
                                           "aa." + process + "-0.part",
                                           "a." + process + "x-0.part",
                                           "a." + process + "-0x.part",
                                           "a." + process + "-x.part",
                                           "a." + process + "--1.part",
                                           "a.-" + process + "-0.part",
                                           "a.0-0.part",
                                           "a.x-0.part",
                                           "a-" + process + "-0.part",
                                           "a.part"};
  for (const std::string& name : others) spit(folder_ / name, "precious");

  testing::internal::CaptureStderr();
  write(folder_ / "a", "whole", {});
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, testing::MatchesRegex("headpin: [^\n]*/a\\.[0-9]+-0\\.part: was left by a run "
                                          "that was killed; removed\n"));
  for (const std::string& name : others) EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_TRUE(fs::exists(folder_ / elsewhere));
  EXPECT_TRUE(fs::exists(running.part()));
  EXPECT_EQ(entries(), others.size() + 4) << "with a, and what is left of b";
  close(held);
}

// A name may hold what a terminal would obey.
TEST_F(OutputFileTest, WhatIsRemovedIsSaidInLettersThatCanBeSeen) {
  const std::string name = "a b\x1f\x7f";
  spit(folder_ / (name + ".999999999-0.part"), "left");
  testing::internal::CaptureStderr();
  write(folder_ / name, "whole", {});
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("/a b??.999999999-0.part: was left"));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFileTest, WhatAnotherUserOrAFolderHasASuchlikeNameForStays) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file to another user";
  spit(folder_ / "a.999999999-0.part", "theirs");
  ASSERT_EQ(chown((folder_ / "a.999999999-0.part").c_str(), 12345, 12345), 0);
  fs::create_directory(folder_ / "a.999999999-1.part");
  fs::create_symlink("a.999999999-0.part", folder_ / "a.999999999-2.part");
  spit(folder_ / "mine", "precious");
  fs::create_symlink("mine", folder_ / "a.999999999-3.part");
  ASSERT_EQ(mkfifo((folder_ / "a.999999999-4.part").c_str(), 0600), 0);  // is not waited for
  write(folder_ / "a", "whole", {});
  EXPECT_EQ(entries(), 7u);
}

TEST_F(OutputFileTest, WhatIsThereStaysUnlessForced) {
  spit(folder_ / "a", "precious");
  EXPECT_THAT(refused(folder_ / "a"), HasSubstr("a: exists already"));
  EXPECT_EQ(slurp(folder_ / "a"), "precious");
  fs::permissions(folder_ / "a", fs::perms(0640));
  EXPECT_EQ(refused(folder_ / "a", force_), "");
  EXPECT_EQ(slurp(folder_ / "a"), "new");
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::perms(0640));
}

TEST_F(OutputFileTest, AnInputIsNeverTheOutputUnderWhateverName) {
  spit(folder_ / "in", "precious");
  fs::create_symlink("in", folder_ / "link");
  fs::create_hard_link(folder_ / "in", folder_ / "twin");
  for (const char* name : {"in", "link", "twin", "./in"}) {
    EXPECT_THAT(refused(folder_ / name, {.overwrite = true, .inputs = {folder_ / "in"}}),
                HasSubstr("is an input of this command"));
  }
  EXPECT_EQ(slurp(folder_ / "in"), "precious");
}

TEST_F(OutputFileTest, NoNameAFolderAndAMissingFolderAreRefused) {
  EXPECT_THAT(refused(""), HasSubstr("expected a name"));
  EXPECT_THAT(refused("-"), HasSubstr("cannot go to standard output"));
  EXPECT_THAT(refused(folder_.path(), force_), HasSubstr("is a folder"));
  EXPECT_THAT(refused(folder_ / "none/a"),
              testing::EndsWith("none/a: cannot be created: there is no folder " +
                                (folder_ / "none").string()));
  EXPECT_THAT(refused(folder_ / "none/"), HasSubstr("cannot be created"));
  EXPECT_EQ(entries(), 0u);
}

TEST_F(OutputFileTest, ALongNameIsANameToo) {
  const std::string name(250, 'n');
  EXPECT_EQ(refused(folder_ / name), "");
  EXPECT_EQ(slurp(folder_ / name), "new");
}

TEST_F(OutputFileTest, ALiveOneIsThereFromTheStartAndNotForTwo) {
  OutputFile file(folder_ / "a", {.live = true});
  file.write("so far", 6);
  EXPECT_EQ(slurp(folder_ / "a"), "so far");
  EXPECT_THROW(OutputFile(folder_ / "a", {.overwrite = true, .live = true}), Busy);
  EXPECT_THROW(OutputFile(folder_ / "a", force_), Busy);
  EXPECT_EQ(slurp(folder_ / "a"), "so far");
  EXPECT_EQ(entries(), 1u);
  file.commit();
  EXPECT_EQ(refused(folder_ / "a", force_), "");
}

TEST_F(OutputFileTest, ALiveOneThatWillNotBeFoundSaysSo) {
  const auto lost = [&](const auto& meddle) {
    fs::remove_all(folder_ / "a");
    OutputFile file(folder_ / "a", {.live = true});
    file.write("so far", 6);
    EXPECT_NO_THROW(file.require_kept(6));
    meddle();
    const std::string now = complaint([&] { file.require_kept(6); });
    file.write(" more", 5);
    EXPECT_NE(complaint([&] { file.require_kept(11); }), "");
    return now;
  };
  EXPECT_THAT(lost([&] { fs::remove(folder_ / "a"); }), HasSubstr("was deleted while"));
  EXPECT_THAT(lost([&] { fs::rename(folder_ / "a", folder_ / "b"); }), HasSubstr("was moved"));
  EXPECT_THAT(lost([&] {
                spit(folder_ / "b", "another");
                fs::rename(folder_ / "b", folder_ / "a");
              }),
              HasSubstr("was replaced"));
  EXPECT_THAT(lost([&] { spit(folder_ / "a", "cut"); }), HasSubstr("was cut to 3 of 6 bytes"));

  fs::remove_all(folder_ / "a");
  OutputFile file(folder_ / "a", {.live = true});
  fs::remove(folder_ / "a");
  EXPECT_THAT(complaint([&] { file.commit(); }), HasSubstr("was deleted"));
}

TEST_F(OutputFileTest, OnStandardOutputWhatIsSaidGoesToStandardError) {
  const fs::path out = folder_ / "out", said = folder_ / "said";
  EXPECT_EXIT(
      {
        ASSERT_TRUE(std::freopen(out.c_str(), "w", stdout));
        ASSERT_TRUE(std::freopen(said.c_str(), "w", stderr));
        std::printf("before ");
        OutputFile file("-", {.standard_output = true});
        std::puts("a word");
        file.write("bytes", 5);
        file.commit();
        std::fflush(stdout);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "");
  EXPECT_EQ(slurp(out), "before bytes");
  EXPECT_EQ(slurp(said), "a word\n");
}

TEST_F(OutputFileTest, IsOnTheDiskBeforeItHasItsName) {
  write(folder_ / "a", "old", {});
  for (const char* call : {"fdatasync", "renameat"}) {
    fail_call(call, 0, EIO);
    EXPECT_THAT(refused(folder_ / "a", force_), HasSubstr("Input/output error")) << call;
    let_all_succeed();
    EXPECT_EQ(slurp(folder_ / "a"), "old") << call;
    EXPECT_EQ(entries(), 1u) << call;
  }
  fail_call("fsync", 0, EIO);  // of the folder, which has the new name
  EXPECT_THAT(refused(folder_ / "a", force_), HasSubstr("Input/output error"));
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "a"), "new");
}

TEST_F(OutputFileTest, ASignalIsNoFailureAndAFullDiskIsOne) {
  fail_call("write", 0, EINTR);
  write(folder_ / "a", "whole", {});
  fail_call("write", 0, ENOSPC);
  EXPECT_THAT(refused(folder_ / "b"),
              testing::EndsWith("b: cannot be written: No space left on device"));
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "a"), "whole");
  EXPECT_EQ(entries(), 1u);
}

// What cannot be synced, such as a pipe, is no failure.
TEST_F(OutputFileTest, SyncsWhatCanBeSynced) {
  OutputFile file(folder_ / "a", {.live = true});
  file.write("so far", 6);
  for (const int error : {EINVAL, EROFS}) {
    fail_call("fdatasync", 0, error);
    EXPECT_EQ(complaint([&] { file.sync(); }), "");
  }
  fail_call("fdatasync", 0, EIO);
  EXPECT_THAT(complaint([&] { file.sync(); }),
              HasSubstr("a: cannot be written: Input/output error"));
  let_all_succeed();
  EXPECT_TRUE(file.cut_back(2));
  EXPECT_EQ(slurp(folder_ / "a"), "so");
  fail_call("ftruncate", 0, EIO);
  EXPECT_FALSE(file.cut_back(1));
  let_all_succeed();
}

TEST_F(OutputFileTest, OnlyWhatIsDurableWaitsForTheDisk) {
  const auto syncs = [&](const std::string& name, OutputFile::Options options) {
    const auto all = changes_of([&] { write(folder_ / name, "x", options); });
    return std::ranges::count(all, Change::kSync, &Change::kind);
  };
  EXPECT_EQ(syncs("a", {.durable = false}), 0);
  EXPECT_EQ(syncs("b", {}), 2);              // its bytes and its name
  EXPECT_EQ(syncs("c", {.live = true}), 3);  // its name from the start
}

TEST_F(OutputFileTest, WhatIsTakenInPiecesIsThereOnce) {
  write_at_most(3);
  write(folder_ / "a", "eight by", {});
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "a"), "eight by");
}

TEST_F(OutputFileTest, ThroughAFileThereIsNoWay) {
  spit(folder_ / "file", "precious");
  EXPECT_THAT(refused(folder_ / "file/a"), HasSubstr("file/a: cannot be reached: Not a directory"));
  EXPECT_EQ(slurp(folder_ / "file"), "precious");
}

TEST_F(OutputFileTest, StandardOutputIsNoTerminalAndOpen) {
  EXPECT_EXIT(
      {
        const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
        grantpt(terminal);
        unlockpt(terminal);
        dup2(::open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC), STDOUT_FILENO);
        std::fputs(complaint([] { OutputFile("-", {.standard_output = true}); }).c_str(), stderr);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "-: standard output is a terminal; expected a pipe or a file");
  EXPECT_EXIT(
      {
        close(STDOUT_FILENO);
        std::fputs(complaint([] { OutputFile("-", {.standard_output = true}); }).c_str(), stderr);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "-: standard output: Bad file descriptor");
}

TEST_F(OutputFileTest, ALiveOneThatGetsNoNameLeavesNothing) {
  fail_call("renameat2", 0, EIO);
  EXPECT_THAT(complaint([&] { OutputFile(folder_ / "a", {.live = true}); }),
              HasSubstr("a: cannot be given its name: Input/output error"));
  let_all_succeed();
  EXPECT_EQ(entries(), 0u);
}

// EINVAL: of a file system whose folders cannot be synced.
TEST_F(OutputFileTest, AFolderThatCannotBeSyncedIsNoFailure) {
  fail_call("fsync", 0, EINVAL);
  EXPECT_EQ(refused(folder_ / "a"), "");
  let_all_succeed();
  EXPECT_EQ(slurp(folder_ / "a"), "new");
}

// It may be on a disk that other machines write to.
TEST_F(OutputFileTest, WhileItIsWrittenItsPartIsLocked) {
  OutputFile file(folder_ / "a", {});
  const int part = ::open(file.part().c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_FALSE(lock(part));
  close(part);
}

// kill() says of it that it is there and not ours.
TEST_F(OutputFileTest, ThePartOfAnotherUsersProcessStays) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  fs::permissions(folder_.path(), fs::perms(0777));
  write(folder_ / "of root", "whole", {});
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kAnother = 12345;
    // From within: what is above the folder may be closed to others.
    if (chdir(folder_.path().c_str()) != 0 || setuid(kAnother) != 0) std::_Exit(1);
    spit("a.1-0.part", "theirs");
    spit("b.1-0.part", "theirs");
    write("a", "whole", {});
    remove_left_parts(".");
    std::_Exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "a"));
  EXPECT_TRUE(fs::exists(folder_ / "a.1-0.part"));
  EXPECT_TRUE(fs::exists(folder_ / "b.1-0.part"));
}

// A process on another machine is not seen here, but its lock is.
TEST_F(OutputFileTest, WhatSomebodyElsewhereWritesIsNotLeft) {
  const fs::path part = folder_ / "a.999999999-0.part";
  spit(part, "of another machine");
  const int writer = open(part.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_TRUE(lock(writer));
  remove_left_parts(folder_.path().string());
  EXPECT_TRUE(fs::exists(part));
  close(writer);
  remove_left_parts(folder_.path().string());
  EXPECT_FALSE(fs::exists(part));
}

// Of a file system without locks nobody can say that no other machine writes there.
TEST_F(OutputFileTest, WhatCannotBeLockedIsNotLeft) {
  const fs::path part = folder_ / "a.999999999-0.part";
  spit(part, "of another machine?");
  fail_calls_from("flock", 0, ENOLCK);
  remove_left_parts(folder_.path().string());
  EXPECT_TRUE(has_failed());
  write(folder_ / "a", "whole", {});  // which needs no lock
  let_all_succeed();
  EXPECT_TRUE(fs::exists(part));
  EXPECT_EQ(slurp(folder_ / "a"), "whole");
}

// It has the permissions of the file that it was to replace.
TEST_F(OutputFileTest, APartThatMayOnlyBeReadIsRemoved) {
  fs::permissions(folder_.path(), fs::perms(0777));
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kAnother = 12345;
    if (chdir(folder_.path().c_str()) != 0) std::_Exit(1);
    if (geteuid() == 0 && setuid(kAnother) != 0) std::_Exit(1);  // root may write all
    for (const char* part : {"a.999999999-0.part", "b.999999999-0.part"}) {
      spit(part, "left");
      if (chmod(part, 0444) != 0) std::_Exit(1);
    }
    const int locked = open("b.999999999-0.part", O_RDONLY | O_CLOEXEC);
    if (!lock(locked)) std::_Exit(1);
    remove_left_parts(".");
    std::_Exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_FALSE(fs::exists(folder_ / "a.999999999-0.part"));
  EXPECT_TRUE(fs::exists(folder_ / "b.999999999-0.part"));
}

}  // namespace
}  // namespace headpin::base
