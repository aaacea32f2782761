#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "scene/play/run.h"

namespace headpin::apps {

/// A progress line on a terminal with the remaining time; it prints nothing to a pipe. It is erased
/// at the end, before other output.
class Progress {
 public:
  /// @param what   what is counted, "frames" say
  /// @param total  how many there will be
  Progress(std::string what, std::int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done);

 private:
  void erase();

  std::string what_;
  std::int64_t total_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, shown_;
};

/// The same for the ticks of a session.
class ProgressLine : public scene::Observer {
 public:
  ProgressLine(std::string what, std::int64_t total) : progress_(std::move(what), total) {}
  void tick(const scene::Session& session) override { progress_.show(session.tick); }

 private:
  Progress progress_;
};

}  // namespace headpin::apps
