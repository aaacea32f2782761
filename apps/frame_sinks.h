#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/output_file.h"
#include "render/video.h"
#include "scene/watch/eye_frames.h"

/// Destinations of drawn frames other than a folder: both eyes side by side.
namespace headpin::apps {

/// The timing of pictures.
enum class Hold {
  one_each,         ///< one after the other
  from_time_zero,   ///< from its time to the next one's; it is black before the first
  from_first_shown  ///< likewise, and the first one's time is 0
};

struct Timing {
  std::int64_t fps = 60;
  Hold hold = Hold::one_each;
};

/// A sequence of pictures at a constant frame rate.
class SequenceSink : public scene::FrameSink {
 public:
  explicit SequenceSink(const Timing& timing) : hold_(timing.hold), fps_(timing.fps) {}

  void add(const scene::EyeFrame& frame) final;
  /// After the last one.
  void close();

 private:
  void show_until(std::int64_t picture);
  virtual void write(const render::Image& both) = 0;
  virtual void end() = 0;

  Hold hold_;
  std::int64_t fps_;
  std::int64_t written_ = 0;           ///< pictures
  std::optional<std::int64_t> start_;  ///< picture that the first one is counted from
  std::int64_t at_ = 0;                ///< picture at which the newest one is shown first
  render::Image newest_;
};

/// A video (render/video.h).
class VideoSink : public SequenceSink {
 public:
  VideoSink(render::VideoFiles files, const render::Optics& optics, const Timing& timing);

 private:
  void end() override { writer_.close(); }
  void write(const render::Image& both) override { writer_.add(both); }

  render::VideoWriter writer_;
};

/// Raw video for other programs: YUV4MPEG2, 4:4:4, BT.601 limited range. Colours are rounded by up
/// to 2 of 255, so do not use it to compare pictures. The format is one header line and raw planes,
/// so it needs no library.
class Y4mSink : public SequenceSink {
 public:
  Y4mSink(base::OutputFile file, const render::Optics& optics, const Timing& timing);

 private:
  void end() override { file_.commit(); }
  void write(const render::Image& both) override;

  base::OutputFile file_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace headpin::apps
