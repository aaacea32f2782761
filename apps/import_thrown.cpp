#include "apps/import_thrown.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "apps/command.h"
#include "devices/recordings/marker_file.h"
#include "devices/recordings/text_encoding.h"
#include "scene/people/throw_checks.h"
#include "scene/people/throw_readings.h"

namespace headpin::apps {
namespace {

scene::Side side_of(const ImportOptions& options, const devices::MotionRecording& recording,
                    const scene::Hand& hand) {
  if (options.hand == "auto" || options.hand == "none")
    return scene::throwing_side(recording, hand);
  return options.hand == "left" ? scene::Side::left : scene::Side::right;
}

/// Grab and release from the file of --events, for both hands.
void take_events(const ImportOptions& options, devices::MotionRecording& recording) {
  if (options.no_trigger) recording.triggers = {};
  if (options.events.empty()) return;
  const std::string text = devices::read_as_utf8(options.events, 100'000'000);
  std::vector<Stamped<bool>> markers;
  // Whether some grab and release are inside the recording, as far apart as those of a throw.
  const auto fits = [&] {
    for (std::size_t i = 1; i < markers.size(); i += 2) {
      const Time grab = markers[i - 1].time, release = markers[i].time;
      if (grab >= Time{} && release <= recording.times.back() && release - grab >= Time{100'000}) {
        return true;
      }
    }
    return false;
  };
  // A recording whose times are of day, too, may go on over midnight; others begin at 0 or have a date.
  constexpr Time kTwoDays{172'800'000'000};
  std::optional<Time> near;
  if (recording.start < kTwoDays) near = recording.start + recording.times.back() / 2;
  // In the unit of the recording, or in seconds.
  for (const double unit_s : {recording.reading.time_unit_s, 1.0}) {
    markers = devices::parse_markers(text, options.events, unit_s, near);
    for (Stamped<bool>& marker : markers) marker.time -= recording.start;
    if (fits()) break;
  }
  if (!fits()) {
    throw std::invalid_argument(
        fmt::format("{}: expected times of grab and release between {:.3f} and {:.3f} s, as the "
                    "recording has; found {:.3f} to {:.3f} s",
                    options.events, nearest_seconds(recording.start),
                    nearest_seconds(recording.start + recording.times.back()),
                    nearest_seconds(recording.start + markers.front().time),
                    nearest_seconds(recording.start + markers.back().time)));
  }
  recording.triggers = {markers, markers};
}

}  // namespace

devices::MotionRecording recording_in(const ImportOptions& options, const scene::Hand& hand) {
  return scene::in_likely_units(read_declared(options.file, declared(options)), hand,
                                options.hand == "none");
}

Thrown thrown_in(devices::MotionRecording recording, const ImportOptions& options,
                 const scene::Hand& hand) {
  Thrown thrown;
  thrown.notes = recording.notes;
  take_events(options, recording);
  thrown.side = side_of(options, recording, hand);
  std::vector<devices::MotionRecording> throws = scene::split_throws(recording, thrown.side);
  thrown.throws = throws.size();
  if (options.which) {
    const auto wanted = static_cast<std::size_t>(*options.which);
    if (wanted > throws.size()) {
      throw UsageError(fmt::format("{}: --throw {}: expected 1 to {}, the number of its throws",
                                   options.file, wanted, throws.size()));
    }
    recording = std::move(throws[wanted - 1]);
    thrown.side = side_of(options, recording, hand);
  }
  thrown.recording = scene::looking_along(std::move(recording), hand, thrown.side);
  return thrown;
}

std::string name_of(const ImportOptions& options, const Thrown& thrown) {
  if (!options.which) return options.file;
  return fmt::format("{}, throw {} (0 s is {:.3f} s in the file)", options.file, *options.which,
                     nearest_seconds(thrown.recording.start));
}

std::optional<Refusal> refusal(const ImportOptions& options, const Thrown& thrown,
                               const scene::Hand& hand) {
  try {
    scene::require_throw(thrown.recording, hand, name_of(options, thrown), thrown.side);
    return {};
  } catch (const scene::NoThrow& error) {
    Refusal refused{.why = error.what()};
    refused.gap = refused.why.find("no samples for") != std::string::npos;
    if (refused.gap && !options.which) {
      refused.why += fmt::format(
          "; --throw N takes one of its throws ({}), without what is beyond a gap around it",
          thrown.throws);
    } else if (error.would_be) {
      refused.remedy = options_between(thrown.recording.reading, *error.would_be);
    }
    return refused;
  }
}

}  // namespace headpin::apps
