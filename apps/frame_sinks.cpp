#include "apps/frame_sinks.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace headpin::apps {

void SequenceSink::add(const scene::EyeFrame& frame) {
  if (hold_ && !last_.rgb.empty()) {
    for (std::int64_t i = number_ + 1; i < frame.number; ++i) write(last_);
  }
  last_ = render::side_by_side(frame.images[0], frame.images[1]);
  number_ = frame.number;
  write(last_);
}

VideoSink::VideoSink(const VideoOptions& options, const render::Optics& optics)
    : SequenceSink(options.hold),
      writer_(options.path, 2 * optics.width, optics.height, options.fps, optics.pixel_aspect(),
              options.force, options.inputs, options.copy) {}

Y4mSink::Y4mSink(const VideoOptions& options, const render::Optics& optics)
    : SequenceSink(options.hold),
      file_(options.path,
            {.overwrite = options.force, .standard_output = true, .inputs = options.inputs}) {
  const std::string header = fmt::format(
      "YUV4MPEG2 W{} H{} F{}:1 Ip A{}:10000 C444 XCOLORRANGE=LIMITED\n", 2 * optics.width,
      optics.height, options.fps, std::lround(10000 * optics.pixel_aspect()));
  file_.write(header.data(), header.size());
}

void Y4mSink::write(const render::Image& both) {
  const std::size_t count = both.rgb.size() / 3;
  constexpr std::string_view kFrame = "FRAME\n";
  bytes_.assign(kFrame.begin(), kFrame.end());
  bytes_.resize(kFrame.size() + 3 * count);
  std::uint8_t* y = bytes_.data() + kFrame.size();
  const auto code = [](double offset, double value) {
    return static_cast<std::uint8_t>(std::lround(offset + value));
  };
  for (std::size_t i = 0; i < count; ++i) {  // ITU-R BT.601
    const double r = both.rgb[3 * i] / 255.0, g = both.rgb[3 * i + 1] / 255.0,
                 b = both.rgb[3 * i + 2] / 255.0;
    const double luma = 0.299 * r + 0.587 * g + 0.114 * b;
    y[i] = code(16.0, 219.0 * luma);
    y[count + i] = code(128.0, 224.0 * (b - luma) / 1.772);
    y[2 * count + i] = code(128.0, 224.0 * (r - luma) / 1.402);
  }
  file_.write(bytes_.data(), bytes_.size());
}

}  // namespace headpin::apps
