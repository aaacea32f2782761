#pragma once

#include <string>

/// Names that others find something by while we run, and files without one.
namespace headpin::files {

/// Gives a symbolic link, in one step, in place of a link that may stand there.
/// @throws std::runtime_error  naming the link: it cannot be made, or something else stands there
void place_link(const std::string& target, const std::string& link);

/// Removes a symbolic link if it still leads to `target`: another one may have taken the name over.
void remove_link(const std::string& target, const std::string& link) noexcept;

/// Removes a named pipe if it is still the one behind `descriptor`.
void remove_pipe(const std::string& path, int descriptor) noexcept;

/// A file without a name, open for reading and writing, in TMPDIR or /tmp; gone when it is closed.
/// @throws std::runtime_error  naming the folder
int nameless_file();

}  // namespace headpin::files
