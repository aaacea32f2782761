#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Files that are read. A read that fails is an error and never the end of the file.
namespace headpin::files {

/// A regular file, read by place.
class InputFile {
 public:
  /// Waits for nobody, also where the name is a named pipe's.
  /// @throws std::runtime_error  when the file cannot be opened or is not a regular file
  explicit InputFile(std::string path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Bytes, as it was opened.
  std::size_t size() const { return size_; }

  /// Fills `out` from the bytes at `at` on.
  /// @return  how many there are: fewer than asked for only where the file ends
  /// @throws std::runtime_error  naming the file and the reason
  std::size_t read(std::size_t at, std::span<std::uint8_t> out) const;

 private:
  std::string path_;
  int file_ = -1;
  std::size_t size_ = 0;
};

/// Reads what is there now, at most `out.size()` bytes; an interrupted read is begun again.
/// @return  how many; 0 at the end
/// @throws std::runtime_error  naming what is read and the reason
std::size_t read_some(int descriptor, std::span<std::uint8_t> out, const std::string& name);

/// All bytes of a regular file.
/// @param most  of them; more are refused
/// @throws std::runtime_error  naming the file and the reason
std::vector<std::uint8_t> read_bytes(const std::string& path, std::size_t most);

/// The same, as text.
std::string read_text(const std::string& path, std::size_t most);

}  // namespace headpin::files
