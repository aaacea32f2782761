#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/camera_sinks.h"
#include "apps/frame_folder.h"
#include "apps/frame_sinks.h"
#include "apps/sound_track.h"
#include "devices/base/sources.h"

/// The options of `headpin frames`, and its outputs.
namespace headpin::apps {

struct FramesOptions {
  std::string trial, frames, gl;
  std::optional<std::string> folder, video, y4m, sound, cameras, colmap, look;
  std::optional<int> samples;
  std::int64_t fps = 0;
  double longest_gap = seconds(devices::kLongestGap);
  std::string layout = "separate", view = "eyes";
  int jobs = 1;
  FrameFiles files;
  std::vector<std::string> of_pictures;  ///< the given options that pictures depend on, as words
  bool verify = false, as_shown = false, force = false, json = false, no_copy = false,
       resume = false;

  bool writes_pictures() const { return folder || video || y4m; }
  bool writes_cameras() const { return cameras || colmap; }
  bool writes() const { return writes_pictures() || writes_cameras() || sound; }
  bool in_parts() const { return jobs > 1 || resume; }
};

/// How pictures follow each other in a video.
Timing timing_of(const FramesOptions& options, std::int64_t fps);

/// The folder of the pictures, in which no other output may be.
base::OutputFolder open_picture_folder(const FramesOptions& options);

/// Tells of recorded frames that `--as-shown` cannot draw.
void say_left_out(const FramesOptions& options, std::size_t wanted, std::int64_t drawn);

/// The wanted folders and files, opened before anything is drawn.
class FrameOutputs {
 public:
  /// @param views  of both eyes, at any time
  /// @param heard  the sound, for a file or a video; nothing for none
  FrameOutputs(const FramesOptions& options, const scene::Stage& stage,
               const render::Optics& optics, const std::array<render::View, 2>& views,
               std::int64_t fps, const std::optional<Heard>& heard);

  const std::vector<scene::FrameSink*>& sinks() const { return sinks_; }
  /// After the last frame, writes what is left of all.
  void finish();
  /// Then gives them their names.
  void commit();

 private:
  std::optional<base::OutputFolder> pictures_, models_;
  std::optional<FrameFolder> folder_;  ///< in pictures_
  std::optional<CamerasFile> cameras_;
  std::optional<ColmapFolder> colmap_;  ///< in models_
  std::optional<base::OutputFile> sound_;
  std::optional<SoundTrack> track_;  ///< of the video
  std::optional<VideoSink> video_;
  std::optional<Y4mSink> y4m_;
  std::vector<scene::FrameSink*> sinks_;
};

}  // namespace headpin::apps
