#pragma once

#include <string>
#include <string_view>

namespace headpin::base {

/// The SHA-256 of these bytes as 64 hexadecimal digits (FIPS 180-4), as `sha256sum` prints it. It
/// stays our own code: no dependency has it, and it is not hot: it hashes mesh files and trials
/// once.
std::string sha256(std::string_view bytes);

}  // namespace headpin::base
