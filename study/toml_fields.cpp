#include "study/toml_fields.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/scenario/nearest.h"
#include "scene/scenario/toml_reading.h"

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

/// Refuses the first key that is none of those, in this table and in those in it.
void require_known(const toml::table& table, const std::string& path,
                   const std::vector<std::string>& keys, const std::string& where) {
  for (const auto& [key, node] : table) {
    const std::string name = path + std::string(key.str());
    const bool is_table = std::ranges::any_of(
        keys, [&](const std::string& one) { return one.starts_with(name + "."); });
    if (!is_table && std::ranges::find(keys, name) == keys.end()) {
      throw std::invalid_argument(
          fmt::format("{}:{}: {}", where, key.source().begin.line, scene::unknown_key(name, keys)));
    }
    if (!is_table) continue;
    if (const auto* inner = node.as_table()) require_known(*inner, name + ".", keys, where);
    if (const auto* list = node.as_array()) {
      for (const toml::node& item : *list) {
        if (const auto* inner = item.as_table()) require_known(*inner, name + ".", keys, where);
      }
    }
  }
}

}  // namespace

bool TomlFields::has(const std::string& key) {
  known_.insert(key);
  return table_->contains(key);
}

int TomlFields::line(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return static_cast<int>((node ? node->source() : table_->source()).begin.line);
}

void TomlFields::fail(const std::string& key, const std::string& what) const {
  throw std::invalid_argument(fmt::format("{}:{}: {}{} {}", where_, line(key), path_, key, what));
}

void TomlFields::refuse(const std::string& key, const std::string& expected) const {
  const toml::node* node = table_->get(key);
  fail(key, fmt::format("must be {}, found {}", expected,
                        node ? scene::value_in_words(*node) : "nothing"));
}

void TomlFields::refuse_named(const std::string& key, const toml::key& name,
                              const toml::node& value, const std::string& expected) const {
  throw std::invalid_argument(fmt::format("{}:{}: {}{}.{} must be {}, found {}", where_,
                                          name.source().begin.line, path_, key, name.str(),
                                          expected, scene::value_in_words(value)));
}

const toml::node& TomlFields::need(const std::string& key) {
  known_.insert(key);
  if (const toml::node* node = table_->get(key)) return *node;
  refuse(key, "given");
}

const toml::table& TomlFields::need_named(const std::string& key) {
  const auto* table = need(key).as_table();
  if (!table || table->empty()) refuse(key, "a table {name = value}");
  return *table;
}

std::string TomlFields::text(const std::string& key) {
  const toml::node& node = need(key);
  if (!node.is_string()) refuse(key, "text");
  return node.as_string()->get();
}

std::string TomlFields::text(const std::string& key, const std::string& fallback) {
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
  if (!array || array->empty()) refuse(key, "a list of one value or more");
  std::vector<std::string> all;
  for (const toml::node& item : *array) {
    const auto value = as_text(item);
    if (!value) refuse(key, "a list of numbers or texts");
    all.push_back(*value);
  }
  return all;
}

std::vector<std::pair<std::string, std::string>> TomlFields::named_texts(const std::string& key) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [name, item] : need_named(key)) {
    const auto value = as_text(item);
    if (!value) refuse_named(key, name, item, "text");
    all.emplace_back(name.str(), *value);
  }
  return all;
}

std::vector<std::pair<std::string, int>> TomlFields::counts(const std::string& key, int most) {
  std::vector<std::pair<std::string, int>> all;
  for (const auto& [name, item] : need_named(key)) {
    const auto* value = item.as_integer();
    if (!value || value->get() < 0) refuse_named(key, name, item, "a whole number from 0 on");
    if (value->get() > most) refuse_named(key, name, item, fmt::format("{} at most", most));
    all.emplace_back(name.str(), static_cast<int>(value->get()));
  }
  return all;
}

std::vector<TomlFields> TomlFields::tables(const std::string& key) {
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
  std::vector<std::string> known;
  for (const std::string& key : known_) known.push_back(path_ + key);
  require_known(*table_, path_, known, where_);
}

toml::table parse_toml(std::string_view text, const std::string& where,
                       const std::vector<std::string>& keys) {
  toml::table table = scene::parse_toml(text, where);
  require_known(table, "", keys, where);
  return table;
}

}  // namespace headpin::study
