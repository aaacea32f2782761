// What is heard in a trial: a second stream of its video, and a file.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "devices/base/sources.h"
#include "scene/record/events.h"
#include "scene/sound/ears.h"
#include "scene/sound/modal.h"
#include "scene/watch/recorded.h"
#include "tests/apps/trial_commands.h"
#include "tests/support/output_of.h"

namespace headpin {
namespace {

using testing::HasSubstr;

constexpr double kRate = static_cast<double>(scene::kSoundRate);
constexpr std::size_t kPerFrame = scene::kSoundRate / 60;

class SoundOfTrials : public TrialCommands {
 protected:
  /// The bundled trial with sound.
  void make_loud() const {
    ASSERT_EQ(headpin("replay " + kDemo + " --set sound.on=true -o loud.lcmlog").code, 0);
  }

  /// The samples of the left ear, as ffmpeg reads them.
  std::vector<std::int16_t> left_ear(const std::string& file) const {
    const std::string raw = output_of("ffmpeg -v error -i '" + (folder_ / file).string() +
                                      "' -map 0:a -f s16le -ac 2 -");
    std::vector<std::int16_t> samples(raw.size() / 4);
    for (std::size_t i = 0; i < samples.size(); ++i)
      std::memcpy(&samples[i], raw.data() + 4 * i, 2);
    return samples;
  }

  std::string streams(const std::string& file) const {
    return output_of(
        "ffprobe -v error -show_entries stream=codec_type,codec_name -of default=nw=1 '" +
        (folder_ / file).string() + "'");
  }

  /// When the ears hear the ball strike the head pin, in samples after a frame.
  double strike_heard(std::int64_t after_frame) const {
    const scene::Recorded loud = scene::load_trial((folder_ / "loud.lcmlog").string());
    const std::vector<scene::Event>& events = loud.file.summary().events;
    const auto contact = std::ranges::find(events, scene::kind::first_contact, &scene::Event::kind);
    EXPECT_NE(contact, events.end());
    const Pose X_WD = scene::first_head_pose(loud.file, loud.scenario.rig);  // it stays near there
    const double way = scene::ways_to_ears(X_WD, contact->p_W)[0].delay;
    return kRate * seconds(contact->time - tick_time(after_frame, 60)) + way;
  }
};

std::size_t first_above(const std::vector<std::int16_t>& samples, int level) {
  const auto found =
      std::ranges::find_if(samples, [&](std::int16_t s) { return std::abs(s) > level; });
  return static_cast<std::size_t>(found - samples.begin());
}

TEST_F(SoundOfTrials, IsTheSecondStreamOfAVideoAndTheStrikeIsInTime) {
  make_loud();
  const Result drawn =
      headpin("frames loud.lcmlog --look fast --frames 298-317 --video film.mkv --sound film.wav");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_EQ(streams("film.mkv"),
            "codec_name=h264\ncodec_type=video\ncodec_name=pcm_s16le\ncodec_type=audio\n");
  EXPECT_EQ(streams("film.mp4"),
            "codec_name=h264\ncodec_type=video\ncodec_name=aac\ncodec_type=audio\n");
  const std::vector<std::int16_t> film = left_ear("film.mkv"), file = left_ear("film.wav");
  EXPECT_EQ(film.size(), 20 * kPerFrame);  // as long as 20 pictures
  EXPECT_EQ(film, file);
  // The ball's blow on the lane, 0.1 s before, has faded to a tenth of this.
  constexpr double kWithin = 0.005 * kRate;
  const double strike = strike_heard(298);
  EXPECT_NEAR(static_cast<double>(first_above(film, 500)), strike, kWithin);
  EXPECT_NEAR(static_cast<double>(first_above(left_ear("film.mp4"), 500)), strike, kWithin);
}

TEST_F(SoundOfTrials, ChangesNothingOfTheTrial) {
  make_loud();
  const nlohmann::json loud = json("replay loud.lcmlog --json"),
                       silent = json("replay " + kDemo + " --json");
  EXPECT_EQ(loud["game_hash"], silent["game_hash"]);
}

TEST_F(SoundOfTrials, IsEqualEveryTimeAndOfChosenFramesAPartOfTheWhole) {
  make_loud();
  ASSERT_EQ(headpin("frames loud.lcmlog --sound whole.wav").code, 0);
  ASSERT_EQ(headpin("frames loud.lcmlog --sound again.wav").code, 0);
  EXPECT_EQ(slurp(folder_ / "whole.wav"), slurp(folder_ / "again.wav"));
  ASSERT_EQ(headpin("frames loud.lcmlog --sound part.wav --frames 268,299-300").code, 0);
  const std::vector<std::int16_t> whole = left_ear("whole.wav"), part = left_ear("part.wav");
  ASSERT_EQ(part.size(), 3 * kPerFrame);
  const auto frame = [&](const std::vector<std::int16_t>& samples, std::size_t n) {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(n * kPerFrame);
    return std::vector<std::int16_t>(begin, begin + kPerFrame);
  };
  EXPECT_EQ(frame(part, 0), frame(whole, 268));  // the ball falls on the lane
  EXPECT_EQ(frame(part, 1), frame(whole, 299));
  EXPECT_EQ(frame(part, 2), frame(whole, 300));
  EXPECT_LT(first_above(part, 1000), kPerFrame);
}

TEST_F(SoundOfTrials, IsThereOnlyWhereTheScenarioHasIt) {
  ASSERT_EQ(headpin("frames " + kDemo + " --look fast --frames 0-2 --video film.mkv").code, 0);
  EXPECT_EQ(streams("film.mkv"), "codec_name=h264\ncodec_type=video\n");
  EXPECT_EQ(streams("film.mp4"), "codec_name=h264\ncodec_type=video\n");
  expect_refusal("frames " + kDemo + " --sound OUT.wav", 1,
                 "expected sound.on = true, found false");
  expect_refusal("frames " + kDemo + " --sound OUT.mp3", 2, "expected a name that ends in .wav");
}

TEST_F(SoundOfTrials, OfFramesAsShownIsAsLongAsTheVideo) {
  ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
  std::string room = slurp(folder_ / "out.txt");
  const std::size_t section = room.find("[sound]");
  ASSERT_NE(section, std::string::npos);
  room.replace(room.find("false", section), 5, "true");
  std::ofstream(folder_ / "room.toml") << room;
  const Result live = headpin("live --lcm 'file://" + kDemo +
                              "' --scenario room.toml --duration 1.2 --record shown.lcmlog");
  ASSERT_EQ(live.code, 0) << live.err;
  const Result drawn = headpin("frames shown.lcmlog --as-shown --video film.mkv --no-mp4");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  const std::string pictures = output_of(
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=nb_read_frames -of csv=p=0 '" +
      (folder_ / "film.mkv").string() + "'");
  EXPECT_EQ(left_ear("film.mkv").size(), std::stoul(pictures) * kPerFrame);
}

// Frames before the first pose of the head are not drawn. With --frames, the video begins with the first that is.
TEST_F(SoundOfTrials, BeginsWithTheFirstFrameThatIsDrawn) {
  make_loud();
  const scene::Trial loud = trial("loud.lcmlog");
  constexpr Time kSeen{500'000};
  scene::Recorder recorder(folder_ / "late.lcmlog", loud.header);
  scene::FrameRecord frame;
  for (const devices::Sample& sample : loud.samples) {
    const Time now = devices::available(sample);
    for (; frame.time < now; ++frame.frame, frame.time = tick_time(frame.frame, 60)) {
      frame.tick = 4 * frame.frame;
      recorder.write(frame);
    }
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    const bool of_head = tracker && tracker->station == devices::kHeadStation;
    if (!of_head || now > kSeen) recorder.write(sample);
  }
  recorder.close();
  const Result drawn =
      headpin("frames late.lcmlog --as-shown --look fast --frames 12-59 --video film.mkv --no-mp4");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr("recorded frames are not drawn"));
  const std::string pictures = output_of(
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=nb_read_frames -of csv=p=0 '" +
      (folder_ / "film.mkv").string() + "'");
  EXPECT_LT(std::stoul(pictures), 40u);  // of 48
  EXPECT_EQ(left_ear("film.mkv").size(), std::stoul(pictures) * kPerFrame);
}

}  // namespace
}  // namespace headpin
