#pragma once

#include <optional>
#include <string>
#include <vector>

namespace headpin::apps {

/// The result of another program.
struct Ended {
  int code = 0;      ///< its exit code; 128 + N where signal N ended it
  std::string says;  ///< its standard output and error
};

/// Runs a program from PATH until it ends. If this process is killed, the program is killed too.
/// @return  nothing if there is no such program
/// @throws std::runtime_error  where it cannot be started
std::optional<Ended> run_program(const std::vector<std::string>& words);

}  // namespace headpin::apps
