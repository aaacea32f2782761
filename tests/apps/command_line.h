#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/folder.h"

/// The program as a user meets it: every command run for real, in a folder of its own.
namespace headpin {

namespace fs = std::filesystem;

struct Result {
  int code;
  std::string out, err;
};

class CommandLine : public testing::Test {
 protected:
  CommandLine() {
    folder_ = fresh_folder("apps");
    setenv("LSAN_OPTIONS", "print_suppressions=0", 0);  // one line is one line under sanitizers too
  }
  ~CommandLine() override { fs::remove_all(folder_); }

  /// Runs `headpin ARGUMENTS` in the folder.
  Result headpin(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" HEADPIN_PROGRAM "' " +
                                arguments + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }

  /// Starts `headpin WORDS` in the folder, with nothing to read and nobody who hears it.
  /// @param input  its standard input; none where it is negative
  pid_t started(const std::vector<std::string>& words, int input = -1) const {
    const pid_t process = fork();
    if (process != 0) return process;
    const int nothing = open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) dup2(nothing, stream);
    if (input >= 0) dup2(input, 0);
    std::vector<char*> arguments = {const_cast<char*>("headpin")};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (chdir(folder_.c_str()) == 0) execv(HEADPIN_PROGRAM, arguments.data());
    _exit(127);
  }

  nlohmann::json json(const std::string& arguments) const {
    const Result result = headpin(arguments);
    EXPECT_EQ(result.code, 0) << arguments << "\n" << result.err;
    return nlohmann::json::parse(result.out);
  }

  /// Fails with one line that says what is wrong, and leaves nothing under the output's name.
  void expect_refusal(const std::string& arguments, int code, const std::string& says) const {
    const Result result = headpin(arguments);
    EXPECT_EQ(result.code, code) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, testing::HasSubstr(says)) << arguments;
    if (code == 1) {
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    for (const auto& entry : fs::directory_iterator(folder_)) {
      EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::StartsWith("OUT")))
          << arguments;
    }
  }

  fs::path folder_;
};

inline const std::string kDemo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

}  // namespace headpin
