#include "apps/sound_track.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/stop.h"
#include "base/temporary.h"
#include "scene/sound/hearing.h"

namespace headpin::apps {

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kSampleBytes = 4;  // of both ears

/// The first sample of a picture.
std::int64_t first_sample(std::int64_t picture, std::int64_t fps) {
  return picture * scene::kSoundRate / fps;
}

void append_number(Bytes& bytes, std::int64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

void append_word(Bytes& bytes, std::string_view word) {
  bytes.insert(bytes.end(), word.begin(), word.end());
}

/// The header of a WAV file (Microsoft, Multimedia programming interface, 1991).
Bytes wav_header(std::int64_t samples) {
  const std::int64_t size = samples * kSampleBytes;
  if (size > 0xffff'ffff - 36) {
    throw std::runtime_error(fmt::format("sound: {:.0f} s are longer than a WAV file can be",
                                         static_cast<double>(samples) / scene::kSoundRate));
  }
  Bytes bytes;
  append_word(bytes, "RIFF");
  append_number(bytes, size + 36, 4);
  append_word(bytes, "WAVEfmt ");
  append_number(bytes, 16, 4);
  append_number(bytes, 1, 2);  // whole numbers
  append_number(bytes, 2, 2);  // channels
  append_number(bytes, scene::kSoundRate, 4);
  append_number(bytes, scene::kSoundRate * kSampleBytes, 4);
  append_number(bytes, kSampleBytes, 2);
  append_number(bytes, 16, 2);  // bits
  append_word(bytes, "data");
  append_number(bytes, size, 4);
  return bytes;
}

/// Appends those of consecutive samples that are in a part.
///
/// @param first  number of the first sample
void append_parts(std::span<const SoundPart> parts, std::int64_t first,
                  std::span<const scene::StereoSample> samples, Bytes& bytes) {
  const std::int64_t end = first + static_cast<std::int64_t>(samples.size());
  const auto ends_before = [](const SoundPart& part, std::int64_t at) { return part.to <= at; };
  auto part = std::lower_bound(parts.begin(), parts.end(), first, ends_before);
  for (; part != parts.end() && part->from < end; ++part) {
    for (std::int64_t i = std::max(first, part->from); i < std::min(end, part->to); ++i) {
      const scene::StereoSample& both = samples[static_cast<std::size_t>(i - first)];
      for (const std::int16_t ear : both) append_number(bytes, ear, 2);
    }
  }
}

}  // namespace

std::vector<SoundPart> sound_of_frames(std::span<const std::int64_t> frames, std::int64_t fps) {
  std::vector<SoundPart> parts;
  for (const std::int64_t frame : frames) {
    const SoundPart part{first_sample(frame, fps), first_sample(frame + 1, fps)};
    if (!parts.empty() && parts.back().to == part.from) {
      parts.back().to = part.to;
    } else {
      parts.push_back(part);
    }
  }
  return parts;
}

std::vector<SoundPart> sound_as_shown(std::span<const Time> times, const Timing& timing) {
  if (times.empty()) return {};
  PictureNumbers numbers(timing);
  std::int64_t last = 0;
  for (const Time time : times) last = numbers.next(time);
  return {{first_sample(numbers.start(), timing.fps),
           first_sample(numbers.start() + last + 1, timing.fps)}};
}

std::int64_t Heard::samples() const {
  std::int64_t sum = 0;
  for (const SoundPart& part : parts) sum += part.to - part.from;
  return sum;
}

SoundTrack::SoundTrack(const Heard& heard, base::OutputFile* copy) : file_(base::nameless_file()) {
  try {
    hear(heard, copy);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

SoundTrack::~SoundTrack() {
  ::close(file_);
}

void SoundTrack::write(std::span<const std::uint8_t> bytes, base::OutputFile* copy) {
  if (copy) copy->write(bytes.data(), bytes.size());
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error(fmt::format("sound: {}", std::strerror(errno)));
    done += static_cast<std::size_t>(n);
  }
}

void SoundTrack::hear(const Heard& heard, base::OutputFile* copy) {
  const std::int64_t wanted = heard.samples() * kSampleBytes;
  write(wav_header(heard.samples()), copy);
  scene::Session session = heard.session;
  session.hashes = false;
  scene::TrialPlayer source(heard.recorded.file, {});
  scene::Hearing hearing(session,
                         scene::first_head_pose(heard.recorded.file, heard.recorded.scenario.rig));
  std::vector<scene::StereoSample> samples;
  Bytes bytes;
  std::int64_t first = 0, written = 0;
  while (session.tick < heard.ticks) {
    check_stop();
    scene::advance(session, source);
    samples.clear();
    hearing.tick(session, samples);
    bytes.clear();
    append_parts(heard.parts, first, samples, bytes);
    first += static_cast<std::int64_t>(samples.size());
    write(bytes, copy);
    written += static_cast<std::int64_t>(bytes.size());
  }
  write(Bytes(static_cast<std::size_t>(wanted - written), 0), copy);
}

}  // namespace headpin::apps
