#pragma once

#include <cstdint>
#include <string>

namespace headpin::devices {

inline constexpr std::size_t kFastrakLongestLine = 254;  // bytes

/// What a byte from the host completes.
struct FastrakHeard {
  enum class Kind {
    nothing,
    control,    ///< a control character, which acts at once
    immediate,  ///< a command of one letter
    line,       ///< a line command; more than kFastrakLongestLine bytes for one that is too long
    unknown     ///< no command: a letter; empty for a line without one
  };
  Kind kind = Kind::nothing;
  std::string text;  ///< of the command, without the end of its line
};

/// Makes commands of the bytes that a unit receives.
class FastrakHearing {
 public:
  FastrakHeard hear(std::uint8_t byte);

 private:
  FastrakHeard control(char c);
  FastrakHeard end_of_line(char c);

  std::string line_;  ///< command letter and what followed, up to now
  /// What follows a command and ends nothing more.
  enum class Swallow { nothing, any_end, line_feed, carriage_return } swallow_ = Swallow::nothing;
};

}  // namespace headpin::devices
