#include "files/output_folder.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/output_file.h"

namespace headpin::files {

namespace fs = std::filesystem;

namespace {

// The list of what is ours, and what is not yet in its place.
constexpr const char* kList = ".headpin";
constexpr const char* kPart = ".headpin.part";
const std::string kTitle = "headpin wrote these files and may replace them:\n";

/// Without `/` at the end: DIR/ is DIR.
fs::path without_slash(const std::string& path) {
  const std::size_t last = path.find_last_not_of('/');
  return last == std::string::npos ? path.substr(0, 1) : path.substr(0, last + 1);
}

/// Reads the list of what is ours.
/// @return  false when there is none
bool read_list(const fs::path& path, std::set<std::string>& names) {
  if (!fs::is_regular_file(fs::symlink_status(path))) return false;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line) || line + "\n" != kTitle) return false;
  while (std::getline(file, line)) {
    if (!line.empty() && line.find('/') == std::string::npos) names.insert(line);
  }
  return true;
}

/// Whether `path` is `folder` or in it.
bool lies_in(const fs::path& folder, const fs::path& path) {
  for (fs::path at = fs::weakly_canonical(path);; at = at.parent_path()) {
    if (at == folder) return true;
    if (at == at.parent_path()) return false;
  }
}

std::string text_of(int file) {
  std::string text;
  std::array<char, 4096> bytes{};
  ssize_t n = 0;
  while ((n = pread(file, bytes.data(), bytes.size(), static_cast<off_t>(text.size()))) > 0) {
    text.append(bytes.data(), static_cast<std::size_t>(n));
  }
  return text;
}

/// One name a line.
std::string lines_of(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

bool write_at(int file, const std::string& text, off_t at) {
  return pwrite(file, text.data(), text.size(), at) == static_cast<ssize_t>(text.size());
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path, const Options& options) : path_(path) {
  if (path.empty()) throw std::runtime_error("'': expected a name for the folder, found none");
  if (path == "-") {
    throw std::runtime_error("-: cannot go to standard output; expected the name of a folder");
  }
  try {
    make_folder();
    refuse_foreign(options);  // before anything of ours is put there
    take_lock();
    refuse_foreign(options);
    part_ = folder_ / kPart;
    fs::remove_all(part_);  // of a run that was killed
    fs::create_directory(part_);
  } catch (const fs::filesystem_error& error) {
    give_up();
    throw std::runtime_error(path_ + ": cannot be written: " + error.code().message());
  } catch (...) {
    give_up();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  give_up();
}

void OutputFolder::fail(const std::string& doing) const {
  const int error = errno;
  throw std::runtime_error(path_ + ": " + doing + ": " + std::strerror(error));
}

void OutputFolder::make_folder() {
  folder_ = fs::absolute(follow_links(without_slash(path_)));
  for (fs::path at = folder_; !fs::exists(fs::symlink_status(at)); at = at.parent_path()) {
    made_.insert(made_.begin(), at);
  }
  for (std::size_t i = 0; i < made_.size(); ++i) {
    if (mkdir(made_[i].c_str(), 0777) == 0) continue;
    const int error = errno;
    made_.resize(i);  // the rest was never there, or another one made it
    if (error == EEXIST) break;
    errno = error;
    fail("cannot be made");
  }
  if (!fs::is_directory(folder_)) {
    throw std::runtime_error(path_ + ": is a file; expected the name of a folder");
  }
  folder_ = fs::canonical(folder_);
}

void OutputFolder::refuse_foreign(const Options& options) const {
  for (const fs::path& other : options.others) {
    if (lies_in(folder_, other)) {
      throw std::runtime_error(path_ + ": holds " + other.string() +
                               ", which is used by this very command; expected another folder");
    }
  }
  std::set<std::string> ours;
  const bool listed = read_list(folder_ / kList, ours);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    const bool bookkeeping = listed && (name == kList || name == kPart);
    if (bookkeeping || (ours.contains(name) && fs::is_regular_file(entry.symlink_status()))) {
      continue;
    }
    throw std::runtime_error(path_ + ": holds " + name +
                             ", which headpin did not write there; expected a new or empty folder");
  }
  if (!ours.empty() && !options.overwrite) {
    throw std::runtime_error(path_ + ": exists already; --force replaces what headpin wrote there");
  }
}

/// Opens and locks the list; one that was removed in between is not the one that counts.
void OutputFolder::take_lock() {
  const fs::path path = folder_ / kList;
  listed_ = fs::exists(path);
  struct stat opened {
  }, named{};
  do {
    if (list_ >= 0) close(list_);
    list_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (list_ < 0) fail("cannot be written");
    if (!lock(list_)) {
      close(std::exchange(list_, -1));
      throw Busy(path_ + ": another headpin is writing there");
    }
  } while (fstat(list_, &opened) != 0 || stat(path.c_str(), &named) != 0 ||
           opened.st_ino != named.st_ino);
  if (text_of(list_).empty() && !write_at(list_, kTitle, 0)) fail("cannot be written");
  read_list(path, ours_);
}

void OutputFolder::commit(const std::string& last) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(part_)) {
    names.insert(entry.path().filename().string());
  }
  // From here on old and new are ours, whatever happens. The list may only grow while it can still
  // be cut back, and shrinks where it needs no new space.
  const std::string list = text_of(list_);
  if (!write_at(list_, lines_of(names), static_cast<off_t>(list.size()))) {
    const int error = errno;
    [[maybe_unused]] const int cut = ftruncate(list_, static_cast<off_t>(list.size()));
    errno = error;
    fail("cannot be written");
  }
  unlink((folder_ / last).c_str());
  for (const std::string& name : ours_) unlink((folder_ / name).c_str());
  const auto move = [&](const std::string& name) {
    if (rename_new(part_ / name, folder_ / name) != 0) fail("cannot move " + name + " there");
  };
  for (const std::string& name : names) {
    if (name != last) move(name);
  }
  move(last);
  const std::string now = kTitle + lines_of(names);
  if (!write_at(list_, now, 0) || ftruncate(list_, static_cast<off_t>(now.size())) != 0) {
    fail("cannot be written");
  }
  rmdir(part_.c_str());
  made_.clear();
  listed_ = true;
  close(std::exchange(list_, -1));
}

void OutputFolder::give_up() noexcept {
  std::error_code ignored;
  if (list_ >= 0) {  // the folder is ours alone
    if (!part_.empty()) fs::remove_all(part_, ignored);
    if (!listed_) fs::remove(folder_ / kList, ignored);
    close(std::exchange(list_, -1));
  }
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) rmdir(folder->c_str());
  made_.clear();
}

}  // namespace headpin::files
