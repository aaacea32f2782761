#include "apps/wrap.h"

#include <algorithm>

#include <sys/ioctl.h>
#include <unistd.h>

namespace headpin::apps {
namespace {

/// Where CLI11 begins a description.
constexpr std::size_t kDescriptions = 30;
constexpr std::size_t kNarrowest = 50;

/// Where the rest of a line that is too long begins.
std::size_t indent_of(std::string_view line) {
  const bool described = line.size() > kDescriptions && line.starts_with("  ") &&
                         line[kDescriptions - 1] == ' ' && line[kDescriptions] != ' ';
  return described ? kDescriptions : std::min(line.find_first_not_of(' '), line.size());
}

bool is_command(std::string_view line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first != std::string_view::npos && first > 0 && line.substr(first).starts_with("headpin ");
}

/// Appends a line in pieces of `width` characters, each of which ends with a word.
void append_wrapped(std::string& out, std::string_view line, std::size_t width) {
  const std::size_t indent = indent_of(line);
  std::size_t begins = 0;  // how far the piece is indented already
  while (begins + line.size() > width) {
    const std::size_t least = begins == 0 ? indent + 1 : 1;  // a break before it gains nothing
    std::size_t end = line.rfind(' ', width - begins);
    if (end == std::string_view::npos || end < least) end = line.find(' ', least);
    if (end == std::string_view::npos) break;
    out.append(line.substr(0, end)).append("\n").append(indent, ' ');
    line.remove_prefix(std::min(line.find_first_not_of(' ', end), line.size()));
    begins = indent;
  }
  out += line;
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t width) {
  if (width == 0) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (is_command(line)) {
      out += line;
    } else {
      append_wrapped(out, line, width);
    }
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::size_t terminal_width() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col < kNarrowest ? 0 : size.ws_col;
}

std::string in_a_line(const std::string& toml) {
  constexpr std::size_t kMost = 40;
  std::string line;
  for (const char c : toml) {
    if (c != '\n') line += c;
  }
  if (line.size() > kMost) {
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0) == 0x80) --end;  // of a letter
    line = line.substr(0, end) + "...";
  }
  return line.empty() ? "-" : line;
}

}  // namespace headpin::apps
