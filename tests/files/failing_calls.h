#pragma once

/// Calls of the system that fail, or end the process, where a test says so.
///
/// The functions of the C library that change files are this program's own (failing_calls.cpp) and
/// pass on to the kernel.
namespace headpin::files {

/// Of the calls from now on the one with this number (0: the first) fails with `error`.
void fail_call(const char* name, int number, int error);
/// The process ends in place of the call with this number, whatever it is.
void end_at_call(int number);
/// How many calls there were since the last of these.
int calls();
/// All succeed again.
void let_all_succeed();

}  // namespace headpin::files
