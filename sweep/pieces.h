#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Results are written in pieces: tables of consecutive rows, each in a file with a checksum.
namespace headpin::sweep {

/// The rows of a piece.
struct Piece {
  std::int64_t number = 0, first = 0, rows = 0;
};

/// The rows of a sweep in pieces of at most 1000, small enough that an interrupted run loses
/// little.
class Pieces {
 public:
  explicit Pieces(std::int64_t rows);
  std::int64_t size() const { return (rows_ + each_ - 1) / each_; }
  Piece at(std::int64_t number) const;

 private:
  std::int64_t rows_, each_;
};

/// The content of the last line of a piece.
struct PieceEnd {
  std::int64_t rows = 0, failed = 0;  ///< rows that are there; those of them with an error
};

/// The text of a piece: names of the columns, lines, and a last line with the check.
///
/// @param plan   SHA-256 of the sweep's rows
/// @param lines  finished rows, each with its line end
std::string piece_text(const std::string& plan, const Piece& piece, const std::string& columns,
                       const std::vector<std::string>& lines, std::int64_t failed);

/// Reads a piece again.
///
/// @param where  name of the file, for messages
/// @param lines  gets the lines; null if only the end is needed; the checksum is always verified
/// @throws std::runtime_error  naming the file: cut, changed, or of another sweep
PieceEnd read_piece(std::string_view text, const std::string& where, const std::string& plan,
                    const Piece& piece, const std::string& columns,
                    std::vector<std::string>* lines);

}  // namespace headpin::sweep
