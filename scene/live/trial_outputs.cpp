#include "scene/live/trial_outputs.h"

#include <exception>

namespace headpin::scene {

void TrialOutputs::tick(const Session& session) {
  if (file_) file_->tick(session);
  if (listeners_) listeners_->tick(session);
}

void TrialOutputs::write(const FrameRecord& frame) {
  if (file_) file_->write(frame);
  if (listeners_) listeners_->write(frame);
}

void TrialOutputs::write(const Event& event) {
  if (file_) file_->write(event);
  if (listeners_) listeners_->write(event);
}

void TrialOutputs::require_kept() const {
  if (file_) file_->require_kept();
}

void TrialOutputs::close(const Session& session, const Event& last) {
  write(last);
  if (file_) file_->close(session);
  if (listeners_) listeners_->close(session);
}

void TrialOutputs::close_after_failure(const Session& session, const Event& last) noexcept {
  for (std::optional<TrialWriter>* writer : {&file_, &listeners_}) {
    try {
      if (!*writer) continue;
      (*writer)->write(last);
      (*writer)->close(session);
    } catch (const std::exception&) {  // this is the failure itself, or less important
    }
  }
}

}  // namespace headpin::scene
