#include "sweep/pieces.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "base/sha256.h"

namespace headpin::sweep {

namespace {

constexpr std::int64_t kMostRowsOfAPiece = 1000, kPieces = 64;

/// The last line: "#,piece,rows,failed,plan,check".
std::string last_line(const std::string& plan, const Piece& piece, const PieceEnd& end,
                      std::string_view above) {
  const std::string begin = fmt::format("#,{},{},{},{},", piece.number, end.rows, end.failed, plan);
  return begin + base::sha256(begin + std::string(above)) + "\n";
}

[[noreturn]] void refuse(const std::string& where, const std::string& why) {
  throw std::runtime_error(
      fmt::format("{}: {}; delete it to have its rows simulated again", where, why));
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    fields.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return fields;
}

std::int64_t whole(std::string_view text) {
  std::int64_t value = 0;
  if (text.empty() || text.size() > 12) return -1;
  for (const char c : text) {
    if (c < '0' || c > '9') return -1;
    value = 10 * value + (c - '0');
  }
  return value;
}

/// The lines of a table, each with its end. A line break inside quotes ends none.
std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    quoted ^= text[at] == '"';
    if (text[at] != '\n' || quoted) continue;
    lines.emplace_back(text.substr(begin, at + 1 - begin));
    begin = at + 1;
  }
  return lines;
}

}  // namespace

Pieces::Pieces(std::int64_t rows)
    : rows_(rows),
      each_(std::clamp<std::int64_t>((rows + kPieces - 1) / kPieces, 1, kMostRowsOfAPiece)) {}

Piece Pieces::at(std::int64_t number) const {
  const std::int64_t first = number * each_;
  return {number, first, std::min(each_, rows_ - first)};
}

std::string piece_text(const std::string& plan, const Piece& piece, const std::string& columns,
                       const std::vector<std::string>& lines, std::int64_t failed) {
  std::string text = columns;
  for (const std::string& line : lines) text += line;
  return text + last_line(plan, piece, {std::ssize(lines), failed}, text);
}

PieceEnd read_piece(std::string_view text, const std::string& where, const std::string& plan,
                    const Piece& piece, const std::string& columns,
                    std::vector<std::string>* lines) {
  const std::size_t end_of_rows =
      text.size() < 2 || text.back() != '\n' ? 0 : text.rfind('\n', text.size() - 2) + 1;
  const std::string_view above = text.substr(0, end_of_rows);
  const std::string_view last = text.substr(end_of_rows);
  if (end_of_rows == 0 || !last.starts_with("#,")) refuse(where, "it is cut short");
  const auto fields = fields_of(last.substr(0, last.size() - 1));
  if (fields.size() != 6) refuse(where, "its last line is no check of a piece");
  if (fields[4] != plan) refuse(where, "it is of another sweep");
  const PieceEnd end{whole(fields[2]), whole(fields[3])};
  if (last != last_line(plan, piece, end, above)) refuse(where, "it was changed, its check fails");
  if (end.rows < 0 || end.rows > piece.rows || !above.starts_with(columns)) {
    refuse(where, "it has other rows than the sweep");
  }
  if (!lines) return end;
  *lines = lines_of(above.substr(columns.size()));
  if (std::ssize(*lines) != end.rows) refuse(where, "it has other rows than its last line says");
  return end;
}

}  // namespace headpin::sweep
