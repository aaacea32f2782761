#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "files/lock.h"

namespace headpin::files {

/// A folder of results in which nothing but our own files is ever replaced or removed.
///
/// It carries a list of what we wrote in it, `.headpin`. While work goes on the new files are in a
/// folder inside it, `.headpin.part`; commit() removes the old ones on the list and puts the new
/// ones in their place. The list is locked, so that two of us never mix in one folder.
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

  /// Where to write the files, under their final names.
  const std::filesystem::path& part() const { return part_; }

  /// @param last  the file that gets its place after all others, so that it stands for a whole set
  /// @throws std::runtime_error  naming the file that cannot be moved
  void commit(const std::string& last);

 private:
  void make_folder();
  void take_lock();
  void refuse_foreign(const Options& options) const;
  void give_up() noexcept;
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_;  ///< as the user wrote it, for messages
  std::filesystem::path folder_, part_;
  std::set<std::string> ours_;               ///< on the list that stands there
  std::vector<std::filesystem::path> made_;  ///< folders that are new, outermost first
  bool listed_ = false;                      ///< there was a list before us
  int list_ = -1;                            ///< open and locked
};

}  // namespace headpin::files
