#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/output_file.h"
#include "base/output_folder.h"
#include "base/output_text.h"
#include "render/eyes.h"
#include "scene/watch/eye_frames.h"

/// The cameras of both eyes, frame by frame, for computer vision.
namespace headpin::apps {

/// OpenCV's matrices of both eyes as JSON (docs/guides/frames.md).
class CamerasFile : public scene::FrameSink {
 public:
  /// @param views  of both eyes, at any time
  CamerasFile(base::OutputFile file, const std::array<render::View, 2>& views);

  void add(const scene::EyeFrame& frame) override;
  /// After the last frame, writes what is left.
  void finish();
  /// Then gives the file its name.
  void commit() { file_.commit(); }

 private:
  void write(const std::string& text) { file_.write(text.data(), text.size()); }

  base::OutputFile file_;
  bool first_ = true;
};

/// The model of COLMAP as text: cameras.txt, images.txt and an empty points3D.txt.
class ColmapFolder : public scene::FrameSink {
 public:
  /// @param folder  must outlive this
  /// @param views   of both eyes, at any time
  ColmapFolder(base::OutputFolder& folder, const std::array<render::View, 2>& views);

  void add(const scene::EyeFrame& frame) override;
  /// After the last frame, writes what is left.
  void finish();
  /// Then gives the files their names.
  void commit();

 private:
  base::OutputFolder& folder_;
  base::OutputText images_;
  std::int64_t written_ = 0;  ///< images
};

}  // namespace headpin::apps
