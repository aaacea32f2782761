#include "apps/frame_sinks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "apps/stop.h"

namespace headpin::apps {

namespace {

/// The number of the picture that is nearest to a time, at a constant frame rate.
std::int64_t picture_at(Time time, std::int64_t fps) {
  constexpr std::int64_t kSecond = 1'000'000;
  return (2 * time.count() * fps + kSecond) / (2 * kSecond);
}

}  // namespace

std::int64_t PictureNumbers::next(Time time) {
  std::int64_t at = picture_at(time, timing_.fps);
  if (!start_) start_ = timing_.hold == Hold::from_time_zero ? 0 : at;
  at -= *start_;
  if (at == last_) ++at;
  last_ = std::max(at, last_);
  return last_;
}

void SequenceSink::show_until(std::int64_t picture) {
  for (; written_ < picture; ++written_) write(newest_);
}

void SequenceSink::add(const scene::EyeFrame& frame) {
  render::Image both = render::side_by_side(frame.images[0], frame.images[1]);
  if (hold_ == Hold::one_each) return write(both);
  if (!numbers_.begun()) {
    newest_ = {both.width, both.height, std::vector<std::uint8_t>(both.rgb.size(), 0)};
  }
  show_until(numbers_.next(frame.time));
  newest_ = std::move(both);
}

void SequenceSink::finish() {
  if (numbers_.begun()) show_until(numbers_.last() + 1);
  end();
}

VideoSink::VideoSink(render::VideoFiles files, const render::Optics& optics, const Timing& timing,
                     int sound)
    : SequenceSink(timing),
      writer_(std::move(files), 2 * optics.width, optics.height, timing.fps, optics.pixel_aspect(),
              sound) {
  writer_.check_by([] { check_stop(); });
}

Y4mSink::Y4mSink(base::OutputFile file, const render::Optics& optics, const Timing& timing)
    : SequenceSink(timing), file_(std::move(file)) {
  const std::string header = fmt::format(
      "YUV4MPEG2 W{} H{} F{}:1 Ip A{}:10000 C444 XCOLORRANGE=LIMITED\n", 2 * optics.width,
      optics.height, timing.fps, std::lround(10000 * optics.pixel_aspect()));
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
