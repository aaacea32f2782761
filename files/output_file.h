#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "files/lock.h"

namespace headpin::files {

/// Of an OutputFolder: what is in it is not yet in its place.
inline constexpr const char* kPartFolder = ".headpin.part";

/// A file that gets its name when it is whole.
///
/// A regular file is written beside its place, under a name that nothing else has
/// (NAME.PROCESS-N.part), and renamed by commit(); what stood there keeps its permissions. What
/// killed runs have left under such names is removed, and said on standard error. Symbolic
/// links are followed, not replaced. A device or a named pipe is written into. `-` is standard
/// output, where that is allowed: from then on, what is said on standard output goes to standard
/// error.
class OutputFile {
 public:
  struct Options {
    bool overwrite = false;        ///< else a file that is there is refused
    bool live = false;             ///< under its name from the start, whatever becomes of us
    bool standard_output = false;  ///< `-` is allowed
    bool regular = false;          ///< nothing but a regular file will do
    bool durable = true;           ///< commit() has it on the disk, before its name and with it
    std::vector<std::filesystem::path> inputs = {};  ///< never to be written to
  };

  /// @throws std::runtime_error  naming the path: empty, a folder, an input, there already,
  ///                             write-protected, or not to be created
  /// @throws Busy                when it is being written by another of us
  OutputFile(std::string path, Options options);

  /// Without commit(), removes what was written, unless it is live.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Open for writing.
  int descriptor() const { return descriptor_; }
  /// The name it has while it is written, for other programs to write to.
  const std::filesystem::path& part() const { return part_; }

  /// Writes all of it.
  /// @throws std::runtime_error  naming the path and the reason
  void write(const void* data, std::size_t size);

  /// Whether a live file can still be found: under its name, as long as what was written to it.
  ///
  /// @param size  what was written to it in all
  /// @throws std::runtime_error  saying what has become of it: deleted, replaced, moved or cut
  void require_kept(std::int64_t size) const;

  /// Cuts what was written to `size` bytes.
  bool cut_back(std::int64_t size) const;

  /// Has what was written so far on the disk.
  /// @throws std::runtime_error  when the disk did not take it
  void sync() const;

  /// Has it on the disk, closes it and gives it its name.
  ///
  /// @throws std::runtime_error  when the disk did not take it, another file has come to stand
  ///                             there, or a live one is no longer there
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
  int folder_ = -1;             ///< where it will be, links followed; -1: nothing gets a name
  std::string target_, named_;  ///< there: its name in the end, and now
  std::filesystem::path part_;
  int descriptor_ = -1;
};

/// Whether two names lead to the same file, through links of any kind.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Gives a file in an open folder another name unless something has it; -1 and errno as rename().
int rename_new(int from_folder, const std::string& from, int to_folder, const std::string& to);

/// Where a name leads to: symbolic links followed, also one that points to nothing yet.
/// @throws std::runtime_error  for links in a circle, and for one that another user has put into a
///                             folder where all may write
std::filesystem::path follow_links(std::filesystem::path path);

}  // namespace headpin::files
