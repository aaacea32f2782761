#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Calls of the system that fail, end the process or are noted where a test says so.
///
/// The functions of the C library that change files are this program's own (failing_calls.cpp) and
/// pass on to the kernel.
namespace headpin::base {

/// Of the calls from now on the one with this number (0: the first) fails with `error`.
void fail_call(const char* name, int number, int error);
/// That one fails and all after it.
void fail_calls_from(const char* name, int number, int error);
/// The process ends in place of the call with this number, whatever it is.
void end_at_call(int number);
/// Ahead of the call with this number `work` is done, once.
void do_before_call(const char* name, int number, std::function<void()> work);
/// Beside that: write() and pwrite() take no more than that at once.
void write_at_most(std::size_t bytes);
/// The same of what read() and pread() give.
void read_at_most(std::size_t bytes);
/// Whether the call that shall fail was made.
bool has_failed();
/// How many calls there were since the last of these.
int calls();
/// Names that were opened in a way that programs begun by this one would have them open too.
const std::vector<std::string>& opened_for_others();
/// All succeed again.
void let_all_succeed();

/// What a call has changed.
struct Change {
  enum Kind { kCreate, kMakeFolder, kWrite, kCut, kRename, kRemove, kSync, kSyncAll };
  Kind kind;
  std::string path;    ///< absolute
  std::string other;   ///< kRename: the new name; kWrite: the bytes
  std::size_t at = 0;  ///< kWrite: where; kCut: the new size
};

/// All that `work` changes on the disk, in order.
std::vector<Change> changes_of(const std::function<void()>& work);

}  // namespace headpin::base
