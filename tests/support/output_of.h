#pragma once

#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace headpin {

/// What a shell command prints; it is to succeed.
inline std::string output_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

}  // namespace headpin
