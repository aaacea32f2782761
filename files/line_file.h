#pragma once

#include <cstdint>
#include <string>

/// Files that grow by a line at a time.
namespace headpin::files {

/// A file that is open for us alone, to which whole lines are added, each on the disk at once.
class LineFile {
 public:
  /// Opens the file, or makes it. What a crash left of a last line is cut off.
  /// @throws std::runtime_error  naming the file and the reason
  /// @throws Busy                when another of us has it open so
  explicit LineFile(std::string path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// The lines that were there.
  const std::string& text() const { return text_; }

  /// Adds lines, each with its end, all or none of them.
  /// @throws std::runtime_error  when the disk did not take them; the file is as before then
  void append(const std::string& lines);

 private:
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_, text_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace headpin::files
