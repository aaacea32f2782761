#pragma once

#include <stdexcept>

/// Errors that have a class of their own in Python. Of the others, std::invalid_argument becomes
/// ValueError, std::bad_alloc MemoryError, and the rest RuntimeError.
namespace headpin::python {

/// FileNotFoundError
struct FileMissing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// PermissionError
struct NotPermitted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// FileExistsError
struct FileIsThere : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// OSError
struct NotWritten : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// headpin.DamagedTrial
struct DamagedTrial : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace headpin::python
