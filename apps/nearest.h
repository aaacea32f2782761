#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace headpin::apps {

/// Of some names the one that is most likely meant by a mistyped word: letters left out, put in,
/// replaced, or two of them exchanged, at most one for each three letters.
std::optional<std::string> nearest(std::string_view word, std::span<const std::string> names);

}  // namespace headpin::apps
