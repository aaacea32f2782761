#pragma once

#include <cstdlib>
#include <string>

#include "scene/record/log.h"
#include "tests/apps/command_line.h"

namespace headpin {

/// The commands that make, replay and tell of trials.
class TrialCommands : public CommandLine {
 protected:
  /// Runs a line of shell in the folder, with $headpin the program.
  Result shell(const std::string& line) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && headpin='" HEADPIN_PROGRAM "' && { " + line +
                                "; } >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }

  scene::Trial trial(const std::string& name) const { return scene::read_trial(folder_ / name); }
};

}  // namespace headpin
