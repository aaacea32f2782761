#pragma once

#include <span>
#include <string_view>

namespace headpin::apps {

/// One key of what commands print with `--json`. A key has one meaning, whichever command prints it.
struct JsonKey {
  std::string_view key;
  std::string_view meaning;  ///< with its unit where the name does not say it
};

/// Every key, sorted by name.
std::span<const JsonKey> json_keys();

}  // namespace headpin::apps
