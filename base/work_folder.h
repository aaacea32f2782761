#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/lock.h"

namespace headpin::base {

/// The name of the list of files that headpin wrote in a folder.
inline constexpr const char* kList = ".headpin";
/// Its first line.
inline constexpr const char* kListTitle = "headpin wrote these files and may replace them:\n";

/// Reads the list in an open folder without following links. A list whose first line is incomplete
/// because of a crash is empty; so is the list of an empty folder.
///
/// @param names  the listed names: a file, or a folder with `/` at its end; names outside the
///               folder are left out
/// @return       false when there is no list of ours
bool read_list(int folder, std::set<std::string>& names);

/// The first name in an open folder that is neither in `names` nor one of headpin's own lists;
/// empty if there is none.
std::string find_foreign(int folder, const std::set<std::string>& names);

/// @throws std::runtime_error  that a folder for results holds this name of others
[[noreturn]] void fail_of_foreign(const std::string& folder, const std::string& name);

/// Refuses to begin in a folder that holds something of others. Hidden files, such as `.git`, may be
/// there, and files whose names begin with readme, license, licence or copying in any case. A folder
/// that does not exist is as good as an empty one.
///
/// @param names  what belongs there: a file, or a folder with `/` at its end
/// @param given  files to begin from; those that lie there may stay, also in a folder of it, and links
///               to them
/// @throws std::runtime_error  as fail_of_foreign, and if the folder cannot be read
void require_no_foreign(const std::filesystem::path& folder, const std::set<std::string>& names,
                        const std::vector<std::filesystem::path>& given = {});

/// Opens a folder and follows no link.
/// @param parent  an open folder, or AT_FDCWD
/// @return        -1 and errno when it cannot be
int open_folder(int parent, const std::string& name);

/// A folder for unfinished results, made by headpin, with a list of its files.
///
/// It removes only the listed files, one by one; a listed folder has its own list. It neither
/// removes nor follows links. Files from others stay, and the folder then stays too.
class WorkFolder {
 public:
  /// Creates the folder, or takes over an existing one of headpin with its files.
  /// @throws std::runtime_error  naming the folder: it is a link, not a folder or not made by
  ///                             headpin, it contains unlisted files, or it cannot be created
  /// @throws Busy                when another headpin uses it
  explicit WorkFolder(std::filesystem::path path);

  /// Removes the listed files, and then the folder if it is empty, unless keep(true) was called.
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Open.
  int descriptor() const { return folder_; }
  /// On the list.
  const std::set<std::string>& names() const { return names_; }

  /// Puts a name on the list, for a file that is about to be written.
  std::filesystem::path file(const std::string& name);
  /// The same for a folder, an OutputFolder.
  std::filesystem::path folder(const std::string& name);

  /// Syncs the list and the names to the disk.
  void sync() const;

  /// Removes the listed files.
  void clear();
  void keep(bool kept) { keep_ = kept; }

 private:
  std::filesystem::path add(const std::string& name, const std::string& listed);
  void close_all() noexcept;
  [[noreturn]] void fail(const std::string& doing) const;

  std::filesystem::path path_;
  std::set<std::string> names_;
  int folder_ = -1, list_ = -1;
  bool keep_ = false;
};

}  // namespace headpin::base
