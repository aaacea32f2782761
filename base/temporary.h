#pragma once

#include <filesystem>

/// Private files and folders in TMPDIR or /tmp.
namespace headpin::base {

/// Opens a file without a name for reading and writing; it vanishes when it is closed.
/// @throws std::runtime_error  naming the folder
int nameless_file();

/// A private folder. It is removed with all its content.
class PrivateFolder {
 public:
  /// @throws std::runtime_error  naming the folder it should be in
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace headpin::base
