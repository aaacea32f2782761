#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace headpin::apps {

/// One line on a terminal that says how far a long job is and when it will end; silent in a pipe.
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
  std::string what_;
  std::int64_t total_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, shown_;
};

}  // namespace headpin::apps
