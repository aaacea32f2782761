#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace headpin::apps {

/// Standard input, output and error of a child: descriptors; a negative one means /dev/null.
struct ChildStreams {
  int in = -1;
  int out = -1;
  int err = -1;
};

/// Starts a program with these streams and no other open file of this process. When the thread that
/// started it ends, for any reason, the kernel sends the child a signal.
///
/// @param program  a path, or a name that is looked up in PATH
/// @param words  its arguments, with its own name as the first
/// @param end_signal  the signal that it then gets
/// @return  the process; negative with errno if it could not be started
pid_t start_child(const std::string& program, std::vector<std::string> words, ChildStreams streams,
                  int end_signal);

}  // namespace headpin::apps
