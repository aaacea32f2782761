#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <future>
#include <string>

#include "engine/math.h"
#include "files/output_folder.h"
#include "render/eyes.h"
#include "render/image.h"

namespace headpin::apps {

/// One rendered frame of both eyes, left and right.
struct Frame {
  std::int64_t number = 0, tick = 0;
  Time time{};
  std::array<render::View, 2> views;
  std::array<render::Image, 2> images;
};

/// PNG files and their index, frames.csv, in a folder where they appear when all are there.
class FrameFolder {
 public:
  /// Without close(), leaves the folder as it was.
  /// @throws as files::OutputFolder
  FrameFolder(const std::string& folder, double pixel_aspect,
              const files::OutputFolder::Options& options);

  /// Takes the frame over; the files are written while the next one is drawn.
  void add(const Frame& frame);

  void close();

 private:
  void wait();

  files::OutputFolder folder_;
  double pixel_aspect_;
  std::ofstream index_;
  std::future<void> writing_;  // last, so that it is waited for before the folder goes
};

}  // namespace headpin::apps
