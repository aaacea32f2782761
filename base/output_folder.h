#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/work_folder.h"

namespace headpin::base {

/// A folder for results, in which only files that headpin wrote are replaced or removed.
///
/// The file `.headpin` in the folder lists the files that headpin wrote there. New files are first
/// written to the subfolder `.headpin.part`. commit() moves the old listed files to `.headpin.old`
/// and the new files to their places, and then removes the old ones. When a move fails, all files
/// are moved back. When the process is killed or the power fails during commit(), the next headpin
/// that uses the folder moves them back. The list is locked, so that only one process writes in the
/// folder.
class OutputFolder {
 public:
  struct Options {
    /// Replace earlier results of headpin; else they are refused.
    bool overwrite = false;
    /// Files that must not be in the folder: inputs, other outputs.
    std::vector<std::filesystem::path> others = {};
  };

  /// @throws std::runtime_error  naming the folder: its name is empty or not that of a folder, it
  ///                             contains files that headpin did not write or one of `others`, it
  ///                             has earlier results, or it cannot be created
  /// @throws Busy                when another headpin is writing there
  OutputFolder(const std::string& path, const Options& options);

  /// Without commit(), removes the new files, and the folder if this object created it.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The path to which the caller writes a file of this name before commit().
  std::filesystem::path file(const std::string& name) { return part_->file(name); }

  /// Moves all files to their places and syncs them to the disk.
  ///
  /// @param last  the file that is moved after all others, so that its presence means a complete
  ///              set
  /// @throws std::runtime_error  naming the file that cannot be moved; the folder is then unchanged
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
  std::set<std::string> ours_;               ///< on the existing list
  std::vector<std::filesystem::path> made_;  ///< folders that are new, outermost first
  bool listed_ = false;                      ///< there was a list before
  int list_ = -1;                            ///< open and locked
  int descriptor_ = -1;                      ///< of the folder
};

}  // namespace headpin::base
