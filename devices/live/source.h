#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "devices/base/genlock.h"
#include "devices/base/source.h"
#include "devices/fastrak/setup.h"

/// Sources by their names, as users write them.
namespace headpin::devices {

/// A source that keeps pace with a running session and can say how it does.
class LiveSource : public Source {
 public:
  using Counts = std::vector<std::pair<std::string, std::int64_t>>;

  explicit LiveSource(std::string name) : name_(std::move(name)) {}

  /// As open_source takes it.
  const std::string& name() const { return name_; }

  /// The session's clock runs from now on: what waited for it says nothing.
  /// @param genlock  what a tracker's clock is held to it by; must outlive this; null: nothing
  virtual void start(Genlock* /*genlock*/ = nullptr) {}

  /// What it is doing.
  virtual std::string activity() const = 0;
  /// What keeps anything from coming, for people; empty when nothing does.
  virtual std::string trouble() const { return {}; }
  /// Something that is amiss with what came.
  struct Amiss {
    std::int64_t count = 0;  ///< of messages, or of times that it happened
    std::string what;        ///< for people, in a clause
  };
  /// Each kind in its own place, also those of which there are none.
  virtual std::vector<Amiss> amiss() const { return {}; }

  /// How it does, for people, in a clause or some.
  virtual std::string report(Time now) const = 0;
  /// The same for programs, by names of `--json`.
  virtual Counts counts() const { return {}; }

  /// Whether a button of its tracker stands for the trigger.
  virtual bool has_stylus() const { return false; }
  /// The log that it plays, empty where it plays none.
  virtual std::string recording() const { return {}; }

 private:
  std::string name_;
};

/// What is to be said of a source: each thing that is amiss at once, and more of it every ten seconds.
class AmissNews {
 public:
  /// @return  in words, what is new since it was said last; nothing before ten seconds are over
  std::vector<std::string> take(const LiveSource& source, Time now);
  /// The same, whenever that was.
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
/// @throws std::runtime_error  when it cannot be opened or is no trial
/// @throws std::invalid_argument  for a name that no line can have
std::unique_ptr<LiveSource> open_source(const std::string& name, const SourceOptions& options);

}  // namespace headpin::devices
