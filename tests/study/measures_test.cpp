// What a study measures of a session.

#include "study/measures.h"

#include <gmock/gmock.h>

#include "scene/record/events.h"
#include "study/people.h"

namespace headpin::study {
namespace {

/// A session of which a measurer sees events that are made here.
class Measured : public testing::Test {
 protected:
  /// Of the next tick.
  void happens(std::vector<scene::Event> events) {
    ++session_.tick;
    for (scene::Event& event : events) {
      event.time = session_.now();
      event.tick = session_.tick;
    }
    session_.events = std::move(events);
    measurer_.tick(session_);
    session_.events.clear();
  }
  static scene::Event event(std::string_view kind, scene::Detail detail = {}, double value = 0.0) {
    scene::Event event;
    event.kind = kind;
    event.detail = std::move(detail);
    event.value = value;
    return event;
  }
  void begin(scene::Colour colour) {
    happens({event(scene::kind::version, colour),
             event(scene::kind::game, scene::GameKind::plain, 10.0)});
  }
  void play(int felled) {
    scene::Event release = event(scene::kind::release);
    release.bodies = {"ball"};
    happens({release});
    happens({event(scene::kind::delivery, {}, felled)});
  }
  SessionMeasures measures() const { return measurer_.measures(session_); }

  scene::Session session_ = scene::make_session(scene::Scenario{});
  Measurer measurer_;
};

TEST_F(Measured, CountsTheGamesOfAVersionAndThoseThatWerePlayedToTheirEnd) {
  begin(scene::Colour::red);
  play(4);
  happens({event(scene::kind::game_over)});
  begin(scene::Colour::blue);  // brushed
  begin(scene::Colour::red);
  play(7);
  begin(scene::Colour::blue);
  play(5);
  happens({event(scene::kind::game_over)});
  const VersionMeasures red = measures().versions.at("red"), blue = measures().versions.at("blue");
  EXPECT_EQ(red.games, 2);
  EXPECT_EQ(red.games_over, 1);
  EXPECT_EQ(red.skittles, 11);
  EXPECT_EQ(red.throws, 2);
  EXPECT_EQ(blue.games, 2);
  EXPECT_EQ(blue.games_over, 1);
  EXPECT_EQ(blue.throws, 1);
  EXPECT_FALSE(red.is_one_whole_game());
  EXPECT_TRUE((VersionMeasures{.games = 1, .games_over = 1}).is_one_whole_game());
  EXPECT_FALSE((VersionMeasures{.games = 1, .games_over = 0}).is_one_whole_game());
  EXPECT_FALSE((VersionMeasures{.games = 2, .games_over = 2}).is_one_whole_game());
  EXPECT_TRUE(VersionMeasures{}.is_one_whole_game()) << "a game without counting has no sheet";
}

// Of one that is under way as the version ends, no event tells how it went.
TEST_F(Measured, CountsAnApproachThatTheNextVersionCutsOff) {
  begin(scene::Colour::red);
  happens({event(scene::kind::flies_at_player)});
  happens({event(scene::kind::passed_player, scene::PassedPlayer{.moved = true})});
  happens({event(scene::kind::flies_at_player)});
  begin(scene::Colour::blue);
  happens({event(scene::kind::flies_at_player)});
  happens({event(scene::kind::passed_player, scene::PassedPlayer{})});
  const VersionMeasures red = measures().versions.at("red"), blue = measures().versions.at("blue");
  EXPECT_EQ(red.approaches, 2);
  EXPECT_EQ(red.evaded, 1);
  EXPECT_EQ(blue.approaches, 1);
  EXPECT_EQ(blue.evaded, 0);
}

// 218.9 is no sum of binary fractions: what stands for it prints as it.
TEST_F(Measured, TellsItsDurationAsTheDecimalNumber) {
  session_.tick = 52536;
  ASSERT_EQ(session_.now(), Time{218'900'000});
  EXPECT_EQ(measures().duration_s, 218.9);
}

}  // namespace
}  // namespace headpin::study
