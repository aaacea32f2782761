// What an event says: a value in the program, and text in a trial.

#include "scene/record/details.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/messages.h"

namespace headpin::scene {
namespace {

Released told_release() {
  Released told;
  told.trigger_s = 0.5;
  told.p_WB = Vec3(0.1, 0.2, 0.3);
  set_motion(
      told,
      {{Vec3(0.0, 5.0, -0.5), Vec3(1.0, 2.0, 1.0 / 3.0)}, Known::extrapolated, Time{12'345}, 2});
  return told;
}

/// As in a trial that did not tell the motion.
Released told_trigger() {
  Released told;
  told.trigger_s = 1e-7;
  return told;
}

struct Stored {
  std::string_view kind;
  Detail detail;
  std::string text;
};

// Details of all kinds, with the texts that trials have of them. These never change: old trials
// have them.
const std::vector<Stored> kStored = {
    {kind::release, told_release(),
     R"({"extrapolated_s":0.012345,"known":"extrapolated","left_out":2,)"
     R"("position_m":[0.1,0.2,0.3],"spin_radps":[1.0,2.0,0.3333333333333333],"trigger_s":0.5,)"
     R"("velocity_mps":[0.0,5.0,-0.5]})"},
    {kind::release, told_trigger(), R"({"trigger_s":1e-07})"},
    {kind::release, Released{}, "{}"},
    {kind::first_contact, FirstContact{Vec3(0.5, 4.5, -0.25)},
     R"({"velocity_mps":[0.5,4.5,-0.25]})"},
    {kind::skittle_down, By::nobody, ""},
    {kind::skittle_down, By::ball, "ball"},
    {kind::skittle_down, By::hand, "hand"},
    {kind::skittle_down, By::stray_ball, "stray ball"},
    {kind::version, Colour::red, "red"},
    {kind::version, Colour::blue, "blue"},
    {kind::game, GameKind::ten_pin, "ten-pin"},
    {kind::delivery, BallOfFrame{10, 3}, "frame 10 ball 3"},
    {kind::dead_wood, BallOfFrame{1, 2}, "frame 1 ball 2"},
    {kind::set_again, BallOfFrame{1, 2}, "frame 1 ball 2"},
    {kind::game_over, "X | 9 /", "X | 9 /"},
    {kind::passed_player, PassedPlayer{1.5, 0.75, 0.1, true, 5.25, 0.3, true},
     R"({"at_hand":true,"foreseen_m":0.1,"hand_away_mps2":0.3,"head_away_mps2":5.25,)"
     R"("moved":true,"noticed_s":1.5,"time_to_contact_s":0.75})"},
    {kind::tracking_lost, TrackedPart::head, "head"},
    {kind::tracking_back, TrackedPart::hand, "hand"},
    {kind::ledger, PhaseEnergies{-0.1, 0.2, -3.0, 0.4, 0.0},
     R"({"correction_j":0.0,"gravity_j":-0.1,"hand_j":0.2,"impact_j":-3.0,"sustained_j":0.4})"},
    {kind::game_hash, "00000000000000ff", "00000000000000ff"},
    {kind::drawn_by, render::Fingerprint{"OSMesa", {"sse2", "avx"}, {"LP_X=1"}, 0xabc},
     R"({"environment":["LP_X=1"],"processor":["sse2","avx"],"renderer":"OSMesa",)"
     R"("test_picture":"0000000000000abc"})"},
    {kind::kept_pace, KeptPace{240, 1, 60, 2, 3},
     R"({"drawing_failures":3,"frames":60,"late_frames":2,"overruns":1,"ticks":240})"},
    {kind::source_amiss, "from the glove, 2 samples left out",
     "from the glove, 2 samples left out"},
};

TEST(Details, OfEveryKindAreReadAsTheValuesThatWereWritten) {
  for (const auto& [kind, detail, text] : kStored) {
    EXPECT_EQ(detail.text(), text);
    EXPECT_EQ(Detail::read(kind, text), detail) << kind << ": " << text;
  }
}

TEST(Details, OfAnotherKindAreText) {
  const std::string pace = Detail(KeptPace{240, 1, 60, 2, 3}).text();
  EXPECT_EQ(Detail::read(kind::game_over, pace), Detail(pace));
  EXPECT_EQ(Detail::read("wind", "hand"), Detail("hand"));
  EXPECT_EQ(Detail::read(kind::version, "ten-pin"), Detail("ten-pin"));
}

/// The bytes of an event as a trial has them.
devices::Buffer stored(std::string_view kind, const Detail& detail) {
  Event event;
  event.kind = kind;
  event.detail = detail;
  devices::Buffer bytes;
  encode(event, bytes);
  return bytes;
}

void expect_kept(std::string_view kind, const std::string& text) {
  const devices::Buffer bytes = stored(kind, text);
  const std::optional<Message> message = decode(kEventChannel, bytes);
  ASSERT_TRUE(message);
  const Detail& detail = std::get<Event>(*message).detail;
  EXPECT_EQ(detail.text(), text) << kind;
  EXPECT_EQ(stored(kind, detail), bytes) << kind << ": " << text;
}

// As of flipped bits, of a cut, and of an older program or a foreign one.
TEST(Details, ThatADamagedOrForeignTrialHasAreWrittenBackByteForByte) {
  for (const auto& [kind, detail, text] : kStored) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      expect_kept(kind, text.substr(0, i));
      for (const int bit : {0, 1, 4, 7}) {
        std::string flipped = text;
        flipped[i] = static_cast<char>(flipped[i] ^ 1 << bit);
        expect_kept(kind, flipped);
      }
    }
    for (const std::string& other : std::vector<std::string>{
             "", " " + text, text + "\n", "null", "[1]", "{}", R"({"later":[1,{"a":null}]})",
             R"({"velocity_mps":[0,5,0],"position_m":[1,2],"trigger_s":5})",
             R"({"left_out":1e300,"extrapolated_s":1e300,"known":"","ticks":-1.5})",
             R"({"left_out":-3000000000,"ticks":18446744073709551615,"moved":"no"})",
             R"({"test_picture":"zz","renderer":1})", "frame  ball ", "frame ball 1",
             "frame 01 ball 2", "frame 1 ball 99999999999999999999", "Red", "\xff\xfe"}) {
      expect_kept(kind, other);
    }
  }
}

// Its text has other spaces, numbers and an order of its own.
TEST(Details, OfAForeignTrialAreReadNevertheless) {
  const Detail release =
      Detail::read(kind::release, R"({ "velocity_mps": [0, 5, 0], "left_out": 2.0, "more": 1 })");
  EXPECT_EQ(release.value_or(Released{}).v_WB, Vec3(0.0, 5.0, 0.0));
  EXPECT_EQ(release.value_or(Released{}).left_out, 2);
  const Detail contact = Detail::read(kind::first_contact, R"({"velocity_mps":[0,5,1]})");
  EXPECT_EQ(contact.value_or(FirstContact{}).v_WB, Vec3(0.0, 5.0, 1.0));
  const Detail passed = Detail::read(kind::passed_player, R"({"moved":true,"noticed_s":2})");
  EXPECT_TRUE(passed.value_or(PassedPlayer{}).moved);
  EXPECT_EQ(passed.value_or(PassedPlayer{}).noticed_s, 2.0);
  EXPECT_EQ(passed.value_or(PassedPlayer{}).foreseen_m, 0.0);
  const Detail pace = Detail::read(kind::kept_pace, R"({"ticks":7,"frames":"8"})");
  EXPECT_EQ(pace.value_or(KeptPace{}), KeptPace{.ticks = 7});
  const Detail ledger = Detail::read(kind::ledger, R"({"impact_j":-1})");
  EXPECT_EQ(ledger.value_or(PhaseEnergies{}), PhaseEnergies{.impact_j = -1.0});
}

TEST(Details, OfADamagedTrialAreMissing) {
  const Detail cut = Detail::read(kind::release, R"({"trigger_s":0.)");
  EXPECT_FALSE(cut.get_if<Released>());
  EXPECT_EQ(cut.value_or(Released{}), Released{});
  EXPECT_FALSE(
      Detail::read(kind::first_contact, R"({"velocity_mps":[0,5]})").get_if<FirstContact>());
  EXPECT_FALSE(Detail::read(kind::drawn_by, R"({"renderer":"x"})").get_if<render::Fingerprint>());
  EXPECT_EQ(Detail::read(kind::skittle_down, "wind").value_or(By::nobody), By::nobody);
}

TEST(Details, ThatAreSetReplaceWhatWasRead) {
  Detail detail = Detail::read(kind::version, "purple");
  detail = Colour::blue;
  EXPECT_EQ(detail.text(), "blue");
  detail = Detail::read(kind::kept_pace, R"({"ticks": 7})");
  KeptPace pace = detail.value_or(KeptPace{});
  pace.ticks = 8;
  detail = pace;
  EXPECT_EQ(detail, Detail(pace));
}

// As of a flipped bit, or of another program.
TEST(Details, AWordThatIsNoneOfOursIsShownAsItIs) {
  Event event;
  event.kind = kind::release;
  event.bodies = {"ball"};
  event.detail = Detail::read(event.kind, R"({"known":"trackgd"})");
  EXPECT_EQ(event.detail.value_or(Released{}).known, Known::impossible);
  EXPECT_EQ(score(std::vector{event}).throws.at(0).known, "trackgd");
}

TEST(MotionAtTheTrigger, IsToldInWords) {
  EXPECT_EQ(in_words({{}, Known::tracked, Time{}, 0}), "tracked");
  EXPECT_EQ(in_words({{}, Known::tracked, Time{}, 1}), "tracked, 1 sample left out");
  EXPECT_EQ(in_words({{}, Known::extrapolated, Time{20'000}, 0}), "extrapolated by 20 ms");
  EXPECT_EQ(in_words({{}, Known::impossible, Time{}, 3}), "impossible, 3 samples left out");
}

TEST(MotionAtTheTrigger, IsNotReadFromADetailThatLacksAPart) {
  Released with_motion;
  set_motion(with_motion, {{}, Known::tracked, Time{}, 0});
  const auto whole = stored_json<nlohmann::json>(with_motion);
  ASSERT_TRUE(motion_of(Detail::read(kind::release, whole.dump())));
  for (const auto& [key, value] : whole.items()) {
    nlohmann::json cut = whole;
    cut.erase(key);
    EXPECT_FALSE(motion_of(Detail::read(kind::release, cut.dump()))) << key;
  }
  EXPECT_FALSE(motion_of(Detail::read(kind::release, "[1]")));
}

}  // namespace
}  // namespace headpin::scene
