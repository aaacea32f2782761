#include "scene/scenario/toml_reading.h"

#include <cctype>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "scene/scenario/toml_text.h"
#include "scene/scenario/writer.h"

namespace headpin::scene {
namespace {

constexpr bool continues_a_character(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;  // UTF-8
}

/// @param number  from 1
std::string_view line_of_text(std::string_view text, std::size_t number) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the parser does not count it
  for (; number > 1 && text.find('\n') != std::string_view::npos; --number) {
    text.remove_prefix(text.find('\n') + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The byte of a line where a column begins: its size for a column behind its end.
/// @param column  in characters, from 1
std::size_t byte_of_column(std::string_view line, std::size_t column) {
  std::size_t at = 0;
  for (; column > 1 && at < line.size(); --column) {
    do ++at;
    while (at < line.size() && continues_a_character(line[at]));
  }
  return at;
}

/// The word at a byte of a line, or the last one before it.
std::string word_at(std::string_view line, std::size_t at) {
  constexpr std::size_t kBefore = 20, kBehind = 40;  // of a longer word, its part near that place
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  const auto between = [&](char c) { return blank(c) || c == ',' || c == '='; };
  while (at > 0 && (at >= line.size() || blank(line[at]))) --at;
  if (line.empty() || blank(line[at])) return {};
  if (between(line[at])) return std::string(1, line[at]);
  std::size_t begin = at, end = at + 1;
  while (begin > 0 && !between(line[begin - 1]) && at - begin < kBefore) --begin;
  while (end < line.size() && !between(line[end]) && end - at < kBehind) ++end;
  while (begin > 0 && continues_a_character(line[begin])) --begin;
  while (end < line.size() && continues_a_character(line[end])) ++end;
  return on_one_line(line.substr(begin, end - begin));
}

/// Puts other words in place of some, once.
void reword(std::string& text, std::string_view from, std::string_view to) {
  if (const std::size_t at = text.find(from); at != std::string::npos) {
    text.replace(at, from.size(), to);
  }
}

/// What the parser complains about, without "Error while parsing string: ".
/// @param word         where that is
/// @param end_of_line  there is nothing more in that line
std::string reason_of(std::string_view said, std::string_view word, bool end_of_line) {
  constexpr std::string_view kBegin = "Error while parsing ";
  std::string what = "text";  // that is parsed
  if (const std::size_t colon = said.find(": ");
      said.starts_with(kBegin) && colon != std::string_view::npos) {
    what = said.substr(kBegin.size(), colon - kBegin.size());
    said.remove_prefix(colon + 2);
  }
  const bool end = said == "encountered end-of-file";
  if (what.ends_with("string") && (end || end_of_line)) return "a quotation mark is not closed";
  reword(what, "array", "list");
  if (end) return fmt::format("the text ends within the {}", what);
  std::string reason = brief(said, 200);
  reword(reason, R"(saw '\n')", "saw the end of the line");
  reword(reason, R"(saw '\r')", "saw the end of the line");
  reword(reason, "saw ''", "saw the end of the text");
  const bool letters = !word.empty() && std::isalpha(static_cast<unsigned char>(word[0])) != 0;
  if (letters) reword(reason, "determine value type", "determine value type; text needs quotes");
  return reason;
}

std::string in_full(const toml::node& node) {
  constexpr std::size_t kMost = 4;  // of a longer list, how long it is says more
  std::string all;
  if (const auto* text = node.as_string()) return fmt::format("'{}'", brief(text->get()));
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* array = node.as_array()) {
    if (array->size() > kMost) return fmt::format("a list of {} values", array->size());
    for (const toml::node& item : *array) all += (all.empty() ? "" : ", ") + in_full(item);
    return fmt::format("[{}]", all);
  }
  if (const auto* table = node.as_table()) {
    if (table->size() > kMost) return fmt::format("a table of {} keys", table->size());
    for (const auto& [key, value] : *table) {
      all += fmt::format("{}{} = {}", all.empty() ? "" : ", ", brief(key.str()), in_full(value));
    }
    return fmt::format("{{{}}}", all);
  }
  std::ostringstream other;  // a whole number, true, false, a date
  node.visit([&](const auto& value) { other << value; });
  return other.str();
}

}  // namespace

toml::table parse_toml(std::string_view text, std::string_view where, bool one_line) {
  require_shallow(text, where);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    const std::string_view line = line_of_text(text, place.line);
    const std::size_t at = byte_of_column(line, place.column);
    const std::string word = word_at(line, at);
    throw std::invalid_argument(fmt::format(
        "{}{}: not TOML: column {}{}: {}", where, one_line ? "" : fmt::format(":{}", place.line),
        place.column, word.empty() ? "" : fmt::format(": '{}'", word),
        reason_of(error.description(), word, at >= line.size())));
  }
}

std::string value_in_words(const toml::node& node) {
  constexpr std::size_t kMost = 120;
  return brief(in_full(node), kMost);
}

}  // namespace headpin::scene
