#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/output_file.h"
#include "render/image.h"

namespace headpin::render {

/// The open files of a video.
struct VideoFiles {
  base::OutputFile lossless;             ///< .mkv
  std::optional<base::OutputFile> copy;  ///< .mp4
};

/// Opens FILE.mkv and, if it is wanted, FILE.mp4 beside it.
///
/// @param how  of both; they are regular files, because ffmpeg seeks in them
/// @throws std::invalid_argument  for another suffix
/// @throws as base::OutputFile
VideoFiles open_video(const std::filesystem::path& path, base::OutputFile::Options how = {},
                      bool copy = true);

/// The copy with square pixels would be larger than its encoder takes; the lossless video would not.
struct CopyTooLarge : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Writes pictures as a video, through ffmpeg.
///
/// The .mkv file is lossless (H.264 in RGB; pixel aspect and stereo mode are in the container). The
/// .mp4 file plays in any player (4:2:0, square pixels; the stereo layout is in the stream). Sound is
/// a second stream: in the .mkv file the same samples, in the .mp4 file AAC. Both files get their
/// names in close().
class VideoWriter {
 public:
  /// @param files         as open_video() gives them
  /// @param width         of both eyes side by side [pixels]
  /// @param pixel_aspect  width of a pixel over its height
  /// @param sound         descriptor of a WAV file, whole and as long as the video; -1 for none. It is
  ///                      read from its start while pictures are added
  /// @throws CopyTooLarge           when the copy would be larger than its encoder takes
  /// @throws std::invalid_argument  for an impossible size or frame rate
  /// @throws std::runtime_error     when ffmpeg cannot be run
  VideoWriter(VideoFiles files, int width, int height, std::int64_t fps, double pixel_aspect,
              int sound = -1);

  /// Without close(), stops ffmpeg and removes its files.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Calls `check` repeatedly while waiting for ffmpeg; an exception ends the wait.
  void check_by(std::function<void()> check) { check_ = std::move(check); }

  /// Adds the next picture.
  ///
  /// @throws std::invalid_argument  when it is of another size
  /// @throws std::runtime_error     with ffmpeg's message, when it has stopped
  void add(const Image& image);

  /// Ends the video: waits until ffmpeg has written all.
  ///
  /// @throws std::runtime_error  with ffmpeg's message when it fails, or when no picture was added
  void finish();

  /// The same, and gives the files their names.
  void close();

 private:
  int wait();
  void fail();
  void remove_parts();

  std::string path_;  ///< of the lossless file, in messages
  std::optional<VideoFiles> files_;
  int width_, height_;
  std::int64_t pictures_ = 0;
  int socket_ = -1;    ///< to ffmpeg's standard input
  int messages_ = -1;  ///< a nameless file with ffmpeg's messages
  int process_ = -1;
  std::function<void()> check_ = [] {};
};

}  // namespace headpin::render
