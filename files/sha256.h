#pragma once

#include <string>
#include <string_view>

namespace headpin::files {

/// What `sha256sum` prints of these bytes: 64 hexadecimal digits (FIPS 180-4).
std::string sha256(std::string_view bytes);

}  // namespace headpin::files
