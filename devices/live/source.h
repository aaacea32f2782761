#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "devices/base/clocks.h"
#include "devices/base/source.h"
#include "devices/fastrak/setup.h"

/// Sources by the names that users give.
namespace headpin::devices {

/// A source for a running session, which reports its state.
class LiveSource : public Source {
 public:
  using Counts = std::vector<std::pair<std::string, std::int64_t>>;

  explicit LiveSource(std::string name) : name_(std::move(name)) {}

  /// As open_source takes it.
  const std::string& name() const { return name_; }

  /// To be called when the session's clock starts; earlier samples are discarded.
  virtual void start() {}

  /// What it is doing, as text.
  virtual std::string activity() const = 0;
  /// A message about why no samples arrive; empty if there is no problem.
  virtual std::string trouble() const { return {}; }
  /// A kind of fault in received samples, and its number.
  struct Amiss {
    std::int64_t count = 0;  ///< of messages, or of occurrences
    std::string what;        ///< for people, in a clause
  };
  /// Each kind at a fixed place in the list, also kinds that did not occur.
  virtual std::vector<Amiss> amiss() const { return {}; }

  /// Its state as text.
  virtual std::string report(Time now) const = 0;
  /// Its state for `--json`, by key.
  virtual Counts counts() const { return {}; }

  /// Whether a button of its tracker is the trigger.
  virtual bool has_stylus() const { return false; }
  /// The log that it plays; empty if it plays none.
  virtual std::string recording() const { return {}; }

 private:
  std::string name_;
};

/// Messages about faults of a source: the first of each kind at once, further ones every ten
/// seconds.
class AmissNews {
 public:
  /// @return  the new faults since the last message, as text; empty within ten seconds of it
  std::vector<std::string> take(const LiveSource& source, Time now);
  /// The same, without the limit of ten seconds.
  std::vector<std::string> take_rest(const LiveSource& source);

 private:
  std::vector<std::int64_t> said_;  ///< of each kind
  Time next_{};
};

struct SourceOptions {
  /// The session's. Without one, what arrives is stamped with the time of the poll.
  std::function<Time()> clock;
  FastrakOptions fastrak;
};

/// Opens `fastrak:LINE` (a serial port, or tcp:HOST:PORT), `lcm:URL` (none: the default one), or a
/// trial by its path, which plays from the session's start, each sample when it was available.
///
/// @param clocks  of the session, which date what devices measure; must outlive the source
/// @throws std::runtime_error  when it cannot be opened or is no trial
/// @throws std::invalid_argument  for a name that no line can have, or a wrong LCM URL
std::unique_ptr<LiveSource> open_source(const std::string& name, Clocks& clocks,
                                        const SourceOptions& options);

}  // namespace headpin::devices
