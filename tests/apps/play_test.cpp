#include <fstream>

#include "scene/page/page_session.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

/// The page is made elsewhere (apps/report); here stands what a scenario is put into.
class Play : public CommandLine {
 protected:
  Play() { std::ofstream(folder_ / "page.html") << "<html><!--headpin:data--></html>"; }
};

TEST_F(Play, WritesAPageOfAnyScenario) {
  const nlohmann::json made = json("play --json paper-experiment -o play.html --page page.html");
  EXPECT_EQ(made["scenario"], "paper-experiment");
  EXPECT_EQ(made["bytes"], fs::file_size(folder_ / "play.html"));
  const std::string page = slurp(folder_ / "play.html");
  EXPECT_THAT(page, HasSubstr("data-block=\"play\""));
  EXPECT_THAT(page, HasSubstr("data-block=\"play-numbers\""));
  EXPECT_LT(page.size(), 200'000u);  // beside the page itself
  ASSERT_EQ(headpin("play paper-experiment -o - --page page.html").out, page);
  ASSERT_NE(headpin("play paper-experiment --set ball.mass=5 -o - --page page.html").out, page);
}

/// The log of a page in which nobody did anything for a second.
/// @param frames_each  how many frames are drawn at each sample of the head
std::vector<std::uint8_t> log_of_a_page(std::string played_with = R"({"device":"mouse"})",
                                        std::int64_t frames_each = 1) {
  scene::PageSession::Options options;
  options.device = "mouse";
  scene::PageSession session(to_toml(scene::Scenario{}), options);
  session.note("played_with", std::move(played_with), 0.0);
  for (std::int64_t frame = 0; frame <= 60; ++frame) {
    devices::TrackerSample head;
    head.station = 1;
    head.device_time = head.host_time = Time{frame * 1'000'000 / 60};
    head.X_TS.p = Vec3(0.0, 1.7, 0.0);
    session.take(head);
    session.advance(head.device_time);
    for (std::int64_t i = 0; i < frames_each; ++i) {
      scene::FrameRecord drawn;
      drawn.time = head.device_time;
      drawn.frame = frames_each * frame + i;
      session.drew(drawn);
    }
  }
  session.finish(61 * frames_each, 0);
  return session.take_log();
}

TEST_F(Play, ItsTrialIsOneForEveryCommand) {
  const std::vector<std::uint8_t> log = log_of_a_page();
  std::ofstream(folder_ / "played.lcmlog", std::ios::binary)
      .write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  EXPECT_EQ(json("replay played.lcmlog --verify --json")["verified_ticks"], 240);
  EXPECT_EQ(headpin("report played.lcmlog -o trial.html --page page.html").code, 0);
  EXPECT_EQ(headpin("export played.lcmlog -o tables").code, 0);
  EXPECT_EQ(headpin("compare played.lcmlog played.lcmlog").code, 0);
  EXPECT_EQ(headpin("frames played.lcmlog --frames 0-1 -o eyes").code, 0);
  // The browser's pictures cannot be compared with ours.
  expect_refusal("frames played.lcmlog --verify", 1, "a browser drew them");
  const Result shown = headpin("frames played.lcmlog --as-shown --frames 1-2 -o shown");
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_THAT(shown.err, HasSubstr("a browser drew them"));
}

// A browser may draw more frames a second than there are ticks. At tick 0 no pose of the head is known.
TEST_F(Play, AllItsFramesAreDrawnAsShownAndThoseThatCannotBeAreTold) {
  const std::vector<std::uint8_t> log = log_of_a_page(R"({"device":"mouse"})", 2);
  std::ofstream(folder_ / "played.lcmlog", std::ios::binary)
      .write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  for (const std::string jobs : {"1", "2"}) {
    const std::string out = "shown" + jobs;
    const Result shown = headpin("frames played.lcmlog --as-shown --frames 0-5 --samples 1 -o " +
                                 out + " --jobs " + jobs);
    EXPECT_EQ(shown.code, 0) << shown.err;
    EXPECT_THAT(shown.err, HasSubstr("2 of 6 recorded frames are not drawn"));
    EXPECT_THAT(shown.out, HasSubstr("4 frames of two eyes"));
    for (const char* frame : {"2", "3", "4", "5"}) {
      EXPECT_TRUE(fs::exists(folder_ / out / (std::string("left_00000") + frame + ".png")))
          << frame;
    }
    EXPECT_EQ(std::ranges::count(slurp(folder_ / out / "frames.csv"), '\n'), 5);
  }
  EXPECT_THAT(headpin("frames played.lcmlog --as-shown --frames 3 --samples 1 -o one").err,
              Not(HasSubstr("not drawn")));
  EXPECT_TRUE(fs::exists(folder_ / "one/left_000003.png"));
}

TEST_F(Play, IsDrawnThroughTheHeadsetsOwnViews) {
  const std::vector<std::uint8_t> log = log_of_a_page(
      R"({"device":"generic-webxr","views":[
      {"eye":"left","offset":[-0.03,0,0],"left":-50,"right":40,"down":-45,"up":45,"width":200,"height":180},
      {"eye":"right","offset":[0.03,0,0],"left":-40,"right":50,"down":-45,"up":45,"width":200,"height":180}]})");
  std::ofstream(folder_ / "worn.lcmlog", std::ios::binary)
      .write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  ASSERT_EQ(
      headpin("replay worn.lcmlog --set hmd.profile=recorded --set hmd.height=150 -o own.lcmlog")
          .code,
      0);
  const nlohmann::json drawn =
      json("frames own.lcmlog --frames 1 -o eyes --cameras eyes.json --json");
  EXPECT_EQ(drawn["width"], 200);
  EXPECT_EQ(drawn["height"], 150);
  const std::string page_of_a_mouse =
      "replay mouse.lcmlog --set hmd.profile=recorded -o OUT.lcmlog";
  const std::vector<std::uint8_t> mouse = log_of_a_page();
  std::ofstream(folder_ / "mouse.lcmlog", std::ios::binary)
      .write(reinterpret_cast<const char*>(mouse.data()),
             static_cast<std::streamsize>(mouse.size()));
  expect_refusal(page_of_a_mouse, 2, "no event played_with with the views of two eyes");
}

TEST_F(Play, RefusesInWords) {
  ASSERT_EQ(headpin("play -o play.html --page page.html").code, 0);
  expect_refusal("play -o play.html --page page.html", 1, "--force");
  expect_refusal("play no-such-room -o OUT.html --page page.html", 1, "no-such-room");
  expect_refusal("play -o OUT.html --page other.html", 1, "other.html");
  expect_refusal("play -o OUT.html --set ball.mass=-1 --page page.html", 2, "ball.mass");
  expect_refusal("play -o OUT.txt --page page.html", 2, ".html");
}

}  // namespace
}  // namespace headpin
