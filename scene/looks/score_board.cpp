#include "scene/looks/score_board.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::scene {

namespace {

constexpr int kDotsAcross = 3, kDotsUp = 5;
constexpr double kBoardMargin = 1.0, kBetweenRows = 1.5;  // [dots]
constexpr double kBoardWidth =
    (kDotsAcross + 1) * static_cast<double>(kBoardColumns) - 1.0 + 2.0 * kBoardMargin;  // [dots]
constexpr double kBoardHeight =
    kDotsUp * static_cast<double>(kBoardRows) + kBetweenRows + 2.0 * kBoardMargin;  // [dots]

/// A character and its rows of dots from the top, three bits each.
struct Character {
  char name;
  std::array<int, kDotsUp> rows;
};
constexpr std::array<Character, 22> kCharacters{{
    {'0', {7, 5, 5, 5, 7}}, {'1', {2, 6, 2, 2, 7}}, {'2', {7, 1, 7, 4, 7}}, {'3', {7, 1, 7, 1, 7}},
    {'4', {5, 5, 7, 1, 1}}, {'5', {7, 4, 7, 1, 7}}, {'6', {7, 4, 7, 5, 7}}, {'7', {7, 1, 1, 2, 2}},
    {'8', {7, 5, 7, 5, 7}}, {'9', {7, 5, 7, 1, 7}}, {'X', {5, 5, 2, 5, 5}}, {'/', {1, 1, 2, 4, 4}},
    {'-', {0, 0, 7, 0, 0}}, {'_', {0, 0, 0, 0, 7}}, {'F', {7, 4, 6, 4, 4}}, {'O', {7, 5, 5, 5, 7}},
    {'U', {5, 5, 5, 5, 7}}, {'L', {4, 4, 4, 4, 7}}, {'V', {5, 5, 5, 5, 2}}, {'E', {7, 4, 6, 4, 7}},
    {'R', {6, 5, 6, 5, 5}}, {'+', {0, 2, 7, 2, 0}},
}};

bool ends_in_digit(const std::string& word) {
  return !word.empty() && word.back() >= '0' && word.back() <= '9';
}

/// Puts a plus before each word that would go on with the number of the word before it.
void keep_apart(std::vector<std::string>& words) {
  for (std::size_t i = words.size(); i-- > 1;) {
    const char first = words[i].front();
    if (ends_in_digit(words[i - 1]) && first >= '0' && first <= '9') words[i].insert(0, "+");
  }
}

/// What a ball may count so that its numbers need no sign between them: a 10 is no 1 and 0, as 0 is
/// a dash.
constexpr int kMostAlone = 10;

/// The balls of all frames as the sheet writes them, with F for fouls. Where a ball can count more
/// than kMostAlone, a plus is between two numbers.
std::vector<std::vector<std::string>> balls_in_words(const GameRules& plan, const Game& game,
                                                     int rack) {
  std::vector<std::vector<std::string>> frames;
  const Rules& rules = rules_of(plan.rules);
  const int most = rules.bonuses ? rack - 1 : rack;  // all of them are a strike
  std::size_t ball_of_game = 0;
  for (const Frame& frame : game.frames) {
    std::vector<std::string>& words = frames.emplace_back();
    for (std::size_t ball = 0; ball < frame.size(); ++ball) {
      std::string word = ball_in_words(rules, frame, ball, rack);
      const bool foul = game.fouls[ball_of_game++] != 0;
      if (foul && plan.foul == FoulBall::zero) word.clear();
      words.push_back(fmt::format("{}{}", foul ? "F" : "", word));
    }
    if (most > kMostAlone) keep_apart(words);
  }
  if (!game.over) frames.back().push_back("_");
  return frames;
}

/// As many of the last frames as the board has place for; of a longer frame its last balls.
std::string last_balls(const std::vector<std::vector<std::string>>& frames) {
  std::string row;
  for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
    const std::string words = fmt::format("{}{}", fmt::join(*frame, ""), row.empty() ? "" : " ");
    if (words.size() + row.size() > kBoardColumns) break;
    row.insert(0, words);
  }
  if (!row.empty()) return row;
  const std::vector<std::string>& last = frames.back();
  for (auto ball = last.rbegin(); ball != last.rend(); ++ball) {
    const std::size_t plus = ball->starts_with('+') ? 1 : 0;
    if (ball->size() - plus + row.size() > kBoardColumns) break;
    row.insert(0, *ball);
  }
  return row.starts_with('+') ? row.substr(1) : row;
}

/// Two words, one at each end of a row; the second alone where there is no place for both.
std::string at_the_ends(const std::string& left, const std::string& right) {
  if (left.size() + 1 + right.size() > kBoardColumns) return right.substr(0, kBoardColumns);
  return left + std::string(kBoardColumns - left.size() - right.size(), ' ') + right;
}

}  // namespace

std::vector<std::string> board_text(const GameRules& plan, const Game& game, int rack) {
  if (game.frames.empty()) return {};
  const Rules& rules = rules_of(plan.rules);
  const std::string state = game.over   ? "OVER"
                            : game.foul ? "FOUL"
                                        : fmt::format("F{}", game.frames.size());
  return {last_balls(balls_in_words(plan, game, rack)),
          at_the_ends(state, fmt::format("{}", points(rules, game.frames, rack)))};
}

std::vector<std::string> board_text(const Session& session) {
  const GameRules& plan = session.scenario().game;
  if (!plan.show_score) return {};
  return board_text(plan, session.game, static_cast<int>(session.stage->skittles.size()));
}

Vec3 BoardMeasures::cell(std::size_t row, std::size_t column) const {
  constexpr double kBefore = 0.01;  // [m]
  const double right = kBoardMargin + (kDotsAcross + 1) * static_cast<double>(column);
  const double rows_below = static_cast<double>(kBoardRows - 1 - row);
  const double up = kBoardMargin + (kDotsUp + kBetweenRows) * rows_below;
  return p_W + Vec3(right * dot.x(), -kBefore, up * dot.y());
}

BoardMeasures board_measures(const RoomMeasures& room) {
  // What a pixel in the middle of the paper's display sees at 1 m: 2 tan(75 deg / 2) / 360 and
  // 2 tan(40 deg / 2) / 240 [m].
  const Vec2 pixel(0.004263, 0.003033);
  constexpr double kPixelsAcross = 1.5, kPixelsUp = 8.0 / kDotsUp;     // of a dot
  constexpr double kBefore = 0.06, kToWalls = 0.1, kToCeiling = 0.06;  // [m]
  constexpr double kLow = 1.5;  // a head that looks down at the skittles sees it too [m]
  BoardMeasures board;
  const double y = (room.masking_panel ? room.portal() : room.ahead) - kBefore;
  board.dot =
      Vec2(std::min(kPixelsAcross * pixel.x() * y, (room.width - 2.0 * kToWalls) / kBoardWidth),
           std::min(kPixelsUp * pixel.y() * y, 0.5 * room.height / kBoardHeight));
  board.size = board.dot.cwiseProduct(Vec2(kBoardWidth, kBoardHeight));
  board.p_W =
      Vec3(-0.5 * board.size.x(), y, std::min(kLow, room.height - kToCeiling - board.size.y()));
  return board;
}

render::Mesh board_mesh(const BoardMeasures& board) {
  constexpr double kThick = 0.04, kRim = 0.03, kRimBehind = 0.005;  // [m]
  const Vec3 middle = board.p_W + Vec3(0.5 * board.size.x(), 0.5 * kThick, 0.5 * board.size.y());
  const Vec3 size(board.size.x(), kThick, board.size.y());
  render::Mesh mesh;
  mesh.surface = render::Surface::baked;
  append(mesh, render::box(size, render::srgb(0x0b0e14)), {Quat::Identity(), middle});
  append(mesh, render::box(size + Vec3(2.0 * kRim, 0.0, 2.0 * kRim), render::srgb(0x5c6470)),
         {Quat::Identity(), middle + Vec3(0.0, kRimBehind, 0.0)});
  return mesh;
}

std::string board_characters() {
  std::string all;
  for (const Character& one : kCharacters) all += one.name;
  return all;
}

render::Mesh character_mesh(char character, const Vec2& dot) {
  const auto found = std::ranges::find(kCharacters, character, &Character::name);
  if (found == kCharacters.end()) {
    throw std::invalid_argument(
        fmt::format("score board: expected one of {}, found {}", board_characters(), character));
  }
  render::Mesh mesh;
  mesh.surface = render::Surface::baked;
  const Vec3 colour = render::srgb(0xffd877);
  const auto corner = [&](int across, int up) { return Vec3(dot.x() * across, 0.0, dot.y() * up); };
  for (int row = 0; row < kDotsUp; ++row) {
    for (int column = 0; column < kDotsAcross; ++column) {
      const int bits = found->rows[static_cast<std::size_t>(kDotsUp - 1 - row)];
      if ((bits >> (kDotsAcross - 1 - column) & 1) == 0) continue;
      append_face(mesh, corner(column, row), corner(column + 1, row), corner(column + 1, row + 1),
                  corner(column, row + 1), colour);
    }
  }
  return mesh;
}

}  // namespace headpin::scene
