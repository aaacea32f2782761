#include "base/input_file.h"

#include <array>
#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

using testing::HasSubstr;

TEST(InputFileTest, AReadThatFailsIsNoEnd) {
  const TemporaryFolder folder;
  spit(folder / "a", "text");
  fail_call("pread", 0, EIO);
  EXPECT_THAT(complaint([&] { read_text(folder / "a", 100); }),
              HasSubstr("a: cannot be read: Input/output error"));
  fail_call("pread", 0, EINTR);
  EXPECT_EQ(read_text(folder / "a", 100), "text");
  let_all_succeed();
  EXPECT_THAT(complaint([&] { read_text(folder / "a", 3); }), HasSubstr("expected 3 at most"));
}

TEST(InputFileTest, ReadsFromAnyPlaceWhatIsThere) {
  const TemporaryFolder folder;
  spit(folder / "a", "text");
  const InputFile file(folder / "a");
  EXPECT_EQ(file.size(), 4u);
  std::array<std::uint8_t, 3> bytes{};
  EXPECT_EQ(file.read(1, bytes), 3u);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "ext");
  EXPECT_EQ(file.read(3, bytes), 1u);
  EXPECT_EQ(bytes[0], 't');
  EXPECT_EQ(file.read(4, bytes), 0u);
  EXPECT_EQ(read_text(folder / "a", 4), "text");
  EXPECT_EQ(read_bytes(folder / "a", 4), (std::vector<std::uint8_t>{'t', 'e', 'x', 't'}));
}

TEST(InputFileTest, WhatComesInPiecesIsReadWhole) {
  const TemporaryFolder folder;
  spit(folder / "a", "twelve bytes");
  read_at_most(5);
  EXPECT_EQ(read_text(folder / "a", 12), "twelve bytes");
  std::array<std::uint8_t, 9> bytes{};
  EXPECT_EQ(InputFile(folder / "a").read(2, bytes), 9u);
  let_all_succeed();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "elve byte");
}

TEST(InputFileTest, TheEndAfterASignalIsTheEnd) {
  const TemporaryFolder folder;
  spit(folder / "a", "text");
  std::array<std::uint8_t, 3> bytes{};
  fail_call("pread", 0, EINTR);
  EXPECT_EQ(InputFile(folder / "a").read(3, bytes), 1u);
  let_all_succeed();
}

TEST(InputFileTest, AFileThatIsCutMeanwhileIsReadToItsEnd) {
  const TemporaryFolder folder;
  spit(folder / "a", "text");
  do_before_call("pread", 0, [&] { std::filesystem::resize_file(folder / "a", 2); });
  EXPECT_EQ(read_text(folder / "a", 4), "te");
  let_all_succeed();
}

TEST(InputFileTest, WhatIsMissingOrAFolderIsSaid) {
  const TemporaryFolder folder;
  EXPECT_THAT(complaint([&] { InputFile file(folder / "none"); }),
              HasSubstr("none: cannot open: No such file"));
  EXPECT_THAT(complaint([&] { InputFile file(folder.path()); }),
              HasSubstr("expected a file, found a folder"));
}

TEST(InputFileTest, OfAStreamTooAFailedReadIsNoEndAndASignalNoFailure) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  ASSERT_EQ(write(ends[1], "text", 4), 4);
  std::array<std::uint8_t, 8> bytes{};
  fail_call("read", 0, EIO);
  EXPECT_EQ(complaint([&] { read_some(ends[0], bytes, "it"); }),
            "it: cannot be read: Input/output error");
  fail_call("read", 0, EINTR);
  EXPECT_EQ(read_some(ends[0], bytes, "it"), 4u);
  let_all_succeed();
  EXPECT_EQ(bytes[3], 't');
  close(ends[1]);
  EXPECT_EQ(read_some(ends[0], bytes, "it"), 0u);
  close(ends[0]);
}

TEST(InputFileTest, ANamedPipeIsNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(complaint([&] { InputFile file(folder / "pipe"); }),
              HasSubstr("expected a file, found a named pipe"));
}

}  // namespace
}  // namespace headpin::base
