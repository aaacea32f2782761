#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What a mistyped name most likely means.
namespace headpin::scene {

/// Finds the name that a mistyped word most likely means: missing, additional, wrong or exchanged
/// letters, at most one for every three letters.
std::optional<std::string> nearest(std::string_view word, std::span<const std::string> names);

/// What to say of a key that does not exist: "unknown key 'ball.mas'; the nearest is ball.mass". If
/// none is near, the keys of its name in other tables; else all keys of its table.
///
/// @param key  its whole name
/// @param all  the whole names of all keys; `[]` stands for an entry of a list
std::string unknown_key(std::string_view key, const std::vector<std::string>& all);

}  // namespace headpin::scene
