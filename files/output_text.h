#pragma once

#include <array>
#include <filesystem>
#include <ostream>
#include <streambuf>

#include "files/output_file.h"

namespace headpin::files {

/// Text that is written through a stream into a file of an OutputFolder.
///
/// What the disk does not take is thrown where it is written, with the disk's reason, and not kept
/// as a state that nobody asks for.
class OutputText : private std::streambuf {
 public:
  /// @param path  as OutputFolder::file() gives it
  explicit OutputText(const std::filesystem::path& path);

  std::ostream& out() { return out_; }
  template <typename T>
  std::ostream& operator<<(const T& value) {
    return out_ << value;
  }

  /// Gives it its name in the folder.
  void close();

 private:
  int_type overflow(int_type character) override;
  int sync() override;

  OutputFile file_;
  std::array<char, 1 << 16> buffer_{};
  std::ostream out_;
};

}  // namespace headpin::files
