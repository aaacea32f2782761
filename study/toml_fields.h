#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <toml++/toml.h>

/// Reads the tables of designs and questionnaires, strictly: every key is asked for, and what is
/// wrong is said with file and line.
namespace headpin::study {

/// One table of a TOML text. `finish()` comes last: it refuses keys that nothing asked for.
class TomlFields {
 public:
  TomlFields(const toml::table& table, std::string where, std::string path)
      : table_(&table), where_(std::move(where)), path_(std::move(path)) {}

  bool has(const std::string& key);
  int line(const std::string& key) const;

  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  int whole(const std::string& key, int low, int high);
  int whole(const std::string& key, int low, int high, int fallback);
  std::uint64_t seed(const std::string& key);
  double number(const std::string& key);
  std::vector<std::string> texts(const std::string& key);  ///< numbers as the shortest text
  std::vector<std::pair<std::string, std::string>> named_texts(const std::string& key);
  /// A table {name = how many}, each at most `most`.
  std::vector<std::pair<std::string, int>> counts(const std::string& key, int most);
  std::vector<TomlFields> tables(const std::string& key);  ///< of `[[key]]`; empty without any
  void finish() const;

  /// @throws std::invalid_argument  "FILE:LINE: PATH.KEY WHAT"
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;
  /// @throws std::invalid_argument  "FILE:LINE: PATH.KEY must be EXPECTED, found FOUND"
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const;

 private:
  const toml::node& need(const std::string& key);
  const toml::table& need_named(const std::string& key);
  /// Refuses the value of one name in the table of a key.
  [[noreturn]] void refuse_named(const std::string& key, const toml::key& name,
                                 const toml::node& value, const std::string& expected) const;

  const toml::table* table_;
  std::string where_, path_;
  std::set<std::string> known_;
};

/// @param keys  the whole names of all keys, such as factor.levels; another one is refused before any
///   is missed
/// @throws std::invalid_argument  naming file and line, for text that is not TOML, or an unknown key
toml::table parse_toml(std::string_view text, const std::string& where,
                       const std::vector<std::string>& keys);

}  // namespace headpin::study
