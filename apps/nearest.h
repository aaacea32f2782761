#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace headpin::apps {

/// Finds the name that a mistyped word most likely means: missing, additional, wrong or exchanged
/// letters, at most one for every three letters. CLI11 does not suggest names.
std::optional<std::string> nearest(std::string_view word, std::span<const std::string> names);

}  // namespace headpin::apps
