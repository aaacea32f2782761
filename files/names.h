#pragma once

#include <string>

/// Links and pipes that exist while the program runs, and files without a name.
namespace headpin::files {

/// Creates a symbolic link in one step; it replaces an existing link.
/// @throws std::runtime_error  naming the link: it cannot be created, or the name is that of
///                             another file
void place_link(const std::string& target, const std::string& link);

/// Removes a symbolic link if it still points to `target`; another process may have replaced it.
void remove_link(const std::string& target, const std::string& link) noexcept;

/// Removes a named pipe if it is still the one behind `descriptor`.
void remove_pipe(const std::string& path, int descriptor) noexcept;

/// Opens a file without a name for reading and writing, in TMPDIR or /tmp; it vanishes when it is
/// closed.
/// @throws std::runtime_error  naming the folder
int nameless_file();

}  // namespace headpin::files
