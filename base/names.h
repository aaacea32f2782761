#pragma once

#include <string>

/// Links and pipes that exist while the program runs.
namespace headpin::base {

/// Creates a symbolic link in one step; it replaces an existing link.
/// @throws std::runtime_error  naming the link: it cannot be created, or the name is that of
///                             another file
void place_link(const std::string& target, const std::string& link);

/// Removes a symbolic link if it still points to `target`; another process may have replaced it.
void remove_link(const std::string& target, const std::string& link) noexcept;

/// Removes a named pipe if it is still the one behind `descriptor`.
void remove_pipe(const std::string& path, int descriptor) noexcept;

}  // namespace headpin::base
