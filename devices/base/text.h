#pragma once

#include <string_view>

namespace headpin::devices {

/// A text without the spaces before and behind it.
inline std::string_view without_spaces(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

}  // namespace headpin::devices
