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

/// Pictures become a video, through ffmpeg.
///
/// Two files: FILE.mkv keeps every byte (H.264 in RGB, lossless; pixel aspect and stereo mode are
/// in the container), and FILE.mp4 beside it plays anywhere (4:2:0, square pixels, its two halves
/// told in the stream). Both are
/// files::OutputFile and get their names in close(), when they are whole.
class VideoWriter {
 public:
  /// @param path          the lossless file, .mkv
  /// @param width         of both eyes side by side [pixels]
  /// @param pixel_aspect  width of a pixel over its height
  /// @param force         replace what is there
  /// @param inputs        files never to be written to
  /// @param copy          with the copy
  /// @throws std::invalid_argument  for another suffix, or a size or rate that is no video
  /// @throws std::runtime_error     where the files exist, or ffmpeg cannot be run
  VideoWriter(const std::filesystem::path& path, int width, int height, std::int64_t fps,
              double pixel_aspect, bool force = false,
              const std::vector<std::filesystem::path>& inputs = {}, bool copy = true);

  /// Without close(), stops ffmpeg and removes what it has written.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Has `check` called again and again while ffmpeg is waited for: what it throws ends the wait.
  void check_by(std::function<void()> check) { check_ = std::move(check); }

  /// The next picture.
  ///
  /// @throws std::invalid_argument  when it is of another size
  /// @throws std::runtime_error     with what ffmpeg says, when it has stopped
  void add(const Image& image);

  /// Ends the video: waits for ffmpeg and gives the files their names.
  ///
  /// @throws std::runtime_error  with what ffmpeg says, when it fails or no picture was added
  void close();

  /// The viewing copy.
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
  int messages_ = -1;  ///< a nameless file with what ffmpeg says
  int process_ = -1;
  std::function<void()> check_ = [] {};
};

}  // namespace headpin::render
