#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/output_file.h"
#include "render/video.h"
#include "scene/eye_frames.h"

/// Where drawn frames go beside a folder: both eyes side by side, one after the other.
namespace headpin::apps {

/// A sequence of pictures at a steady rate.
class SequenceSink : public scene::FrameSink {
 public:
  /// @param hold  a picture stays until the number of the next one: what was left out took its time
  explicit SequenceSink(bool hold) : hold_(hold) {}

  void add(const scene::EyeFrame& frame) final;
  virtual void close() = 0;

 private:
  virtual void write(const render::Image& both) = 0;

  bool hold_;
  std::int64_t number_ = 0;
  render::Image last_;
};

struct VideoOptions {
  std::string path;
  std::int64_t fps = 60;
  bool force = false, hold = false, copy = true;
  std::vector<std::filesystem::path> inputs = {};
};

/// A video (render/video.h).
class VideoSink : public SequenceSink {
 public:
  VideoSink(const VideoOptions& options, const render::Optics& optics);
  void close() override { writer_.close(); }

 private:
  void write(const render::Image& both) override { writer_.add(both); }

  render::VideoWriter writer_;
};

/// Raw video that other programs read from a pipe: YUV4MPEG2, 4:4:4, BT.601 in its limited range.
/// Colours are rounded, by 2 of 255 at most: not for comparing.
class Y4mSink : public SequenceSink {
 public:
  /// @param options  its path may be `-`, standard output
  Y4mSink(const VideoOptions& options, const render::Optics& optics);
  void close() override { file_.commit(); }

 private:
  void write(const render::Image& both) override;

  files::OutputFile file_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace headpin::apps
