#include "apps/frame_outputs.h"

#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/streams.h"
#include "scene/looks/looks.h"

namespace headpin::apps {

namespace {

/// A folder in which no other output may be.
base::OutputFolder::Options folder_beside(const FramesOptions& options,
                                          const std::optional<std::string>& other_folder) {
  base::OutputFolder::Options how{.overwrite = options.force, .others = {options.trial}};
  for (const auto& other :
       {options.video, options.y4m, options.sound, options.cameras, other_folder}) {
    if (other && *other != "-") how.others.emplace_back(*other);
  }
  return how;
}

}  // namespace

void say_left_out(const FramesOptions& options, std::size_t wanted, std::int64_t drawn) {
  const std::int64_t left_out = static_cast<std::int64_t>(wanted) - drawn;
  if (!options.as_shown || left_out <= 0) return;
  say("headpin frames: {}: {} of {} recorded frames are not drawn: the replay has no pose of the "
      "head at their ticks\n",
      printable(options.trial), left_out, wanted);
}

base::OutputFolder open_picture_folder(const FramesOptions& options) {
  return {*options.folder, folder_beside(options, options.colmap)};
}

Timing timing_of(const FramesOptions& options, std::int64_t fps) {
  return {.fps = fps,
          .hold = !options.as_shown        ? Hold::one_each
                  : options.frames.empty() ? Hold::from_time_zero
                                           : Hold::from_first_shown};
}

FrameOutputs::FrameOutputs(const FramesOptions& options, const scene::Stage& stage,
                           const render::Optics& optics, const std::array<render::View, 2>& views,
                           std::int64_t fps, const std::optional<Heard>& heard) {
  const base::OutputFile::Options file{.overwrite = options.force, .inputs = {options.trial}};
  const Timing timing = timing_of(options, fps);
  if (options.folder) {
    FrameFiles files = options.files;
    files.side_by_side = options.layout == "side-by-side";
    pictures_.emplace(*options.folder, folder_beside(options, options.colmap));
    sinks_.push_back(
        &folder_.emplace(*pictures_, files, optics.pixel_aspect(), scene::object_names(stage)));
  }
  if (options.cameras) {
    sinks_.push_back(&cameras_.emplace(base::OutputFile(*options.cameras, file), views));
  }
  if (options.colmap) {
    models_.emplace(*options.colmap, folder_beside(options, options.folder));
    sinks_.push_back(&colmap_.emplace(*models_, views));
  }
  std::optional<base::OutputFile> raw;
  std::optional<render::VideoFiles> video;
  if (options.sound) sound_.emplace(*options.sound, file);
  if (options.video) video.emplace(render::open_video(*options.video, file, !options.no_copy));
  if (options.y4m) {
    base::OutputFile::Options stream = file;
    stream.standard_output = true;
    raw.emplace(*options.y4m, stream);
  }
  if (heard) track_.emplace(*heard, sound_ ? &*sound_ : nullptr);  // all files are open by now
  if (video) {
    const int sound = track_ ? track_->descriptor() : -1;
    try {
      sinks_.push_back(&video_.emplace(std::move(*video), optics, timing, sound));
    } catch (const render::CopyTooLarge& error) {
      throw UsageError(fmt::format("{}; --no-mp4 leaves it out", error.what()));
    }
  }
  if (raw) sinks_.push_back(&y4m_.emplace(std::move(*raw), optics, timing));
}

void FrameOutputs::finish() {
  if (y4m_) y4m_->finish();
  if (video_) video_->finish();
  if (cameras_) cameras_->finish();
  if (colmap_) colmap_->finish();
  if (folder_) folder_->finish();
}

void FrameOutputs::commit() {
  if (colmap_) colmap_->commit();
  if (folder_) folder_->commit();
  if (y4m_) y4m_->commit();
  if (video_) video_->commit();
  if (sound_) sound_->commit();
  if (cameras_) cameras_->commit();
}

}  // namespace headpin::apps
