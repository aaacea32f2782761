#include "study/toml_fields.h"

#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/scenario/toml_text.h"
#include "study/csv.h"

namespace headpin::study {

namespace {

/// A value as its shortest text; nothing for tables, arrays and dates.
std::optional<std::string> as_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* yes = node.as_boolean()) return yes->get() ? "true" : "false";
  return std::nullopt;
}

std::string in_words(const toml::node& node) {
  if (const auto text = as_text(node)) return shown(*text);
  return node.is_table() ? "a table" : node.is_array() ? "an array" : "another value";
}

}  // namespace

int TomlFields::line(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return static_cast<int>((node ? node->source() : table_->source()).begin.line);
}

void TomlFields::refuse(const std::string& key, const std::string& expected) const {
  const toml::node* node = table_->get(key);
  throw std::invalid_argument(fmt::format("{}:{}: {}{} must be {}, found {}", where_, line(key),
                                          path_, key, expected,
                                          node ? in_words(*node) : "nothing"));
}

const toml::node& TomlFields::need(const std::string& key) {
  known_.insert(key);
  if (const toml::node* node = table_->get(key)) return *node;
  refuse(key, "given");
}

std::string TomlFields::text(const std::string& key) {
  const toml::node& node = need(key);
  if (!node.is_string()) refuse(key, "a string");
  return node.as_string()->get();
}

std::string TomlFields::text(const std::string& key, const std::string& fallback) {
  known_.insert(key);
  return has(key) ? text(key) : fallback;
}

int TomlFields::whole(const std::string& key, int low, int high) {
  const auto* value = need(key).as_integer();
  if (!value || value->get() < low || value->get() > high) {
    refuse(key, fmt::format("a whole number from {} to {}", low, high));
  }
  return static_cast<int>(value->get());
}

int TomlFields::whole(const std::string& key, int low, int high, int fallback) {
  known_.insert(key);
  return has(key) ? whole(key, low, high) : fallback;
}

std::uint64_t TomlFields::seed(const std::string& key) {
  const auto* value = need(key).as_integer();
  if (!value || value->get() < 0) refuse(key, "a whole number from 0 to 2^63 - 1");
  return static_cast<std::uint64_t>(value->get());
}

double TomlFields::number(const std::string& key) {
  const toml::node& node = need(key);
  const auto value = node.value<double>();
  if (!node.is_number() || !value || !(*value > -1e9 && *value < 1e9)) refuse(key, "a number");
  return *value;
}

std::vector<std::string> TomlFields::texts(const std::string& key) {
  const auto* array = need(key).as_array();
  if (!array || array->empty()) refuse(key, "an array of values");
  std::vector<std::string> all;
  for (const toml::node& item : *array) {
    const auto value = as_text(item);
    if (!value) refuse(key, "an array of values");
    all.push_back(*value);
  }
  return all;
}

std::vector<std::pair<std::string, std::string>> TomlFields::named_texts(const std::string& key) {
  const auto* table = need(key).as_table();
  if (!table || table->empty()) refuse(key, "a table {name = value}");
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [name, item] : *table) {
    const auto value = as_text(item);
    if (!value) refuse(key, "a table {name = value}");
    all.emplace_back(name.str(), *value);
  }
  return all;
}

std::vector<TomlFields> TomlFields::tables(const std::string& key) {
  known_.insert(key);
  std::vector<TomlFields> all;
  if (!has(key)) return all;
  const auto* array = table_->get(key)->as_array();
  if (!array) refuse(key, fmt::format("tables, each headed by [[{}]]", key));
  for (const toml::node& item : *array) {
    if (!item.is_table()) refuse(key, fmt::format("tables, each headed by [[{}]]", key));
    all.emplace_back(*item.as_table(), where_, path_ + key + ".");
  }
  return all;
}

void TomlFields::finish() const {
  for (const auto& [key, node] : *table_) {
    if (known_.contains(std::string(key.str()))) continue;
    throw std::invalid_argument(fmt::format("{}:{}: unknown key '{}{}'; known here: {}", where_,
                                            key.source().begin.line, path_, shown(key.str()),
                                            fmt::join(known_, ", ")));
  }
}

toml::table parse_toml(std::string_view text, const std::string& where) {
  scene::require_shallow(text, where);
  try {
    return toml::parse(text, where);
  } catch (const toml::parse_error& error) {
    throw std::invalid_argument(
        fmt::format("{}:{}: not TOML: {}", where, error.source().begin.line, error.description()));
  }
}

}  // namespace headpin::study
