#pragma once

#include <cstdint>
#include <string>

/// Files that grow line by line.
namespace headpin::base {

/// A locked file to which whole lines are added; each line is on the disk when add() returns.
class LineFile {
 public:
  /// Opens the file, or creates it, and changes nothing in it. It is the file of that name once it is locked,
  /// also where another headpin has replaced it before.
  /// @throws std::runtime_error  naming the file and the reason
  /// @throws Busy                when another headpin has it open
  explicit LineFile(std::string path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// What the file had when it was opened. Its last line has no end if an editor, or a crash, left it
  /// so.
  const std::string& text() const { return text_; }
  /// The part of it that has line ends.
  std::string whole_lines() const;
  /// Removes the last line if it has no end.
  /// @throws std::runtime_error  when the file cannot be written
  void cut_last_line();

  /// Adds all lines or none, behind the end of the last line. Each must have its line end.
  /// @throws std::runtime_error  when the lines cannot be written; the file is then unchanged
  void append(const std::string& more);

 private:
  void open_locked();
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_, text_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
  bool ended_ = true;  ///< the last line has an end
};

}  // namespace headpin::base
