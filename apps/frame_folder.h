#pragma once

#include <fstream>
#include <future>
#include <string>

#include "files/output_folder.h"
#include "scene/eye_frames.h"

namespace headpin::apps {

/// PNG files and their index, frames.csv, in a folder where they appear when all are there.
class FrameFolder : public scene::FrameSink {
 public:
  /// Without close(), leaves the folder as it was.
  /// @throws as files::OutputFolder
  FrameFolder(const std::string& folder, double pixel_aspect,
              const files::OutputFolder::Options& options);

  /// Takes the frame over; the files are written while the next one is drawn.
  void add(const scene::EyeFrame& frame) override;

  void close();

 private:
  void wait();

  files::OutputFolder folder_;
  double pixel_aspect_;
  std::ofstream index_;
  std::future<void> writing_;  // last, so that it is waited for before the folder goes
};

}  // namespace headpin::apps
