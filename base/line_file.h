#pragma once

#include <cstdint>
#include <string>

/// Files that grow line by line.
namespace headpin::base {

/// A locked file to which whole lines are added; each line is on the disk when add() returns.
class LineFile {
 public:
  /// Opens the file, or creates it. Removes an incomplete last line that a crash left.
  /// @throws std::runtime_error  naming the file and the reason
  /// @throws Busy                when another headpin has it open
  explicit LineFile(std::string path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// The lines that the file had when it was opened.
  const std::string& text() const { return text_; }

  /// Adds all lines or none. Each must have its line end.
  /// @throws std::runtime_error  when the lines cannot be written; the file is then unchanged
  void append(const std::string& lines);

 private:
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_, text_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace headpin::base
