// The score board: its text, its place in the room, and its characters in the eyes.

#include "scene/looks/score_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "render/osmesa_context.h"
#include "scene/looks/eyes.h"
#include "scene/play/run.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/refusal.h"
#include "tests/scene/with_rules.h"
#include "tests/support/hand_script.h"

namespace headpin::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Text = std::vector<std::string>;

constexpr int kTenPins = 10;

GameRules plan_of(GameKind kind, FoulBall foul = FoulBall::note) {
  GameRules plan;
  plan.rules = kind;
  plan.foul = foul;
  return plan;
}

/// A game without fouls.
Game game_of(std::vector<Frame> frames) {
  Game game;
  for (const Frame& frame : frames) game.fouls.insert(game.fouls.end(), frame.size(), 0);
  game.frames = std::move(frames);
  game.begun = true;
  return game;
}

Text of_ten_pins(std::vector<Frame> frames) {
  return board_text(plan_of(GameKind::ten_pin), game_of(std::move(frames)), kTenPins);
}

// Points by hand: a strike counts the next two balls too, a spare the next one.
TEST(BoardText, HasTheLastBallsTheFrameAndThePoints) {
  EXPECT_THAT(board_text(plan_of(GameKind::ten_pin), {}, kTenPins), IsEmpty());
  EXPECT_THAT(of_ten_pins({{}}), ElementsAre("_", "F1       0"));
  EXPECT_THAT(of_ten_pins({{7}}), ElementsAre("7_", "F1       7"));
  EXPECT_THAT(of_ten_pins({{7, 3}, {}}), ElementsAre("7/ _", "F2      10"));
  EXPECT_THAT(of_ten_pins({{9, 0}, {}}), ElementsAre("9- _", "F2       9"));
  EXPECT_THAT(of_ten_pins({{10}, {3}}), ElementsAre("X 3_", "F2      16"));
  EXPECT_THAT(of_ten_pins({{7, 3}, {10}, {0, 9}, {}}), ElementsAre("7/ X -9 _", "F4      48"));
}

TEST(BoardText, LeavesOutFirstFramesOfALongGame) {
  std::vector<Frame> frames(9, {10});
  frames.push_back({10, 10});
  EXPECT_THAT(of_ten_pins(frames), ElementsAre("X X X XX_", "F10    290"));
  frames.back().push_back(10);
  Game perfect = game_of(frames);
  perfect.over = true;
  EXPECT_THAT(board_text(plan_of(GameKind::ten_pin), perfect, kTenPins),
              ElementsAre("X X X XXX", "OVER   300"));
  EXPECT_THAT(of_ten_pins({{1, 2}, {3, 4}, {5, 4}, {8}}), ElementsAre("34 54 8_", "F4      27"));
}

TEST(BoardText, OfALongFrameHasItsLastBalls) {
  const auto text = [](Frame frame) {
    return board_text(plan_of(GameKind::plain), game_of({std::move(frame)}), 100).front();
  };
  EXPECT_EQ(text({1, 2, 3, 4, 5, 6, 7, 8, 9}), "5+6+7+8+9_");
  EXPECT_EQ(text({1, 2, 3, 4, 5, 6, 7, 8, 9, 0}), "6+7+8+9-_");
  EXPECT_EQ(text({11, 22, 33, 44, 55}), "33+44+55_");  // no half of a number
}

TEST(BoardText, HasASignBetweenNumbersThatCouldBeOne) {
  const auto text = [](std::vector<Frame> frames, GameKind kind, int rack) {
    return board_text(plan_of(kind), game_of(std::move(frames)), rack).front();
  };
  EXPECT_EQ(text({{35, 14}, {49}}, GameKind::plain, 49), "35+14 49_");
  EXPECT_EQ(text({{3, 5, 14}}, GameKind::plain, 49), "3+5+14_");
  EXPECT_EQ(text({{1, 1}, {11}}, GameKind::plain, 11), "1+1 11_");
  EXPECT_EQ(text({{35, 0}, {0, 14}}, GameKind::plain, 49), "35- -14_");
  EXPECT_EQ(text({{3, 5}, {10}}, GameKind::plain, kTenPins), "35 10_");  // no 35 of ten skittles
  EXPECT_EQ(text({{5, 3}, {12}, {2}}, GameKind::ten_pin, 12), "5+3 X 2_");
}

TEST(BoardText, OfOtherGamesHasNoMarks) {
  EXPECT_THAT(board_text(plan_of(GameKind::ninepins), game_of({{7}, {9}, {0}, {}}), 9),
              ElementsAre("7 9 - _", "F4      16"));
  EXPECT_THAT(board_text(plan_of(GameKind::plain), game_of({{10, 0}, {3}}), kTenPins),
              ElementsAre("10- 3_", "F2      13"));
  EXPECT_THAT(board_text(plan_of(GameKind::skittles), game_of({{9, 9, 8}, {}}), 9),
              ElementsAre("998 _", "F2      26"));
}

TEST(BoardText, SaysThatABallIsAFoulAndMarksItFromThenOn) {
  Game game = game_of({{7}});
  game.foul = true;
  EXPECT_THAT(board_text(plan_of(GameKind::ten_pin), game, kTenPins),
              ElementsAre("7_", "FOUL     7"));
  game = game_of({{0, 7}, {}});
  game.fouls[0] = 1;
  EXPECT_THAT(board_text(plan_of(GameKind::ten_pin, FoulBall::zero), game, kTenPins),
              ElementsAre("F7 _", "F2       7"));
  game = game_of({{5, 5}, {}});
  game.fouls[1] = 1;
  EXPECT_THAT(board_text(plan_of(GameKind::ten_pin), game, kTenPins),
              ElementsAre("5F/ _", "F2      10"));
}

TEST(BoardText, ThatIsTooLongForARowIsThePoints) {
  std::vector<Frame> frames(99, {1000});
  frames.push_back({});
  EXPECT_THAT(board_text(plan_of(GameKind::plain), game_of(frames), 1000),
              ElementsAre("1000 _", "F100 99000"));
  frames.insert(frames.end(), 901, {1000});
  EXPECT_EQ(board_text(plan_of(GameKind::plain), game_of(frames), 1000).back(), "1000000");
}

TEST(BoardText, HasAMeshForEachCharacter) {
  const std::string known = board_characters();
  for (const char character : std::string("0123456789X/-_FOULOVER+")) {
    EXPECT_NE(known.find(character), std::string::npos) << character;
    EXPECT_FALSE(character_mesh(character, Vec2(0.1, 0.1)).indices.empty()) << character;
  }
  EXPECT_THROW(character_mesh('?', Vec2(0.1, 0.1)), std::invalid_argument);
}

TEST(BoardKey, IsOffUnlessAScenarioHasIt) {
  EXPECT_FALSE(Scenario{}.game.show_score);
  EXPECT_TRUE(parse_scenario("[game]\nshow_score = true", "lane.toml").game.show_score);
  EXPECT_EQ(refusal("[game]\nshow_score = 1"),
            "lane.toml:2: game.show_score must be true or false, found 1");
}

TEST(BoardKey, IsOnInTheBundledAlleysAndNotInThePapersRooms) {
  const auto shows = [](const char* name) {
    return load_scenario(fmt::format("{}/assets/scenarios/{}.toml", HEADPIN_SOURCE_DIR, name))
        .game.show_score;
  };
  for (const char* alley :
       {"regulation-ten-pin", "house-oil", "sport-oil", "english-skittles", "german-ninepins"}) {
    EXPECT_TRUE(shows(alley)) << alley;
  }
  for (const char* room : {"paper-room", "paper-experiment", "paper-objects", "uno-slater-1997"}) {
    EXPECT_FALSE(shows(room)) << room;
  }
}

/// An alley with a game whose frames are given, seen from the foul line.
struct Alley {
  Scenario scenario;
  Session session;
  Eyes eyes;
  Glimpse g;

  explicit Alley(const char* name, const render::Quality& look = {.mirror = false})
      : scenario(
            load_scenario(fmt::format("{}/assets/scenarios/{}.toml", HEADPIN_SOURCE_DIR, name))),
        session(make_session(scenario)),
        eyes(open_eyes(*session.stage, look)),
        g(glimpse(session,
                  {rotation(Vec3(0.5 * std::numbers::pi - 0.05, 0, 0)), Vec3(0.1, 0.0, 1.65)})) {}

  void set(std::vector<Frame> frames) {
    session.game = game_of(std::move(frames));
    g.board = board_text(session);
  }
  render::Image left() {
    std::array<render::Image, 2> images;
    see(eyes, g, images);
    return images[0];
  }
};

/// Where a point is in a picture, by the pinhole camera's law alone.
Vec2 pixel_of(const render::View& view, const Vec3& p_W) {
  const Vec3 p = view.X_WE.inverse() * p_W;
  const render::Frustum& f = view.frustum;
  return {view.width * (p.x() / -p.z() - f.left) / (f.right - f.left),
          view.height * (f.top - p.y() / -p.z()) / (f.top - f.bottom)};
}

struct Box {
  Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);

  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

/// The pixels of an object.
Box pixels_of(const render::Labels& labels, std::uint32_t id) {
  Box box;
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      if (labels.id[static_cast<std::size_t>(y * labels.width + x)] != id) continue;
      box.add(Vec2(x, y));
      box.add(Vec2(x + 1, y + 1));
    }
  }
  return box;
}

// Oracle: the corners of the board, projected. Its rim is 3 cm wide, which is less than a pixel.
TEST(ScoreBoard, HangsWhereItsMeasuresAreAndBeforeNoSkittle) {
  for (const char* name : {"regulation-ten-pin", "german-ninepins", "english-skittles"}) {
    Alley alley(name);
    alley.set({{7, 2}, {10}, {}});
    const BoardMeasures board = board_measures(alley.session.stage->room);
    const auto views = views_of(alley.eyes, alley.g);
    const auto labels = see_labels(alley.eyes, alley.g);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      Box expected;
      for (const double x : {0.0, board.size.x()}) {
        for (const double z : {0.0, board.size.y()}) {
          expected.add(pixel_of(views[eye], board.p_W + Vec3(x, 0.0, z)));
        }
      }
      const Box found = pixels_of(labels[eye], kBoardId);
      EXPECT_LT((found.low - expected.low).cwiseAbs().maxCoeff(), 1.6) << name;
      EXPECT_LT((found.high - expected.high).cwiseAbs().maxCoeff(), 1.6) << name;
      for (std::uint32_t i = 0; i < alley.scenario.rack.spots.size(); ++i) {
        EXPECT_GT(pixels_of(labels[eye], kFirstSkittleId + i).low.y(), found.high.y()) << name;
      }
    }
  }
}

TEST(ScoreBoard, HasCharactersOfSevenPixelsAndMoreFromTheFoulLine) {
  for (const char* name :
       {"regulation-ten-pin", "house-oil", "sport-oil", "english-skittles", "german-ninepins"}) {
    Alley alley(name);
    const BoardMeasures board = board_measures(alley.session.stage->room);
    const render::View view = views_of(alley.eyes, alley.g)[0];
    const Vec3 low = board.cell(0, 5), high = low + Vec3(3 * board.dot.x(), 0, 5 * board.dot.y());
    const Vec2 size = pixel_of(view, high) - pixel_of(view, low);
    EXPECT_GE(-size.y(), 7.0) << name;
    EXPECT_GE(size.x(), 3.0) << name;
    const double below_ceiling = alley.scenario.room.height - (board.p_W.z() + board.size.y());
    EXPECT_GT(below_ceiling, 0.03) << name;        // its rim
    EXPECT_NEAR(board.p_W.z(), 1.5, 0.2) << name;  // about the height of the eyes
    EXPECT_GT(board.p_W.y(), alley.scenario.lane.head_pin - 0.5) << name;
    EXPECT_LT(board.p_W.y(), alley.scenario.room.ahead) << name;
    EXPECT_LT(board.size.x(), alley.scenario.room.width);
  }
}

double brightness(const render::Image& image, const Vec2& at) {
  const auto pixel =
      static_cast<std::size_t>(static_cast<int>(at.y()) * image.width + static_cast<int>(at.x()));
  return image.rgb[3 * pixel] + image.rgb[3 * pixel + 1];
}

/// Three by five dots of a character, '#' for a lit one: its shape by hand.
const std::map<char, std::string>& shapes() {
  static const std::map<char, std::string> all{{'7',
                                                "###"
                                                "..#"
                                                "..#"
                                                ".#."
                                                ".#."},
                                               {'2',
                                                "###"
                                                "..#"
                                                "###"
                                                "#.."
                                                "###"},
                                               {'X',
                                                "#.#"
                                                "#.#"
                                                ".#."
                                                "#.#"
                                                "#.#"},
                                               {'/',
                                                "..#"
                                                "..#"
                                                ".#."
                                                "#.."
                                                "#.."},
                                               {'F',
                                                "###"
                                                "#.."
                                                "##."
                                                "#.."
                                                "#.."}};
  return all;
}

// In the pixels of the paper's display every lit dot is brighter than every dark one of its
// character: it is read, upright and not mirrored.
TEST(ScoreBoard, IsReadFromTheFoulLineInThePixelsOfThePapersDisplay) {
  for (const char* name : {"regulation-ten-pin", "german-ninepins", "english-skittles"}) {
    Alley alley(name);
    alley.g.board = {"72 X 7/ X2", "F2 7X2/ 72"};
    const BoardMeasures board = board_measures(alley.session.stage->room);
    const render::View view = views_of(alley.eyes, alley.g)[0];
    const render::Image image = alley.left();
    for (std::size_t row = 0; row < kBoardRows; ++row) {
      for (std::size_t column = 0; column < kBoardColumns; ++column) {
        const char character = alley.g.board[row][column];
        if (character == ' ') continue;
        double darkest_lit = 1e9, brightest_dark = 0.0;
        for (int dot = 0; dot < 15; ++dot) {
          const Vec3 p = board.cell(row, column) + Vec3((dot % 3 + 0.5) * board.dot.x(), 0.0,
                                                        (4 - dot / 3 + 0.5) * board.dot.y());
          const double seen = brightness(image, pixel_of(view, p));
          const bool lit = shapes().at(character)[static_cast<std::size_t>(dot)] == '#';
          if (lit) darkest_lit = std::min(darkest_lit, seen);
          if (!lit) brightest_dark = std::max(brightest_dark, seen);
        }
        EXPECT_GT(darkest_lit, brightest_dark) << name << " " << row << " " << column;
      }
    }
  }
}

/// Whether two pictures differ in a pixel of an object, and in another one.
std::pair<bool, bool> differs(const render::Image& a, const render::Image& b, const Box& object) {
  std::pair<bool, bool> found{false, false};
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const auto at = static_cast<std::ptrdiff_t>(3 * (y * a.width + x));
      if (std::equal(a.rgb.begin() + at, a.rgb.begin() + at + 3, b.rgb.begin() + at)) continue;
      const bool inside = x + 1 > object.low.x() && x < object.high.x() && y + 1 > object.low.y() &&
                          y < object.high.y();
      (inside ? found.first : found.second) = true;
    }
  }
  return found;
}

TEST(ScoreBoard, ChangesItsDigitsAloneWithAThrow) {
  Scenario scenario = with_rules(GameKind::ten_pin, 2, 2);
  scenario.game.show_score = true;
  HandScript hand(scenario);
  hand.throw_from(0.05);
  Session session = make_session(scenario);
  devices::ReplaySource source(hand.samples);
  advance(session, source);
  const Pose X_WD{rotation(Vec3(0.5 * std::numbers::pi, 0, 0)), Vec3(0.0, 0.0, 1.65)};
  Glimpse g = glimpse(session, X_WD);
  EXPECT_THAT(g.board, ElementsAre("_", "F1       0"));
  while (session.game.frames.front().empty() && session.now() < source.end()) {
    advance(session, source);
  }
  const int down = session.game.frames.front().at(0);
  ASSERT_GT(down, 0);
  const Text after = glimpse(session, X_WD).board;
  EXPECT_THAT(after[1], testing::EndsWith(fmt::format(" {}", down)));

  Eyes eyes = open_eyes(*session.stage, {.mirror = false});
  const Box board = pixels_of(see_labels(eyes, g)[0], kBoardId);
  std::array<render::Image, 2> before_images, after_images;
  see(eyes, g, before_images);
  g.board = after;
  see(eyes, g, after_images);
  EXPECT_EQ(differs(before_images[0], after_images[0], board), std::pair(true, false));
}

TEST(ScoreBoard, ShowsTheTextOfATickAtThatTickAndNotBefore) {
  Scenario scenario = with_rules(GameKind::ten_pin, 2, 2);
  scenario.game.show_score = true;
  Session session = make_session(scenario);
  session.tick = 240;
  session.game = game_of({{}});
  BetweenTicks between;
  between.keep(session);
  session.tick = 241;
  session.game = game_of({{4}});
  EXPECT_EQ(between.glimpse(session, Time{1'002'000}, {}).board[0], "_");
  EXPECT_EQ(between.glimpse(session, session.now(), {}).board[0], "4_");
}

TEST(ScoreBoard, IsNotThereWithoutItsKey) {
  Session session = make_session(with_rules(GameKind::ten_pin, 2, 2));
  session.game = game_of({{4}});
  const Pose X_WD{rotation(Vec3(0.5 * std::numbers::pi, 0, 0)), Vec3(0.0, 0.0, 1.65)};
  Glimpse g = glimpse(session, X_WD);
  EXPECT_THAT(g.board, IsEmpty());
  Eyes eyes = open_eyes(*session.stage, {});
  EXPECT_EQ(pixels_of(see_labels(eyes, g)[0], kBoardId).high.x(), -1e9);
  std::array<render::Image, 2> without, with_text;
  see(eyes, g, without);
  g.board = {"4_", "F1       4"};
  see(eyes, g, with_text);
  EXPECT_EQ(without[0], with_text[0]);
}

}  // namespace
}  // namespace headpin::scene
