#pragma once

#include <memory>
#include <optional>

#include "scene/record/sink.h"
#include "scene/watch/trial_writer.h"

namespace headpin::scene {

/// Where the trial of a live session goes: to a file and to listeners, one of them, or nowhere.
class TrialOutputs : public Observer {
 public:
  /// @param sink  with a header from header_of()
  void record(std::unique_ptr<TrialSink> sink) { file_.emplace(std::move(sink)); }
  void publish(std::unique_ptr<TrialSink> sink) { listeners_.emplace(std::move(sink)); }

  void tick(const Session& session) override;

  /// Writes what belongs to no tick.
  void write(const FrameRecord& frame);
  void write(const Event& event);

  /// @throws std::runtime_error  when the file was changed or removed by others
  void require_kept() const;

  /// Ends the trial after its last tick.
  /// @param last  an event to write before
  /// @throws std::runtime_error  as TrialWriter::close
  void close(const Session& session, const Event& last);

  /// Ends it as far as possible after a failure, which may be one of these outputs.
  void close_after_failure(const Session& session, const Event& last) noexcept;

 private:
  std::optional<TrialWriter> file_, listeners_;
};

}  // namespace headpin::scene
