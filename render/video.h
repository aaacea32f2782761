#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "files/output_file.h"
#include "render/image.h"

namespace headpin::render {

/// Writes pictures as a video, through ffmpeg.
///
/// Writes two files: FILE.mkv is lossless (H.264 in RGB; pixel aspect and stereo mode are in the
/// container). FILE.mp4 plays in any player (4:2:0, square pixels; the stereo layout is in the
/// stream). Both are files::OutputFile and get their names in close().
class VideoWriter {
 public:
  /// @param path          the lossless file, .mkv
  /// @param width         of both eyes side by side [pixels]
  /// @param pixel_aspect  width of a pixel over its height
  /// @param force         replace existing files
  /// @param inputs        files never to be written to
  /// @param copy          write the .mp4 copy
  /// @throws std::invalid_argument  for another suffix, or an impossible size or frame rate
  /// @throws std::runtime_error     when the files exist, or ffmpeg cannot be run
  VideoWriter(const std::filesystem::path& path, int width, int height, std::int64_t fps,
              double pixel_aspect, bool force = false,
              const std::vector<std::filesystem::path>& inputs = {}, bool copy = true);

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

  /// Ends the video: waits for ffmpeg and gives the files their names.
  ///
  /// @throws std::runtime_error  with ffmpeg's message when it fails, or when no picture was added
  void close();

  /// The path of the copy.
  const std::filesystem::path& copy() const { return copy_; }

 private:
  int wait();
  void fail();
  void remove_parts();

  std::filesystem::path path_, copy_;
  std::unique_ptr<files::OutputFile> path_file_, copy_file_;
  int width_, height_;
  std::int64_t pictures_ = 0;
  int socket_ = -1;    ///< to ffmpeg's standard input
  int messages_ = -1;  ///< a nameless file with ffmpeg's messages
  int process_ = -1;
  std::function<void()> check_ = [] {};
};

}  // namespace headpin::render
