#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <emscripten/emscripten.h>
#include <nlohmann/json.hpp>

#include "apps/report/engine/answers.h"
#include "scene/page/page_session.h"

// The functions that the page of a game calls. Times are microseconds of the session's clock; they
// come as doubles, which hold them exactly.
namespace {

using namespace headpin;
using namespace headpin::page;

std::unique_ptr<scene::PageSession> playing;

scene::PageSession& game() {
  if (!playing) throw std::logic_error("no game has begun");
  return *playing;
}

Time time_of(double microseconds) {
  return Time{static_cast<std::int64_t>(microseconds)};
}

/// w, x, y, z, p
Pose pose_of(const double* n) {
  return {Quat(n[0], n[1], n[2], n[3]).normalized(), Vec3(n[4], n[5], n[6])};
}

double numbers_given[14];  // two poses, from the page

}  // namespace

extern "C" {

/// Where the page puts the poses of the next call.
EMSCRIPTEN_KEEPALIVE double* headpin_poses() {
  return numbers_given;
}

/// Begins a game, as the given JSON says: device, left_hand, participant, condition, seed, epoch_us,
/// scenario.
EMSCRIPTEN_KEEPALIVE bool headpin_begin() {
  return attempt([] {
    const nlohmann::json asked = nlohmann::json::parse(take_given());
    scene::PageSession::Options options;
    options.device = asked.at("device");
    options.left_hand = asked.value("left_hand", false);
    options.participant = asked.value("participant", "");
    options.condition = asked.value("condition", "");
    options.seed = asked.value("seed", std::uint64_t{0});
    options.epoch = time_of(asked.value("epoch_us", 0.0));
    playing.reset();
    playing =
        std::make_unique<scene::PageSession>(asked.at("scenario").get<std::string>(), options);
  });
}

/// Takes a pose, of the poses that the page has put in.
/// @param estimated  the browser does not track the position now
EMSCRIPTEN_KEEPALIVE bool headpin_tracker(std::int32_t station, double device_time,
                                          double host_time, bool estimated) {
  return attempt([=] {
    devices::TrackerSample sample;
    sample.device_time = time_of(device_time);
    sample.host_time = time_of(host_time);
    if (sample.device_time > sample.host_time) sample.sent_time = sample.host_time;  // predicted
    sample.position_estimated = estimated;
    sample.station = station;
    sample.X_TS = pose_of(numbers_given);
    game().take(sample);
  });
}

EMSCRIPTEN_KEEPALIVE bool headpin_buttons(double device_time, double host_time, bool left_thumb,
                                          bool right_thumb, bool trigger) {
  return attempt([=] {
    devices::MouseSample sample;
    sample.device_time = time_of(device_time);
    sample.host_time = time_of(host_time);
    sample.left_thumb = left_thumb;
    sample.right_thumb = right_thumb;
    sample.trigger = trigger;
    game().take(sample);
  });
}

/// Writes an event of the given JSON: kind, detail, value.
EMSCRIPTEN_KEEPALIVE bool headpin_note() {
  return attempt([] {
    const nlohmann::json asked = nlohmann::json::parse(take_given());
    game().note(asked.at("kind").get<std::string>(), asked.value("detail", ""),
                asked.value("value", 0.0));
  });
}

/// Writes that a frame was drawn with the eyes at the two given poses.
EMSCRIPTEN_KEEPALIVE bool headpin_frame(double time, double number) {
  return attempt([=] {
    scene::FrameRecord frame;
    frame.time = time_of(time);
    frame.frame = static_cast<std::int64_t>(number);
    frame.X_WE = {pose_of(numbers_given), pose_of(numbers_given + 7)};
    game().drew(frame);
  });
}

/// Makes all ticks up to a time; the numbers are PageSession::see, the text is the news.
/// @return  the number of ticks, or -1 after an error
EMSCRIPTEN_KEEPALIVE std::int32_t headpin_advance(double until) {
  std::int64_t ticks = -1;
  attempt([&] {
    ticks = game().advance(time_of(until));
    const nlohmann::json news = game().take_news();
    if (!news.is_null()) answer(text_of(news));
    game().see(floats());
  });
  return static_cast<std::int32_t>(ticks);
}

/// The bytes are what the player heard since the last call: 16 bits of the left and the right ear in
/// turn, 48000 times a second.
EMSCRIPTEN_KEEPALIVE bool headpin_take_sound() {
  return attempt([] {
    std::vector<std::uint8_t> bytes;
    for (const scene::StereoSample& both : game().take_sound()) {
      for (const std::int16_t ear : both) {
        bytes.push_back(static_cast<std::uint8_t>(ear & 0xff));
        bytes.push_back(static_cast<std::uint8_t>(ear >> 8 & 0xff));
      }
    }
    answer_bytes(std::move(bytes));
  });
}

/// The bytes are those of the log since the last call.
EMSCRIPTEN_KEEPALIVE bool headpin_take_log() {
  return attempt([] { answer_bytes(game().take_log()); });
}

/// Ends the game's log. The number of frames that were drawn, and of those that were late, is kept
/// in it.
EMSCRIPTEN_KEEPALIVE bool headpin_finish(std::int32_t frames, std::int32_t late_frames) {
  return attempt([=] { answer(text_of(game().finish(frames, late_frames))); });
}

}  // extern "C"
