#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/output_folder.h"
#include "tests/support/folder.h"

namespace headpin::base {

/// Folders that are written into a folder of the test's own.
class OutputFolderTest : public testing::Test {
 protected:
  /// Writes the named files, the last of which stands for the set.
  static void write(const std::string& path, const std::vector<std::string>& names,
                    OutputFolder::Options options = {}) {
    OutputFolder folder(path, options);
    for (const std::string& name : names) spit(folder.file(name), name);
    folder.commit(names.back());
  }
  /// Replaces 1.png, 2.png and index by 2.png, 3.png and index.
  void replace() const {
    OutputFolder folder(out_, force_);
    for (const char* name : {"2.png", "3.png", "index"}) spit(folder.file(name), "new");
    folder.commit("index");
  }
  std::string refused(const std::string& path, OutputFolder::Options options = {}) const {
    return complaint([&] { write(path, {"1.png", "index"}, options); });
  }
  /// All files in the test's folder and what is in them.
  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      all[std::filesystem::relative(entry.path(), folder_.path())] =
          entry.is_regular_file() ? slurp(entry.path()) : "";
    }
    return all;
  }

  TemporaryFolder folder_;
  const std::string out_ = folder_ / "out";
  const OutputFolder::Options force_{.overwrite = true, .others = {}};
};

}  // namespace headpin::base
