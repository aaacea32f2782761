#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin {

/// A picture's bytes as ffmpeg reads them.
inline std::string decoded(const std::filesystem::path& file, const std::string& format) {
  const std::filesystem::path raw = file.parent_path() / "decoded.raw";
  const std::string command = "ffmpeg -v error -y -i '" + file.string() +
                              "' -f rawvideo -pix_fmt " + format + " '" + raw.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::string bytes = slurp(raw);
  std::filesystem::remove(raw);
  return bytes;
}

}  // namespace headpin
