#include "devices/lines/command_pipe.h"

#include <filesystem>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/lines/byte_stream.h"
#include "tests/devices/line_ends.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

/// Another program that writes to the pipe.
void write_to(const fs::path& pipe, const std::string& text) {
  const int fd = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK);
  ASSERT_GE(fd, 0);
  EXPECT_EQ(::write(fd, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  ::close(fd);
}

TEST(CommandPipeTest, GivesWholeLinesAlsoOfOneWriterAfterTheOther) {
  const fs::path path = fresh_folder("pipe") / "control";
  CommandPipe pipe(path.string());
  EXPECT_THAT(pipe.lines(), IsEmpty());
  write_to(path, "press\nrele");
  EXPECT_THAT(pipe.lines(), ElementsAre("press"));
  write_to(path, "ase\n\nquit\n");
  EXPECT_THAT(pipe.lines(), ElementsAre("release", "", "quit"));
  EXPECT_THAT(pipe.lines(), IsEmpty());
  EXPECT_EQ(pipe.ignored(), 0);
}

TEST(CommandPipeTest, IgnoresWhatIsLongerThanALine) {
  const fs::path path = fresh_folder("pipe") / "control";
  CommandPipe pipe(path.string());
  write_to(path, std::string(CommandPipe::kLongest, 'x') + "\n");
  EXPECT_THAT(pipe.lines(), ElementsAre(std::string(CommandPipe::kLongest, 'x')));
  EXPECT_EQ(pipe.ignored(), 0);
  write_to(path, std::string(CommandPipe::kLongest + 1, 'x') + "\npress\n");
  EXPECT_THAT(pipe.lines(), ElementsAre("press"));
  EXPECT_EQ(pipe.ignored(), 1);
  write_to(path, std::string(CommandPipe::kLongest + 1, 'x'));
  EXPECT_THAT(pipe.lines(), IsEmpty());
  write_to(path, "quit");  // still that line
  EXPECT_THAT(pipe.lines(), IsEmpty());
  write_to(path, "\npress\n");
  EXPECT_THAT(pipe.lines(), ElementsAre("press"));
  EXPECT_EQ(pipe.ignored(), 2);
}

TEST(CommandPipeTest, RemovesThePipeThatItMadeAndNoOther) {
  const fs::path folder = fresh_folder("pipe"), made = folder / "made", there = folder / "there";
  ASSERT_EQ(mkfifo(there.c_str(), 0600), 0);
  {
    const CommandPipe new_one(made.string()), old_one(there.string());
    EXPECT_TRUE(fs::is_fifo(made));
    EXPECT_GE(old_one.descriptor(), 0);
  }
  EXPECT_FALSE(fs::exists(made));
  EXPECT_TRUE(fs::is_fifo(there));
}

TEST(CommandPipeTest, RefusesAFileThatIsNoPipeAndLeavesIt) {
  const fs::path path = fresh_folder("pipe") / "text";
  spit(path, "a text");
  EXPECT_EQ(complaint([&] { CommandPipe pipe(path.string()); }),
            path.string() + ": exists and is not a named pipe");
  EXPECT_EQ(slurp(path), "a text");
}

TEST(CommandPipeTest, TheLastLineOfStandardInputNeedsNoEnd) {
  const int before = dup(STDIN_FILENO);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  dup2(ends[0], STDIN_FILENO);
  ASSERT_EQ(::write(ends[1], "press\nquit", 10), 10);
  ::close(ends[1]);
  const int flags = fcntl(STDIN_FILENO, F_GETFL);
  {
    CommandPipe pipe("-");
    EXPECT_EQ(fcntl(STDIN_FILENO, F_GETFL), flags) << "others read it too";
    EXPECT_THAT(pipe.lines(), ElementsAre("press"));
    EXPECT_THAT(pipe.lines(), ElementsAre("quit"));
    EXPECT_THAT(pipe.lines(), IsEmpty());
  }
  dup2(before, STDIN_FILENO);
  ::close(before);
  ::close(ends[0]);
}

TEST(CommandPipeTest, WithoutAPathNoLineComes) {
  CommandPipe pipe("");
  EXPECT_EQ(pipe.descriptor(), -1);
  EXPECT_THAT(pipe.lines(), IsEmpty());
}

// Others read the terminal too; one that is set up for a program that asks again and again gives 0 bytes.
TEST(CommandPipeTest, ASilentTerminalIsNotTheEndOfStandardInput) {
  PseudoTerminal terminal;
  const int keyboard = ::open(terminal.name().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  const OtherInput input(keyboard);
  {
    CommandPipe pipe("-");
    EXPECT_THAT(pipe.lines(), IsEmpty());
    say(terminal, "press\n");
    ASSERT_TRUE(has_news(keyboard));
    EXPECT_THAT(pipe.lines(), ElementsAre("press"));
  }
  EXPECT_TRUE(has_input()) << "it is not the pipe's to close";
  ::close(keyboard);
}

TEST(CommandPipeTest, WorksInAProgramWithoutStandardInput) {
  const fs::path folder = fresh_folder("pipe"), path = folder / "control", file = folder / "file";
  spit(file, "a text");
  const OtherInput none;
  EXPECT_THROW(CommandPipe refused(file.string()), std::runtime_error);
  EXPECT_FALSE(has_input());
  {
    CommandPipe pipe(path.string());
    EXPECT_EQ(pipe.descriptor(), STDIN_FILENO);
    write_to(path, "press\n");
    EXPECT_EQ(pipe.lines().size(), 1u);
  }
  EXPECT_FALSE(has_input());
}

TEST(CommandPipeTest, NeitherWaitsNorGoesToOtherPrograms) {
  const CommandPipe pipe((fresh_folder("pipe") / "control").string());
  EXPECT_FALSE(waits(pipe.descriptor()));
  EXPECT_FALSE(is_inherited(pipe.descriptor()));
}

}  // namespace
}  // namespace headpin::devices
