#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "apps/python/errors.h"

namespace headpin::python {

/// What `read()` gives. Where it fails, the error is the one that Python has for the file.
/// @throws FileMissing, NotPermitted; Otherwise for a file that can be read but is none
template <typename Otherwise, typename Read>
auto reading(const std::string& path, const Read& read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) throw FileMissing(error.what());
    if (access(path.c_str(), R_OK) != 0) throw NotPermitted(error.what());
    throw Otherwise(error.what());
  }
}

}  // namespace headpin::python
