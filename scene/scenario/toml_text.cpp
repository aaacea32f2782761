#include "scene/scenario/toml_text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace headpin::scene {

namespace {

/// Skips a string that begins at `at`, with its quotes.
/// @return  its end; an unfinished string ends with its line, or with the text if it may have
///   several lines
std::size_t after_string(std::string_view toml, std::size_t at) {
  const char quote = toml[at];
  const std::string three(3, quote);
  const bool many_lines = toml.substr(at, 3) == three;
  for (at += many_lines ? 3 : 1; at < toml.size(); ++at) {
    if (quote == '"' && toml[at] == '\\') {
      ++at;
    } else if (many_lines ? toml.substr(at, 3) == three : toml[at] == quote) {
      return at + (many_lines ? 3 : 1);
    } else if (!many_lines && toml[at] == '\n') {
      return at;
    }
  }
  return toml.size();
}

}  // namespace

std::string on_one_line(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '\n') {
      all += "\\n";
    } else if (c == '\t') {
      all += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      all += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      all += c;
    }
  }
  return all;
}

std::string brief(std::string_view text, std::size_t most) {
  if (text.size() <= most) return on_one_line(text);
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;  // UTF-8
  return on_one_line(text.substr(0, most)) + "...";
}

std::string read_scenario_file(const std::string& path) {
  constexpr std::size_t kMost = 16'000'000;
  // A pipe is read if another process writes to it; otherwise this does not wait.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  std::string text;
  std::array<char, 65536> bytes{};
  ssize_t n = -1;
  while (file >= 0 && text.size() <= kMost) {
    n = read(file, bytes.data(), bytes.size());
    pollfd ready{file, POLLIN, 0};
    if (n < 0 && errno == EAGAIN && poll(&ready, 1, -1) >= 0) continue;
    if (n <= 0) break;
    text.append(bytes.data(), static_cast<std::size_t>(n));
  }
  struct stat is {};
  const bool nobody = n == 0 && text.empty() && fstat(file, &is) == 0 && S_ISFIFO(is.st_mode);
  const int error = errno;
  if (file >= 0) close(file);
  if (n < 0) throw std::runtime_error(path + ": cannot be read: " + std::strerror(error));
  if (nobody) throw std::runtime_error(path + ": a pipe that nobody writes to");
  if (n > 0) {
    throw std::runtime_error(
        fmt::format("{}: too long for a scenario, expected {} bytes at most", path, kMost));
  }
  return text;
}

void require_shallow(std::string_view toml, std::string_view where) {
  constexpr int kDeepest = 16;  // four are needed
  int brackets = 0, dots = 0;
  for (std::size_t at = 0; at < toml.size(); ++at) {
    const char c = toml[at];
    if (c == '#') {
      at = std::min(toml.find('\n', at), toml.size());
      dots = 0;
    } else if (c == '"' || c == '\'') {
      at = after_string(toml, at) - 1;
    } else if (c == '.') {
      ++dots;
    } else if (c == '[' || c == '{') {
      ++brackets;
      dots = 0;
    } else if (c == ']' || c == '}') {
      brackets = std::max(0, brackets - 1);
    } else if (c == '=' || c == ',' || c == '\n') {
      dots = 0;  // dots of one key or number have none of these in between
    }
    if (brackets > kDeepest || dots > kDeepest) {
      const auto line = 1 + std::count(toml.begin(), toml.begin() + static_cast<long>(at), '\n');
      throw std::invalid_argument(
          fmt::format("{}:{}: nested more than {} deep", where, line, kDeepest));
    }
  }
}

}  // namespace headpin::scene
