#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "files/work_folder.h"

namespace headpin::files {

/// A folder of results in which nothing but our own files is ever replaced or removed.
///
/// It carries a list of what we wrote in it, `.headpin`. While work goes on the new files are in a
/// folder inside it, `.headpin.part`; commit() moves the old ones on the list to `.headpin.old`, the
/// new ones to their place, and then removes the old ones. When a move fails, all are moved back;
/// when we are killed or the power fails in the middle, the next of us that works there moves them
/// back. The list is locked, so that two of us never mix in one folder.
class OutputFolder {
 public:
  struct Options {
    bool overwrite = false;                          ///< else our own finished results are refused
    std::vector<std::filesystem::path> others = {};  ///< what must not lie in it: inputs, outputs
  };

  /// @throws std::runtime_error  naming the folder: empty name, no folder, holding what we did not
  ///                             write or one of `others`, finished results there, not to be made
  /// @throws Busy                when another of us is writing there
  OutputFolder(const std::string& path, const Options& options);

  /// Without commit(), removes what was written, and the folder if we made it.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a file of that name: not yet in its place.
  std::filesystem::path file(const std::string& name) { return part_->file(name); }

  /// Gives all files their places and has them on the disk.
  ///
  /// @param last  the file that gets its place after all others, so that it stands for a whole set
  /// @throws std::runtime_error  naming the file that cannot be moved; then the folder is as before
  void commit(const std::string& last);

 private:
  struct Move {
    std::string name;
    const WorkFolder* from;  ///< null: the folder itself
    const WorkFolder* to;
  };
  void make_folder();
  void take_lock();
  void take_back();
  void refuse_foreign(const Options& options) const;
  void sync_parts() const;
  void move(const Move& move, std::vector<Move>& done) const;
  void exchange_files(const std::set<std::string>& names, const std::string& last, WorkFolder& old,
                      std::vector<Move>& done) const;
  std::string move_back(const std::vector<Move>& done) const;
  void give_up() noexcept;
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_;  ///< as the user wrote it, for messages
  std::filesystem::path folder_;
  std::optional<WorkFolder> part_;
  std::set<std::string> ours_;               ///< on the list that stands there
  std::vector<std::filesystem::path> made_;  ///< folders that are new, outermost first
  bool listed_ = false;                      ///< there was a list before us
  int list_ = -1;                            ///< open and locked
  int descriptor_ = -1;                      ///< of the folder
};

}  // namespace headpin::files
