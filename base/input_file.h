#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Files that are read. A failed read is an error; it is never taken for the end of the file.
namespace headpin::base {

/// A regular file that is read at any position.
class InputFile {
 public:
  /// Does not wait for a named pipe; it is refused.
  /// @param path  `-` is standard input: the first such file waits until all of it was read
  /// @throws std::runtime_error  when the file cannot be opened or is not a regular file
  explicit InputFile(std::string path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Size in bytes when the file was opened.
  std::size_t size() const { return size_; }

  /// Fills `out` with the bytes from position `at`.
  /// @return  number of bytes; smaller than `out` only at the end of the file
  /// @throws std::runtime_error  naming the file and the reason
  std::size_t read(std::size_t at, std::span<std::uint8_t> out) const;

 private:
  std::string path_;
  int file_ = -1;
  std::size_t size_ = 0;
};

/// A file with all bytes of standard input, to be read with `pread`; the caller closes it. Pipes can
/// be read once: their bytes are kept while the program runs.
/// @throws std::runtime_error  it cannot be read or kept
int standard_input();

/// Reads the bytes that are available now, at most `out.size()`; an interrupted read is repeated.
/// @return  number of bytes; 0 at the end
/// @throws std::runtime_error  naming what is read and the reason
std::size_t read_some(int descriptor, std::span<std::uint8_t> out, const std::string& name);

/// All bytes of a regular file.
/// @param most  largest accepted number of bytes
/// @throws std::runtime_error  naming the file and the reason
std::vector<std::uint8_t> read_bytes(const std::string& path, std::size_t most);

/// The same, as text.
std::string read_text(const std::string& path, std::size_t most);

}  // namespace headpin::base
