#pragma once

#include <stdexcept>
#include <string>

/// The signals that ask a command to end: SIGINT, SIGTERM and SIGHUP.
///
/// Commands that must clean up watch for them; other commands are ended by the system. A further
/// signal, at least a second after the first, ends any command at once.
namespace headpin::apps {

/// A signal stopped a command early: exit code 128 + the signal's number.
struct Stopped : std::runtime_error {
  explicit Stopped(int number, const std::string& when = "before it was done");
  int signal;
};

/// Makes the program only record these signals. An ignored SIGHUP stays ignored, as nohup needs.
void watch_stop_signals();

/// The received signal, or 0.
int stop_signal();

/// The command accepts the signal as its normal end; later failures are its own.
void heed_stop();

/// @param when  progress of the command
/// @throws Stopped  when a signal has come
void check_stop(const std::string& when = "before it was done");

}  // namespace headpin::apps
