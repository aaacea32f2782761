#pragma once

#include <string>
#include <string_view>

namespace headpin::base {

/// A text in single quotes: one word for a shell, whatever is in it.
inline std::string shell_word(std::string_view text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The same for a command that people read: in quotes only where a shell needs them.
inline std::string typed_word(std::string_view text) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  const std::string before = text.starts_with('-') ? "./" : "";
  const bool plain = !text.empty() && text.find_first_not_of(kPlain) == std::string_view::npos;
  return before + (plain ? std::string(text) : shell_word(text));
}

}  // namespace headpin::base
