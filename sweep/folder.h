#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sweep/pieces.h"
#include "sweep/rows.h"
#include "sweep/runner.h"

/// A sweep on the disk: a folder that a person can read.
namespace headpin::sweep {

/// The paths in the folder of a sweep.
struct SweepFolder {
  std::filesystem::path root;

  std::filesystem::path design() const { return root / "sweep.toml"; }
  std::filesystem::path trials() const { return root / "trials"; }
  std::filesystem::path rows() const { return root / "rows.csv"; }
  std::filesystem::path pieces() const { return root / "pieces"; }
  std::filesystem::path piece(const Piece& piece) const;
};

/// A sweep, ready to be run.
struct Sweep {
  SweepFolder at;
  Rows rows;
  std::vector<Trial> trials;
  std::string plan;     ///< SHA-256 of rows.csv
  std::string columns;  ///< first line of every table of results
  Pieces pieces;
};

/// Makes the folder: sweep.toml, the trials, and last rows.csv, which makes the sweep complete.
///
/// Every value of every key is tried on every trial's scenario first.
/// @param design  a file; its trials are named from its folder
/// @param check   called from time to time; may throw
/// @return  number of rows
/// @throws std::invalid_argument  naming file, line and key of an unknown key or an impossible value
/// @throws std::runtime_error     if the folder holds a sweep or something of others already
std::int64_t plan(const std::filesystem::path& design, const SweepFolder& at,
                  const std::function<void()>& check);

/// Reads it again.
/// @throws std::runtime_error  for a folder without a sweep, or if rows.csv does not match
///   sweep.toml and the trials
Sweep open_sweep(const std::filesystem::path& root);

/// The end of a piece; nothing if the piece does not exist.
/// @param lines  gets the lines; null if only the end is needed
/// @throws std::runtime_error  as read_piece
std::optional<PieceEnd> piece_of(const Sweep& sweep, const Piece& piece,
                                 std::vector<std::string>* lines);

/// Locks the piece against other processes during the lifetime of this object, if the file system
/// has locks.
class PieceClaim {
 public:
  PieceClaim(const Sweep& sweep, const Piece& piece);
  ~PieceClaim();
  PieceClaim(const PieceClaim&) = delete;
  PieceClaim& operator=(const PieceClaim&) = delete;

  /// False if another process works on it.
  bool is_ours() const { return ours_; }

 private:
  int descriptor_ = -1;
  bool ours_ = true;
};

/// Simulates the missing rows of a piece and writes it. If `check` throws, the finished rows are
/// written.
///
/// @param check  called at every tick; may throw
/// @param done   called after each row
/// @throws  whatever `check` throws, and as read_piece
void run_piece(const Sweep& sweep, const Piece& piece, Runner& runner,
               const std::function<void()>& check, const std::function<void()>& done);

}  // namespace headpin::sweep
