#include "scene/scenario/nearest.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/scenario/toml_text.h"

namespace headpin::scene {
namespace {

/// The optimal string alignment distance: the number of letters to remove, insert, replace, or
/// exchange with the next one, to change `a` into `b`.
std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, row);
  }
  return last[b.size()];
}

/// "ball." of "ball.mass"; empty for a key of no table.
std::string_view table_of_key(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : key.substr(0, dot + 1);
}

/// The names in a table, each once: home, mass, mesh and radius in "ball.".
std::vector<std::string> names_in_table(std::string_view table,
                                        const std::vector<std::string>& all) {
  std::set<std::string> names;
  for (const std::string& key : all) {
    if (!key.starts_with(table)) continue;
    const std::string rest = key.substr(table.size());
    names.insert(rest.substr(0, rest.find_first_of(".[")));
  }
  return {names.begin(), names.end()};
}

/// How many names two keys share at their ends: 2 for lane.friction and material.lane.friction.
std::size_t names_shared(std::string_view a, std::string_view b) {
  for (std::size_t names = 0;; ++names) {
    const std::string_view table_a = table_of_key(a), table_b = table_of_key(b);
    if (a.substr(table_a.size()) != b.substr(table_b.size())) return names;
    if (table_a.empty() || table_b.empty()) return names + 1;
    a = table_a.substr(0, table_a.size() - 1);
    b = table_b.substr(0, table_b.size() - 1);
  }
}

/// The keys that share most names with this one at its end; none if its last name is new.
std::vector<std::string> keys_of_that_name(std::string_view key,
                                           const std::vector<std::string>& all) {
  std::vector<std::string> best;
  std::size_t most = 1;
  for (const std::string& other : all) {
    const std::size_t names = names_shared(key, other);
    if (names < most) continue;
    if (names > most) best.clear();
    most = names;
    best.push_back(other);
  }
  return best;
}

}  // namespace

std::optional<std::string> nearest(std::string_view word, std::span<const std::string> names) {
  constexpr std::size_t kLongest = 40;  // longer words are not typing errors
  if (word.size() > kLongest) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& name : names) {
    const std::size_t d = letters_apart(word, name);
    if (d >= least) continue;
    least = d;
    best = name;
  }
  return best;
}

std::string unknown_key(std::string_view key, const std::vector<std::string>& all) {
  const std::string_view table = table_of_key(key);
  const std::vector<std::string> names = names_in_table(table, all);
  const std::string unknown = fmt::format("unknown key '{}'", brief(key));
  const std::vector<std::string> inside = names_in_table(fmt::format("{}.", key), all);
  if (!inside.empty()) {
    return fmt::format("{}: it is a table; known in it: {}", unknown, fmt::join(inside, ", "));
  }
  if (const auto meant = nearest(key.substr(table.size()), names)) {
    return fmt::format("{}; the nearest is {}{}", unknown, table, *meant);
  }
  if (table.empty() || names.empty()) {  // a dot is missing, or the table is mistyped
    if (const auto meant = nearest(key, all)) {
      return fmt::format("{}; the nearest is {}", unknown, *meant);
    }
  }
  const std::vector<std::string> same = keys_of_that_name(key, all);
  if (!same.empty()) {
    return fmt::format("{}; {} {}", unknown,
                       same.size() == 1 ? "the nearest is" : "keys of that name are",
                       fmt::join(same, ", "));
  }
  return fmt::format("{}; known here: {}", unknown,
                     fmt::join(names.empty() ? names_in_table("", all) : names, ", "));
}

}  // namespace headpin::scene
