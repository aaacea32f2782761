#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// The encoding of recorded texts.
namespace headpin::devices {

/// A text in UTF-8. UTF-16 with a byte order mark, such as the "Unicode Text" of a spreadsheet, is
/// converted up to the first damaged place; another text is returned
/// as it is, without a byte order mark.
struct Utf8Text {
  std::string text;
  bool whole = true;  ///< nothing was damaged
};
Utf8Text as_utf8(std::string text);

/// The beginning of a text in UTF-8, of at most `most` bytes, without a part of a letter at its end.
std::string beginning(const std::string& text, std::size_t most);

/// The text of a file in UTF-8.
/// @throws std::runtime_error  when it cannot be read or has more than `most` bytes; for UTF-16 that
///                             is damaged
std::string read_as_utf8(const std::string& path, std::size_t most);

}  // namespace headpin::devices
