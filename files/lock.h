#pragma once

#include <stdexcept>

/// Files that come out whole or not at all, and what must not be used by two at once.
///
/// The one place that knows how to treat what the user already has. It stands in the bottom row,
/// because devices, render and the commands all write files.
namespace headpin::files {

/// Somebody else is using it now; it may be free later.
struct Busy : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Takes the file behind `descriptor` for this process until it is closed, even by a crash.
///
/// Only those who ask by this function see it.
/// @return  false when another one has it
bool lock(int descriptor);

}  // namespace headpin::files
