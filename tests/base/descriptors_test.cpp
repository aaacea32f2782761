// Open files: each is closed by whom it belongs to, handed on to no program that we begin, and may
// have any number.

#include <cstring>
#include <filesystem>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/input_file.h"
#include "base/leftovers.h"
#include "base/line_file.h"
#include "base/names.h"
#include "base/output_file.h"
#include "base/output_folder.h"
#include "base/output_text.h"
#include "base/shell_word.h"
#include "base/temporary.h"
#include "base/work_folder.h"
#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;

std::ptrdiff_t open_files() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

/// Looks after all tests of this program.
class NothingIsLeftOpen : public testing::Environment {
 public:
  void SetUp() override { before_ = open_files(); }
  void TearDown() override {
    EXPECT_EQ(open_files(), before_);
    EXPECT_THAT(opened_for_others(), testing::IsEmpty());
  }

 private:
  std::ptrdiff_t before_ = 0;
};

[[maybe_unused]] testing::Environment* const looked_after =
    testing::AddGlobalTestEnvironment(new NothingIsLeftOpen);

/// Does `work` again and again; each of the files that it opens has the number 0 once, as where
/// standard input is closed.
void with_number_0(const std::function<void()>& work) {
  const int in = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  ASSERT_GE(in, 0);
  for (const char* call : {"open", "openat"}) {
    bool came = true;
    for (int number = 0; came; ++number) {
      came = false;
      do_before_call(call, number, [&] {
        close(STDIN_FILENO);
        came = true;
      });
      work();
      let_all_succeed();
      if (came) {
        EXPECT_EQ(fcntl(STDIN_FILENO, F_GETFD), -1) << call << " " << number << ": still open";
      }
      dup2(in, STDIN_FILENO);
    }
  }
  close(in);
}

TEST(Descriptors, OfAnOutputMayBeNought) {
  with_number_0([] {
    const TemporaryFolder folder;
    for (const bool live : {false, true}) {
      const auto write = [&](bool commit) {
        OutputFile file(folder / "a", {.overwrite = true, .live = live});
        file.write("text", 4);
        if (commit) file.commit();
      };
      write(true);
      EXPECT_EQ(slurp(folder / "a"), "text");
      write(false);
      EXPECT_EQ(slurp(folder / "a"), "text");
      EXPECT_EQ(complaint([&] { OutputFile(folder / "a", {}); }).find("a: exists already") ==
                    std::string::npos,
                false);
    }
    OutputFile special("/dev/null", {});
    special.write("text", 4);
    special.commit();
    EXPECT_THAT(complaint([&] { OutputFile(folder / "none/a", {}); }),
                testing::HasSubstr("cannot be created"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  });
}

TEST(Descriptors, OfAFolderMayBeNought) {
  with_number_0([] {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    for (int i = 0; i < 2; ++i) {
      OutputFolder results(out, {.overwrite = true, .others = {}});
      OutputText text(results.file("index"));
      text << i;
      text.close();
      results.commit("index");
      EXPECT_EQ(slurp(out + "/index"), std::to_string(i));
    }
    { OutputFolder dropped((folder / "dropped").string(), {}); }
    EXPECT_FALSE(fs::exists(folder / "dropped"));
    {
      WorkFolder work(folder / "work");
      spit(work.file("a"), "ours");
      OutputFolder inner(work.folder("inner").string(), {});
      spit(inner.file("index"), "ours");
      inner.commit("index");
      work.clear();
      EXPECT_FALSE(fs::exists(folder / "work/inner"));
      EXPECT_FALSE(fs::exists(folder / "work/a"));
      spit(work.file("b"), "ours");
    }
    EXPECT_FALSE(fs::exists(folder / "work"));
  });
}

TEST(Descriptors, OfWhatIsReadMayBeNought) {
  with_number_0([] {
    const TemporaryFolder folder;
    spit(folder / "a", "text");
    EXPECT_EQ(read_text(folder / "a", 4), "text");
    EXPECT_NE(complaint([&] { InputFile file(folder.path()); }), "");
    {
      LineFile lines((folder / "lines").string());
      lines.append("one\n");
    }
    EXPECT_EQ(LineFile((folder / "lines").string()).text(), "one\n");
    const int nameless = nameless_file();
    EXPECT_GE(nameless, 0);
    close(nameless);
  });
}

// Each finished file kept its folder open: a server that records games had no descriptors at last.
TEST(Descriptors, OfFinishedFilesAreClosedThoughTheFilesLiveOn) {
  const TemporaryFolder folder;
  const std::ptrdiff_t before = open_files();
  std::vector<OutputFile> finished;
  for (const bool live : {false, true}) {
    finished.emplace_back((folder / (live ? "live" : "whole")).string(),
                          OutputFile::Options{.live = live});
    finished.back().write("text", 4);
    EXPECT_GT(open_files(), before);
    finished.back().commit();
    EXPECT_EQ(open_files(), before);
  }
}

TEST(AProcess, IsGoneWhenItHasEndedThoughNobodyAskedForItsEnd) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {  // until its input ends
    close(ends[1]);
    char byte = 0;
    _exit(read(ends[0], &byte, 1) == 0 ? 0 : 1);
  }
  EXPECT_FALSE(is_gone(getpid()));
  EXPECT_FALSE(is_gone(child));
  close(ends[1]);
  close(ends[0]);
  siginfo_t ended{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(is_gone(child));
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(is_gone(child));
}

TEST(AWordForAShell, HasQuotesWhereItNeedsThem) {
  EXPECT_EQ(typed_word("study/a-1"), "study/a-1");
  EXPECT_EQ(typed_word("my study"), "'my study'");
  EXPECT_EQ(typed_word("it's"), "'it'\\''s'");
  EXPECT_EQ(typed_word("-study"), "./-study");
  EXPECT_EQ(typed_word(""), "''");
}

TEST(Descriptors, OfLeftoversMayBeNought) {
  with_number_0([] {
    const TemporaryFolder folder;
    spit(folder / "a.999999999-0.part", "left");  // beyond all numbers of processes
    const int at = open(folder.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    EXPECT_EQ(remove_leftovers(at, "a").size(), 1u);
    EXPECT_TRUE(fs::is_empty(folder.path()));
    close(at);
    EXPECT_TRUE(remove_leftovers(-1, "a").empty());
  });
}

}  // namespace
}  // namespace headpin::base
