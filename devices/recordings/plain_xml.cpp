#include "devices/recordings/plain_xml.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

constexpr std::size_t kDeepest = 100, kMostElements = 200'000;

/// A character in UTF-8; nothing for a number that is none.
std::string utf8_of(std::uint32_t code) {
  if (code == 0 || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return "";
  const auto tail = [&](int shift) { return static_cast<char>(0x80 | (code >> shift & 0x3f)); };
  if (code < 0x80) return {static_cast<char>(code)};
  if (code < 0x800) return {static_cast<char>(0xc0 | code >> 6), tail(0)};
  if (code < 0x10000) return {static_cast<char>(0xe0 | code >> 12), tail(6), tail(0)};
  return {static_cast<char>(0xf0 | code >> 18), tail(12), tail(6), tail(0)};
}

/// What stands for "&name;", by its name; nothing if it is not known.
std::string entity(std::string_view name) {
  if (name == "lt") return "<";
  if (name == "gt") return ">";
  if (name == "amp") return "&";
  if (name == "quot") return "\"";
  if (name == "apos") return "'";
  if (!name.starts_with('#')) return "";
  const bool hex = name.starts_with("#x");
  name.remove_prefix(hex ? 2 : 1);
  std::uint32_t code = 0;
  const auto read = std::from_chars(name.data(), name.data() + name.size(), code, hex ? 16 : 10);
  return read.ec == std::errc{} && read.ptr == name.data() + name.size() ? utf8_of(code) : "";
}

std::string unescaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t begin = std::min(text.find('&'), text.size());
    out += text.substr(0, begin);
    text.remove_prefix(begin);
    if (text.empty()) break;
    const std::size_t end = text.find(';');
    const std::string said = end == std::string_view::npos ? "" : entity(text.substr(1, end - 1));
    out += said.empty() ? "&" : said;
    text.remove_prefix(said.empty() ? 1 : end + 1);
  }
  return out;
}

class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  XmlElement read() {
    while (at_ < text_.size()) {
      if (text_[at_] != '<') {
        take_text();
      } else if (rest().starts_with("<!--")) {
        skip("-->");
      } else if (rest().starts_with("<![CDATA[")) {
        const std::size_t begin = at_ + 9;
        skip("]]>");
        open_.back()->text += text_.substr(begin, at_ - 3 - begin);
      } else if (rest().starts_with("<?")) {
        skip("?>");
      } else if (rest().starts_with("<!")) {
        skip(">");
      } else {
        take_tag();
      }
    }
    if (open_.size() > 1) fail(fmt::format("'{}' does not end", open_.back()->name));
    if (top_.children.size() != 1) {
      fail(fmt::format("expected one element at the top, found {}", top_.children.size()));
    }
    return std::move(top_.children.front());
  }

 private:
  std::string_view rest() const { return text_.substr(at_); }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(fmt::format("byte {} of its XML: {}", at_, what));
  }

  void take_text() {
    const std::size_t end = std::min(text_.find('<', at_), text_.size());
    open_.back()->text += unescaped(text_.substr(at_, end - at_));
    at_ = end;
  }

  void skip(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) fail(fmt::format("expected '{}'", end));
    at_ = found + end.size();
  }

  void take_tag() {
    const std::size_t begin = at_ + 1;
    skip(">");
    std::string_view tag = text_.substr(begin, at_ - 1 - begin);
    if (tag.starts_with('/')) return close(trimmed(tag.substr(1)));
    const bool empty = tag.ends_with('/');
    if (empty) tag.remove_suffix(1);
    const std::string_view name = tag.substr(0, tag.find_first_of(" \t\r\n"));
    if (name.empty()) fail("expected the name of an element");
    if (open_.size() > kDeepest || ++elements_ > kMostElements) fail("too many elements");
    open_.back()->children.push_back({std::string(name)});
    if (!empty) open_.push_back(&open_.back()->children.back());
  }

  void close(std::string_view name) {
    if (open_.size() == 1 || open_.back()->name != name) {
      fail(fmt::format("'{}' ends, but has not begun", name.substr(0, 40)));
    }
    open_.pop_back();
  }

  std::string_view text_;
  std::size_t at_ = 0, elements_ = 0;
  XmlElement top_;
  // An element gets no sibling while it is open, so the pointers stay valid.
  std::vector<XmlElement*> open_ = {&top_};
};

/// The length of a valid character of UTF-8 at the front; 0 if there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xc2 ? 0
                             : first < 0xe0 ? 2
                             : first < 0xf0 ? 3
                             : first < 0xf5 ? 4
                                            : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 2) return 0;
  }
  if (length == 1) return first >= 32 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  // Longer than needed, halves of a pair, too large, and the two that XML forbids.
  if (length == 3) {
    if ((first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) >= 0xa0)) return 0;
    if (first == 0xef && byte(1) == 0xbf && byte(2) >= 0xbe) return 0;
  }
  if (length == 4 && ((first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90))) {
    return 0;
  }
  return length;
}

}  // namespace

const XmlElement* XmlElement::find(std::initializer_list<std::string_view> path) const {
  const XmlElement* here = this;
  for (const std::string_view step : path) {
    const auto next = std::ranges::find(here->children, step, &XmlElement::name);
    if (next == here->children.end()) return nullptr;
    here = &*next;
  }
  return here;
}

std::string XmlElement::text_at(std::initializer_list<std::string_view> path) const {
  const XmlElement* found = find(path);
  if (!found) return "";
  const std::size_t begin = found->text.find_first_not_of(" \t\r\n");
  const std::size_t end = found->text.find_last_not_of(" \t\r\n");
  return begin == std::string::npos ? "" : found->text.substr(begin, end + 1 - begin);
}

XmlElement parse_xml(std::string_view text) {
  return XmlReader(text).read();
}

std::string xml_escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view one = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0) {
      out += '?';
    } else if (one == "<") {
      out += "&lt;";
    } else if (one == ">") {
      out += "&gt;";
    } else if (one == "&") {
      out += "&amp;";
    } else if (one == "\r") {
      out += "&#13;";
    } else {
      out += one;
    }
    text.remove_prefix(one.size());
  }
  return out;
}

}  // namespace headpin::devices
