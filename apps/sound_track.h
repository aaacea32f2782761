#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "apps/frame_sinks.h"
#include "base/output_file.h"
#include "scene/play/session.h"
#include "scene/watch/recorded.h"

/// The sound of a trial, as long as a sequence of pictures.
namespace headpin::apps {

/// A part of the sound of a trial [samples].
struct SoundPart {
  std::int64_t from = 0, to = 0;  ///< without `to` itself
};

/// The parts that belong to frames which are shown one after the other: of each frame until the next
/// one is due.
///
/// @param frames  in their order
std::vector<SoundPart> sound_of_frames(std::span<const std::int64_t> frames, std::int64_t fps);

/// The part that belongs to frames which are shown as they were in a live session.
///
/// @param times  of the frames that are drawn, in their order
std::vector<SoundPart> sound_as_shown(std::span<const Time> times, const Timing& timing);

/// What is heard.
struct Heard {
  const scene::Recorded& recorded;
  const scene::Session& session;  ///< at its start
  std::int64_t ticks = 0;
  std::vector<SoundPart> parts;

  std::int64_t samples() const;
};

/// The sound as a WAV file without a name: 48 kHz, 16 bits, two ears.
class SoundTrack {
 public:
  /// Runs the session and writes what the participant hears; it is silent after the last tick.
  ///
  /// @param copy  gets the same bytes; null for none
  /// @throws std::runtime_error  when it is longer than a WAV file can be, when the disk fails, and
  ///                             as the session
  SoundTrack(const Heard& heard, base::OutputFile* copy);
  ~SoundTrack();
  SoundTrack(const SoundTrack&) = delete;
  SoundTrack& operator=(const SoundTrack&) = delete;

  int descriptor() const { return file_; }

 private:
  void write(std::span<const std::uint8_t> bytes, base::OutputFile* copy);
  void hear(const Heard& heard, base::OutputFile* copy);

  int file_;
};

}  // namespace headpin::apps
