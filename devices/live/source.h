#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "devices/base/clocks.h"
#include "devices/base/source.h"
#include "devices/fastrak/setup.h"

/// Sources by the names that users give.
namespace headpin::devices {

/// A kind of fault in received samples, and how often it occurred.
struct SourceFault {
  std::int64_t count = 0;  ///< of messages, or of occurrences
  std::string what;        ///< for people, in a clause
};

/// The state of a source.
struct SourceStatus {
  using Counts = std::vector<std::pair<std::string, std::int64_t>>;

  std::string activity;             ///< what it is doing
  std::string trouble;              ///< why no samples arrive; empty if there is no problem
  std::vector<SourceFault> faults;  ///< each kind at a fixed place, also kinds that did not occur
  Counts counts;                    ///< for programs, by key
  std::string line;                 ///< all of it for people, in one line
};

/// A source for a running session.
class LiveSource : public Source {
 public:
  /// To be called when the session's clock starts; earlier samples are discarded.
  virtual void start() {}
  virtual SourceStatus status(Time now) const = 0;
};

/// A source that is open, and what is known about it before it is polled.
struct OpenSource {
  std::string name;  ///< as the user gives it
  std::unique_ptr<LiveSource> source = {};
  std::string recording = {};  ///< the log that it plays; empty if it plays none
  bool has_stylus = false;     ///< whether a button of its tracker is the trigger
};

/// Messages about faults of a source: the first of each kind at once, further ones every ten
/// seconds.
class FaultNews {
 public:
  /// @return  the new faults since the last message, as text; empty within ten seconds of it
  std::vector<std::string> take(const std::vector<SourceFault>& faults, Time now);
  /// The same, without the limit of ten seconds.
  std::vector<std::string> take_rest(const std::vector<SourceFault>& faults);

 private:
  std::vector<std::int64_t> said_;  ///< of each kind
  Time next_{};
};

struct SourceOptions {
  /// The session's. Without one, what arrives is stamped with the time of the poll.
  std::function<Time()> clock;
  FastrakOptions fastrak;
};

/// Opens `fastrak:LINE` (a serial port, or tcp:HOST:PORT) or `lcm:URL` (none: the default one).
///
/// @param clocks  of the session, which date what devices measure; must outlive the source
/// @return        nothing for the name of something else
/// @throws std::runtime_error  when it cannot be opened
/// @throws std::invalid_argument  for a name that no line can have, or a wrong LCM URL
std::optional<OpenSource> open_device(const std::string& name, Clocks& clocks,
                                      const SourceOptions& options);

}  // namespace headpin::devices
