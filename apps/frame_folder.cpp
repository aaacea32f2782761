#include "apps/frame_folder.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::apps {

namespace {

constexpr std::array<const char*, 2> kEyes = {"left", "right"};
constexpr const char* kIndex = "frames.csv";

}  // namespace

FrameFolder::FrameFolder(const std::string& folder, double pixel_aspect,
                         const files::OutputFolder::Options& options)
    : folder_(folder, options), pixel_aspect_(pixel_aspect), index_(folder_.part() / kIndex) {
  index_ << "frame,time_s,tick";
  for (const char* eye : kEyes) {
    for (const char* name : {"x", "y", "z", "qw", "qx", "qy", "qz"})
      index_ << ',' << eye << '_' << name;
    index_ << ',' << eye << "_hash";
  }
  index_ << '\n';
}

void FrameFolder::add(const scene::EyeFrame& frame) {
  index_ << fmt::format("{},{:.6f},{}", frame.number, seconds(frame.time), frame.tick);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Pose& X_WE = frame.views[eye].X_WE;
    index_ << fmt::format(",{},{},{},{},{},{},{},{:016x}", X_WE.p.x(), X_WE.p.y(), X_WE.p.z(),
                          X_WE.q.w(), X_WE.q.x(), X_WE.q.y(), X_WE.q.z(),
                          render::pixel_hash(frame.images[eye]));
  }
  index_ << '\n';
  wait();
  writing_ = std::async(std::launch::async, [this, number = frame.number, images = frame.images] {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      render::write_png(folder_.part() / fmt::format("{}_{:06}.png", kEyes[eye], number),
                        images[eye], pixel_aspect_);
    }
  });
}

void FrameFolder::close() {
  wait();
  index_.close();
  if (!index_) throw std::runtime_error((folder_.part() / kIndex).string() + ": cannot be written");
  folder_.commit(kIndex);
}

void FrameFolder::wait() {
  if (writing_.valid()) writing_.get();
}

}  // namespace headpin::apps
