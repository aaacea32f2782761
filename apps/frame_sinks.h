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

/// The pictures at which frames are shown first, where each frame lasts until the next one.
class PictureNumbers {
 public:
  explicit PictureNumbers(const Timing& timing) : timing_(timing) {}

  /// Of the next frame, counted from the first picture. If two frames are at one picture, the second
  /// is shown one later; if that is still too early, it replaces the one before.
  std::int64_t next(Time time);

  bool begun() const { return start_.has_value(); }
  /// The first picture, counted from time 0.
  std::int64_t start() const { return start_.value_or(0); }
  std::int64_t last() const { return last_; }

 private:
  Timing timing_;
  std::optional<std::int64_t> start_;
  std::int64_t last_ = -1;
};

/// A sequence of pictures at a constant frame rate.
class SequenceSink : public scene::FrameSink {
 public:
  explicit SequenceSink(const Timing& timing) : hold_(timing.hold), numbers_(timing) {}

  void add(const scene::EyeFrame& frame) final;
  /// After the last one, writes what is left.
  void finish();
  /// Then gives the files their names.
  virtual void commit() = 0;

 private:
  void show_until(std::int64_t picture);
  virtual void write(const render::Image& both) = 0;
  virtual void end() = 0;

  Hold hold_;
  PictureNumbers numbers_;
  std::int64_t written_ = 0;  ///< pictures
  render::Image newest_;
};

/// A video (render/video.h).
class VideoSink : public SequenceSink {
 public:
  /// @param sound  as VideoWriter
  VideoSink(render::VideoFiles files, const render::Optics& optics, const Timing& timing,
            int sound);

  void commit() override { writer_.close(); }

 private:
  void end() override { writer_.finish(); }
  void write(const render::Image& both) override { writer_.add(both); }

  render::VideoWriter writer_;
};

/// Raw video for other programs: YUV4MPEG2, 4:4:4, BT.601 limited range. Colours are rounded by up
/// to 2 of 255, so do not use it to compare pictures. The format is one header line and raw planes,
/// so it needs no library.
class Y4mSink : public SequenceSink {
 public:
  Y4mSink(base::OutputFile file, const render::Optics& optics, const Timing& timing);

  void commit() override { file_.commit(); }

 private:
  void end() override {}
  void write(const render::Image& both) override;

  base::OutputFile file_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace headpin::apps
