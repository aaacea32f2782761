#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "base/output_file.h"
#include "tests/support/folder.h"

namespace headpin::base {

/// Files that are written into a folder of the test's own.
class OutputFileTest : public testing::Test {
 protected:
  static void write(const std::filesystem::path& path, const std::string& text,
                    OutputFile::Options options) {
    OutputFile file(path, options);
    file.write(text.data(), text.size());
    file.commit();
  }
  std::string refused(const std::filesystem::path& path, OutputFile::Options options = {}) const {
    return complaint([&] { write(path, "new", options); });
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path()),
                      std::filesystem::directory_iterator()));
  }

  TemporaryFolder folder_;
  const OutputFile::Options force_{.overwrite = true};
};

}  // namespace headpin::base
