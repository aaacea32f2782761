#pragma once

#include <stdexcept>

/// Outputs that are complete or do not exist, and locks against simultaneous use.
///
/// Only this folder handles files that the user already has. It is in the lowest layer, because
/// devices, render and the commands all write files.
namespace headpin::base {

/// Another process is using a file now; it may be free later.
struct Busy : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An output is there already, and it is not to be overwritten.
struct Exists : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Locks the file behind `descriptor` for this process until it is closed or the process ends.
///
/// Only callers of this function notice the lock.
/// @return  false when another process has locked it; true too on a file system without locks
bool lock(int descriptor);

/// The same, but false where there are no locks: then nobody can tell whether another process uses the file.
bool lock_for_sure(int descriptor);

}  // namespace headpin::base
