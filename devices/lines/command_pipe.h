#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace headpin::devices {

/// Lines of text that others write to a named pipe or to standard input, while something runs.
class CommandPipe {
 public:
  static constexpr std::size_t kLongest = 4096;  ///< bytes in a line; longer ones are ignored

  /// @param path  a named pipe, made if missing, and then removed at the end; - for standard input;
  ///              empty: no line ever comes
  /// @throws std::runtime_error  naming the path
  explicit CommandPipe(const std::string& path);
  ~CommandPipe();
  CommandPipe(const CommandPipe&) = delete;
  CommandPipe& operator=(const CommandPipe&) = delete;

  /// For poll(2); -1 when no line will come.
  int descriptor() const { return fd_; }

  /// The complete lines since the last call; of very many lines, the rest comes with the next call.
  /// Does not wait.
  std::vector<std::string> lines();

  /// How many lines were too long.
  std::int64_t ignored() const { return ignored_; }

 private:
  int fd_ = -1;
  bool ours_ = false;  ///< fd_: to be closed, which standard input is not
  std::string made_, text_;
  bool skips_ = false;  ///< the rest of a line that is too long
  std::int64_t ignored_ = 0;
};

}  // namespace headpin::devices
