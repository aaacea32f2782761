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

/// Where a sweep has what.
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

/// Makes the folder: sweep.toml, the trials and rows.csv, which comes last and makes it a sweep.
///
/// Every value of every key is tried on every trial's scenario first.
/// @param design  a file; its trials are named from its folder
/// @param check   called now and then; may throw
/// @return  how many rows
/// @throws std::invalid_argument  naming file and key for what cannot be
/// @throws std::runtime_error     where the folder has something already
std::int64_t plan(const std::filesystem::path& design, const SweepFolder& at,
                  const std::function<void()>& check);

/// Reads it again.
/// @throws std::runtime_error  for a folder that holds none, and for rows.csv where the rows are others
///                             than sweep.toml and the trials say
Sweep open_sweep(const std::filesystem::path& root);

/// Its end; nothing where it is not there.
/// @param lines  null where only the end is asked for
/// @throws std::runtime_error  as read_piece
std::optional<PieceEnd> piece_of(const Sweep& sweep, const Piece& piece,
                                 std::vector<std::string>* lines);

/// Keeps other processes from the piece until it goes, where the file system has locks.
class PieceClaim {
 public:
  PieceClaim(const Sweep& sweep, const Piece& piece);
  ~PieceClaim();
  PieceClaim(const PieceClaim&) = delete;
  PieceClaim& operator=(const PieceClaim&) = delete;

  /// False where another process is at it.
  bool is_ours() const { return ours_; }

 private:
  int descriptor_ = -1;
  bool ours_ = true;
};

/// Simulates what is missing of a piece and writes it; also where `check` has thrown, with the rows
/// that are done.
///
/// @param check  called at every tick; may throw
/// @param done   called after each row
/// @throws  whatever `check` throws, and as read_piece
void run_piece(const Sweep& sweep, const Piece& piece, Runner& runner,
               const std::function<void()>& check, const std::function<void()>& done);

}  // namespace headpin::sweep
