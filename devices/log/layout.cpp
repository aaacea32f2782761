#include "devices/log/layout.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "devices/base/bytes.h"

namespace headpin::devices {

namespace {

/// Takes the words and signs of a schema, without comments.
class Words {
 public:
  explicit Words(std::string_view text) : left_(text) {}

  /// Empty at the end.
  std::string_view next() {
    for (;;) {
      const auto begin = std::find_if_not(left_.begin(), left_.end(), is_blank);
      left_.remove_prefix(static_cast<std::size_t>(begin - left_.begin()));
      if (!left_.starts_with("//")) break;
      left_.remove_prefix(std::min(left_.find('\n'), left_.size()));
    }
    const auto end = std::find_if_not(left_.begin(), left_.end(), is_of_word);
    const auto size = std::max<std::ptrdiff_t>(end - left_.begin(), left_.empty() ? 0 : 1);
    const std::string_view word = left_.substr(0, static_cast<std::size_t>(size));
    left_.remove_prefix(word.size());
    return word;
  }

 private:
  static bool is_blank(unsigned char c) { return std::isspace(c) != 0; }
  static bool is_of_word(unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; }

  std::string_view left_;
};

MessageField field_of(std::string_view type) {
  static const std::map<std::string_view, std::ptrdiff_t> sizes = {
      {"int8_t", 1},  {"byte", 1},  {"boolean", 1}, {"int16_t", 2},
      {"int32_t", 4}, {"float", 4}, {"int64_t", 8}, {"double", 8}};
  MessageField field;
  if (const auto number = sizes.find(type); number != sizes.end()) {
    field.size = number->second;
  } else if (type == "string") {
    field.kind = MessageField::Kind::text;
  } else {
    field.kind = MessageField::Kind::structure;
    field.structure = type;
  }
  return field;
}

/// The dimensions of a field, up to its semicolon.
void read_dimensions(Words& words, MessageField& field) {
  for (std::string_view word = words.next(); word == "["; word = words.next()) {
    const std::string_view dimension = words.next();
    std::ptrdiff_t times = 0;
    const char* const end = dimension.data() + dimension.size();
    if (std::from_chars(dimension.data(), end, times).ptr == end) {
      field.times *= times;
    } else {
      field.counts_in.emplace_back(dimension);
    }
    words.next();  // ]
  }
}

std::vector<MessageField> fields_in(Words& words) {
  std::vector<MessageField> fields;
  words.next();  // {
  for (std::string_view word = words.next(); !word.empty() && word != "}"; word = words.next()) {
    if (word == "const") {
      while (!word.empty() && word != ";") word = words.next();
      continue;
    }
    MessageField field = field_of(word);
    field.name = words.next();
    read_dimensions(words, field);
    for (MessageField& earlier : fields) {
      const auto is_it = [&](const std::string& name) { return name == earlier.name; };
      earlier.counts |= std::any_of(field.counts_in.begin(), field.counts_in.end(), is_it);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

/// A message in its bytes.
struct Position {
  std::span<const std::uint8_t> bytes;
  std::ptrdiff_t at = 0;

  std::ptrdiff_t left() const { return static_cast<std::ptrdiff_t>(bytes.size()) - at; }
  /// A signed number of `size` bytes.
  std::int64_t number(std::ptrdiff_t size) const {
    const std::uint64_t value =
        big_endian(bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size)));
    const auto unused = static_cast<unsigned>(64 - 8 * size);
    return static_cast<std::int64_t>(value << unused) >> unused;
  }
  /// Goes behind a text: its length with the NUL, its bytes.
  bool pass_text() {
    if (left() < 4) return false;
    const std::int64_t length = number(4);
    at += 4;
    if (length < 1 || length > left()) return false;
    at += length;
    return bytes[static_cast<std::size_t>(at - 1)] == 0;
  }
};

}  // namespace

Layouts::Layouts(std::string_view schema) {
  Words words(schema);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word != "struct") continue;  // a package
    const std::string name(words.next());
    types_[name] = fields_in(words);
  }
  for (const auto& [name, fields] : types_) {
    for (const MessageField& field : fields) {
      if (field.kind != MessageField::Kind::structure || types_.contains(field.structure)) continue;
      throw std::invalid_argument(name + "." + field.name + ": unknown type " + field.structure);
    }
  }
}

std::ptrdiff_t Layouts::end_of(const std::string& type, std::span<const std::uint8_t> bytes,
                               std::ptrdiff_t at) const {
  Position position{bytes, at};
  std::map<std::string_view, std::int64_t> numbers;
  for (const MessageField& field : types_.at(type)) {
    std::int64_t times = field.times;
    for (const std::string& count : field.counts_in) {
      const std::int64_t number = numbers.at(count);
      if (number < 0 || (times > 0 && number > position.left() / times)) return -1;
      times *= number;
    }
    if (field.kind == MessageField::Kind::number) {
      if (times > position.left() / field.size) return -1;
      if (field.counts) numbers[field.name] = position.number(field.size);
      position.at += times * field.size;
      continue;
    }
    for (std::int64_t i = 0; i < times; ++i) {
      if (field.kind == MessageField::Kind::structure) {
        position.at = end_of(field.structure, bytes, position.at);
        if (position.at < 0) return -1;
      } else if (!position.pass_text()) {
        return -1;
      }
    }
  }
  return position.at;
}

}  // namespace headpin::devices
