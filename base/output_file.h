#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/lock.h"

namespace headpin::base {

/// The folder for the unfinished files of an OutputFolder.
inline constexpr const char* kPartFolder = ".headpin.part";

/// A file that gets its name when it is complete.
///
/// A regular file is written in the same folder under a unique name (NAME.PROCESS-N.part), and
/// commit() renames it; it gets the permissions of the file that it replaces. Files that killed
/// runs left under such names are removed, with a message on standard error. Symbolic links are
/// followed, not replaced. Data for a device or a named pipe are written into it. `-` is standard
/// output, if that is allowed; other text for standard output then goes to standard error.
class OutputFile {
 public:
  struct Options {
    bool overwrite = false;  ///< replace an existing file; else it is refused
    /// Has its final name from the start, so that a crash leaves it there.
    bool live = false;
    bool standard_output = false;  ///< `-` is allowed
    bool regular = false;          ///< accept only a regular file
    bool durable = true;           ///< commit() syncs the file, and then its name, to the disk
    std::vector<std::filesystem::path> inputs = {};  ///< never to be written to
    bool locked = false;  ///< the caller has locked the file that is replaced, until after commit()
  };

  /// @throws Exists              naming the path: it is there, and not to be overwritten
  /// @throws std::runtime_error  naming the path: it is empty, a folder, an input or write-protected,
  ///                             or cannot be created
  /// @throws Busy                when another headpin is writing it
  OutputFile(std::string path, Options options);

  /// Without commit(), removes the file, unless it is live.
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  /// As it was given, also `-`.
  const std::string& path() const { return path_; }
  /// Whether it has its final name from the start.
  bool live() const { return options_.live; }
  /// Open for writing.
  int descriptor() const { return descriptor_; }
  /// The name of the file while it is written, for other programs that write to it.
  const std::filesystem::path& part() const { return part_; }

  /// Writes all of it.
  /// @throws std::runtime_error  naming the path and the reason
  void write(const void* data, std::size_t size);

  /// Checks that a live file still has its name and its size.
  ///
  /// @param size  number of bytes that were written to it
  /// @throws std::runtime_error  saying what happened to it: deleted, replaced, moved or truncated
  void require_kept(std::int64_t size) const;

  /// Bytes that the file has now, whoever wrote or truncated it.
  /// @throws std::runtime_error  when the disk fails
  std::int64_t length() const;

  /// Truncates the file to `size` bytes.
  bool cut_back(std::int64_t size) const;

  /// Syncs the bytes that were written so far to the disk.
  /// @throws std::runtime_error  when the disk fails
  void sync() const;

  /// Syncs the file to the disk, closes it and renames it.
  ///
  /// @throws std::runtime_error  when the disk fails, when another file got the name in the
  ///                             meantime, or when a live file has vanished
  void commit();

 private:
  [[noreturn]] void fail(const std::string& doing) const;
  void open_special();
  void open_beside(bool exists);
  void open_in_folder(bool exists, const std::filesystem::path& folder);
  void clear_away(const std::filesystem::path& folder) const;
  void rename_to_target();
  void remove_part();
  void close_all();
  void sync_folder() const;

  std::string path_;  ///< as the user wrote it
  std::string said_;  ///< the same, in messages
  Options options_;
  int folder_ = -1;             ///< its final folder, links followed; -1: no name is needed
  std::string target_, named_;  ///< in this folder: its final and its present name
  std::filesystem::path part_;
  int descriptor_ = -1;
};

/// Writes a text as the whole file, and completes it.
/// @throws std::runtime_error  as write() and commit()
void write_text(OutputFile file, std::string_view text);

/// Whether two names refer to the same file, through links of any kind.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Renames a file in an open folder, unless the new name exists. Returns -1 with errno like
/// rename().
int rename_new(int from_folder, const std::string& from, int to_folder, const std::string& to);

/// Resolves symbolic links, also one whose target does not exist yet.
/// @throws std::runtime_error  for circular links, and for a link of another user in a folder that
///                             everyone can write to
std::filesystem::path follow_links(std::filesystem::path path);

}  // namespace headpin::base
