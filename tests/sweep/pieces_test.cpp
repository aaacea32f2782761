#include "sweep/pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::sweep {
namespace {

using testing::HasSubstr;

const std::string kPlan(64, 'a'), kColumns = "key,value\n";
const Piece kPiece{3, 30, 10};
const std::vector<std::string> kLines = {"1,x\n", "2,\"a\nb\"\n", "3,\"say \"\"no\"\"\"\n"};

TEST(SweepPieces, HaveEveryRowOnceAndAtMostAThousandEach) {
  for (const std::int64_t rows : {1, 2, 63, 64, 65, 441, 10'000, 64'000, 64'001, 1'000'000}) {
    const Pieces pieces(rows);
    std::int64_t next = 0;
    for (std::int64_t i = 0; i < pieces.size(); ++i) {
      const Piece piece = pieces.at(i);
      EXPECT_EQ(piece.first, next);
      EXPECT_GE(piece.rows, 1);
      EXPECT_LE(piece.rows, 1000);
      next += piece.rows;
    }
    EXPECT_EQ(next, rows);
  }
}

TEST(SweepPieces, AreReadBackLineByLine) {
  const std::string text = piece_text(kPlan, kPiece, kColumns, kLines, 2);
  std::vector<std::string> lines;
  const PieceEnd end = read_piece(text, "p", kPlan, kPiece, kColumns, &lines);
  EXPECT_EQ(lines, kLines);
  EXPECT_EQ(end.rows, 3);
  EXPECT_EQ(end.failed, 2);
}

// Cut anywhere, or with any one byte another: never taken for a piece.
TEST(SweepPieces, ThatAreDamagedAnywhereAreRefused) {
  const std::string text = piece_text(kPlan, kPiece, kColumns, kLines, 0);
  const auto refused = [](const std::string& damaged) {
    return complaint([&] { read_piece(damaged, "p.csv", kPlan, kPiece, kColumns, nullptr); });
  };
  EXPECT_EQ(refused(text), "");
  for (std::size_t at = 0; at < text.size(); ++at) {
    EXPECT_THAT(refused(text.substr(0, at)), HasSubstr("p.csv: ")) << at;
    for (const char other : {'0', '\n', '"', ',', '\x80'}) {
      std::string changed = text;
      if (changed[at] == other) continue;
      changed[at] = other;
      EXPECT_THAT(refused(changed), HasSubstr("delete it to have its rows simulated again")) << at;
    }
  }
  EXPECT_THAT(refused(text + text), HasSubstr("p.csv"));
}

TEST(SweepPieces, OfAnotherPlaceOrPlanAreRefused) {
  const std::string text = piece_text(kPlan, kPiece, kColumns, kLines, 0);
  EXPECT_THAT(
      complaint([&] { read_piece(text, "p", std::string(64, 'b'), kPiece, kColumns, nullptr); }),
      HasSubstr("of another sweep"));
  EXPECT_NE(complaint([&] { read_piece(text, "p", kPlan, {4, 40, 10}, kColumns, nullptr); }), "");
  EXPECT_NE(complaint([&] { read_piece(text, "p", kPlan, {3, 30, 2}, kColumns, nullptr); }), "");
  EXPECT_NE(complaint([&] { read_piece(text, "p", kPlan, kPiece, "key,other\n", nullptr); }), "");
}

}  // namespace
}  // namespace headpin::sweep
