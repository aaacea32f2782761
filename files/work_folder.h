#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "files/lock.h"

namespace headpin::files {

/// The list of what headpin wrote in a folder, which stands in it.
inline constexpr const char* kList = ".headpin";
/// Its first line.
inline constexpr const char* kListTitle = "headpin wrote these files and may replace them:\n";

/// Reads the list in an open folder, no link followed. A list that a crash cut inside its first line
/// names nothing; so does none in an empty folder.
///
/// @param names  as listed: a file, or a folder with `/` at its end; what lies elsewhere is left out
/// @return       false when there is no list of ours
bool read_list(int folder, std::set<std::string>& names);

/// The first name in an open folder that is none of `names` and no bookkeeping; empty if there is
/// none.
std::string find_foreign(int folder, const std::set<std::string>& names);

/// Opens a folder and follows no link.
/// @param parent  an open folder, or AT_FDCWD
/// @return        -1 and errno when it cannot be
int open_folder(int parent, const std::string& name);

/// Where results are until they are whole: a folder that we made, with a list of what is in it.
///
/// It removes what the list names, one by one, and nothing else; a folder on the list has a list of
/// its own. Links are removed nowhere and followed nowhere. What another one put into it stays, and
/// so does the folder then.
class WorkFolder {
 public:
  /// Makes the folder, or takes one of ours over with what is in it.
  /// @throws std::runtime_error  naming the folder: a link, no folder, not of our making, holding
  ///                             what is not on its list, not to be made
  /// @throws Busy                when another of us uses it
  explicit WorkFolder(std::filesystem::path path);

  /// Unless told to keep it, removes what is on the list, and the folder when it is empty by then.
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

  /// Has the list and the names on the disk.
  void sync() const;

  /// Removes what is on the list.
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

}  // namespace headpin::files
