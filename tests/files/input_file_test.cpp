#include "files/input_file.h"

#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/files/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::files {
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

TEST(InputFileTest, ANamedPipeIsNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(complaint([&] { InputFile file(folder / "pipe"); }),
              HasSubstr("expected a file, found something else"));
}

}  // namespace
}  // namespace headpin::files
