#include "devices/recordings/text_encoding.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include <iconv.h>

#include "base/input_file.h"

namespace headpin::devices {

Utf8Text as_utf8(std::string text) {
  const bool little = text.starts_with("\xff\xfe"), big = text.starts_with("\xfe\xff");
  if (!little && !big) {
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    return {std::move(text), true};
  }
  const iconv_t converter = iconv_open("UTF-8", little ? "UTF-16LE" : "UTF-16BE");
  if (converter == reinterpret_cast<iconv_t>(-1)) {
    throw std::runtime_error("UTF-16 cannot be converted on this system");
  }
  Utf8Text out;
  char* from = text.data() + 2;  // behind the mark
  std::size_t left = text.size() - 2;
  std::array<char, 1 << 16> piece{};
  while (left > 0) {
    char* to = piece.data();
    std::size_t room = piece.size();
    const bool good = iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1);
    const bool full = !good && errno == E2BIG;
    out.text.append(piece.data(), piece.size() - room);
    if (good || full) continue;
    out.whole = false;
    break;
  }
  iconv_close(converter);
  return out;
}

std::string beginning(const std::string& text, std::size_t most) {
  constexpr std::size_t kLongestLetter = 4;
  const auto goes_on = [&](std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0U) == 0x80U;
  };
  std::size_t end = most;
  while (end > 0 && most - end < kLongestLetter && goes_on(end)) --end;
  return text.substr(0, end);
}

std::string read_as_utf8(const std::string& path, std::size_t most) {
  Utf8Text read = as_utf8(base::read_text(path, most));
  if (!read.whole) {
    const auto line = 1 + std::count(read.text.begin(), read.text.end(), '\n');
    throw std::runtime_error(path + ":" + std::to_string(line) +
                             ": expected whole characters of UTF-16, found others");
  }
  return std::move(read.text);
}

}  // namespace headpin::devices
