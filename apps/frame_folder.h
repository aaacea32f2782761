#pragma once

#include <array>
#include <cstdint>
#include <future>
#include <map>
#include <optional>
#include <string>

#include "base/output_folder.h"
#include "base/output_text.h"
#include "scene/watch/eye_frames.h"

namespace headpin::apps {

/// The files of a frame.
struct FrameFiles {
  bool side_by_side = false;  ///< both eyes in one picture
  bool depth = false;         ///< along each eye's axis: PNG of 16 bits [mm], and float32 [m]
  bool ids = false;           ///< object at each pixel's centre: PNG of 16 bits, and ids.csv
  bool flow = false;  ///< displacement of each pixel until the next frame: Middlebury's .flo
  /// This frame, the last one, is only needed for the flow to it.
  std::optional<std::int64_t> flow_to = {};

  bool labels() const { return depth || ids || flow; }
};

/// Writes PNG files and their index, frames.csv, to a folder; they get their names when all are
/// complete.
class FrameFolder : public scene::FrameSink {
 public:
  /// Without commit(), leaves the folder as it was.
  /// @param folder   must outlive this
  /// @param objects  the numbers of ids and what they are
  FrameFolder(base::OutputFolder& folder, const FrameFiles& files, double pixel_aspect,
              const std::map<std::uint32_t, std::string>& objects);

  /// Takes a frame; its files are written while the next one is drawn.
  void add(const scene::EyeFrame& frame) override;

  /// After the last frame, writes what is left.
  void finish();
  /// Then moves the files to their places.
  void commit();

 private:
  void wait();
  void write_row(const scene::EyeFrame& frame);
  void write_files(const scene::EyeFrame& frame);
  void write_flow(const scene::EyeFrame& before, const scene::EyeFrame& after);
  void write_labels(const render::Labels& labels, const std::string& stem);
  void write_names(const std::map<std::uint32_t, std::string>& objects);

  base::OutputFolder& folder_;
  FrameFiles files_;
  double pixel_aspect_;
  base::OutputText index_;
  std::optional<scene::EyeFrame> before_;  // the last frame, for the flow from it
  std::future<void> writing_;  // last member, so that it ends before the folder is destroyed
};

}  // namespace headpin::apps
