#pragma once

#include <stdexcept>
#include <string>

/// The signals that ask a command to end: SIGINT, SIGTERM and SIGHUP.
///
/// A command that has something to put away when it ends early watches for them; others are ended
/// by the system. Another signal, a second or more after the first, ends any command at once.
namespace headpin::apps {

/// A command was told to stop before it was done: exit code 128 + the signal's number.
struct Stopped : std::runtime_error {
  explicit Stopped(int number, const std::string& when = "before it was done");
  int signal;
};

/// From now on these signals are noted and do nothing else. A SIGHUP that was ignored stays
/// ignored, as nohup wants it.
void watch_stop_signals();

/// The signal that came; 0 while none has.
int stop_signal();

/// The signal was how this command ends: what fails after it does so by itself.
void heed_stop();

/// @param when  how far the command was
/// @throws Stopped  when a signal has come
void check_stop(const std::string& when = "before it was done");

}  // namespace headpin::apps
