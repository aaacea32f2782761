// What is in an output folder when the disk fails, is full, or ends the program in the middle.

#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/lock.h"
#include "base/output_folder.h"
#include "base/output_text.h"
#include "tests/base/failing_calls.h"
#include "tests/base/output_folder_fixture.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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

TEST_F(OutputFolderTest, OfFoldersThatCannotAllBeMadeNoneIsLeft) {
  for (const int number : {0, 1, 2}) {
    fail_call("mkdir", number, EACCES);
    EXPECT_THAT(refused(folder_ / "deep/er/down"),
                HasSubstr("deep/er/down: cannot be made: Permission denied"));
    let_all_succeed();
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
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

}  // namespace
}  // namespace headpin::base
