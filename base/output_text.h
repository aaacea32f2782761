#pragma once

#include <array>
#include <filesystem>
#include <ostream>
#include <streambuf>

#include "base/output_file.h"

namespace headpin::base {

/// Text that is written through a stream into a file of an OutputFolder.
///
/// A failed write throws at once, with the reason, instead of setting a state that may not be
/// checked.
class OutputText : private std::streambuf {
 public:
  /// @param path  as OutputFolder::file() gives it
  explicit OutputText(const std::filesystem::path& path);

  std::ostream& out() { return out_; }
  template <typename T>
  std::ostream& operator<<(const T& value) {
    return out_ << value;
  }

  /// Completes the file and gives it its name in the folder.
  void close();

 private:
  int_type overflow(int_type character) override;
  int sync() override;

  OutputFile file_;
  std::array<char, 1 << 16> buffer_{};
  std::ostream out_;
};

}  // namespace headpin::base
