#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace headpin::apps {

/// Standard input, output and error of a child: descriptors; what is negative is /dev/null.
struct ChildStreams {
  int in = -1;
  int out = -1;
  int err = -1;
};

/// Starts a program with these streams and no other file of ours. It does not outlive the thread
/// that started it: whatever ends that one, the kernel sends the child a signal.
///
/// @param program  a path, or a name that is looked up in PATH
/// @param words  its arguments, with its own name as the first
/// @param end_signal  what it gets when we are gone
/// @return  the process; negative where none could be started, and errno says why
pid_t start_child(const std::string& program, std::vector<std::string> words, ChildStreams streams,
                  int end_signal);

}  // namespace headpin::apps
