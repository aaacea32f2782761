#include "apps/frame_outputs.h"

#include <initializer_list>

namespace headpin::apps {

namespace {

/// A folder in which no other output may be.
files::OutputFolder::Options folder_beside(const FramesOptions& options,
                                           const std::optional<std::string>& other_folder) {
  files::OutputFolder::Options how{.overwrite = options.force, .others = {options.trial}};
  for (const auto& other : {options.video, options.y4m, options.cameras, other_folder}) {
    if (other && *other != "-") how.others.emplace_back(*other);
  }
  return how;
}

}  // namespace

files::OutputFolder::Options picture_folder_options(const FramesOptions& options) {
  return folder_beside(options, options.colmap);
}

FrameOutputs::FrameOutputs(const FramesOptions& options, const render::Optics& optics,
                           const std::array<render::View, 2>& views, std::int64_t fps) {
  if (options.folder) {
    FrameFiles files = options.files;
    files.side_by_side = options.layout == "side-by-side";
    sinks_.push_back(&folder_.emplace(*options.folder, files, optics.pixel_aspect(),
                                      picture_folder_options(options)));
  }
  if (options.cameras) {
    const files::OutputFile::Options how{.overwrite = options.force, .inputs = {options.trial}};
    sinks_.push_back(&cameras_.emplace(*options.cameras, views, how));
  }
  if (options.colmap) {
    sinks_.push_back(
        &colmap_.emplace(*options.colmap, views, folder_beside(options, options.folder)));
  }
  VideoOptions how{.path = options.video.value_or(""),
                   .fps = fps,
                   .force = options.force,
                   .hold = !options.as_shown        ? Hold::one_each
                           : options.frames.empty() ? Hold::from_time_zero
                                                    : Hold::from_first_shown,
                   .copy = !options.no_copy,
                   .inputs = {options.trial}};
  if (options.video) sinks_.push_back(&video_.emplace(how, optics));
  how.path = options.y4m.value_or("");
  if (options.y4m) sinks_.push_back(&y4m_.emplace(how, optics));
}

void FrameOutputs::close() {
  if (y4m_) y4m_->close();
  if (video_) video_->close();
  if (cameras_) cameras_->close();
  if (colmap_) colmap_->close();
  if (folder_) folder_->close();
}

}  // namespace headpin::apps
