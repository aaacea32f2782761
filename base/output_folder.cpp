#include "base/output_folder.h"

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/output_file.h"

namespace headpin::base {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOld = ".headpin.old";    // files being replaced, which may be moved back
constexpr const char* kGone = ".headpin.gone";  // files that were replaced
const std::string kTitle = kListTitle;

/// Removes `/` at the end: DIR/ becomes DIR.
fs::path without_slash(const std::string& path) {
  const std::size_t last = path.find_last_not_of('/');
  return last == std::string::npos ? path.substr(0, 1) : path.substr(0, last + 1);
}

/// Whether a path is `folder` or in it, both canonical.
bool lies_in(const fs::path& folder, const fs::path& path) {
  for (fs::path at = path;; at = at.parent_path()) {
    if (at == folder) return true;
    if (at == at.parent_path()) return false;
  }
}

bool exists_in(int folder, const std::string& name) {
  struct stat is {};
  return fstatat(folder, name.c_str(), &is, AT_SYMLINK_NOFOLLOW) == 0;
}

/// One name a line.
std::string lines_of(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

bool write_at(int file, std::string_view text, off_t at) {
  while (!text.empty()) {
    const ssize_t n = pwrite(file, text.data(), text.size(), at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
    at += n;
  }
  return true;
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path, const Options& options) : path_(path) {
  if (path.empty()) throw std::runtime_error("'': expected a name for the folder, found none");
  if (path == "-") {
    throw std::runtime_error("-: cannot go to standard output; expected the name of a folder");
  }
  try {
    make_folder();
    std::set<std::string> names;
    if (read_list(descriptor_, names) && exists_in(descriptor_, kOld)) {
      take_lock();
      take_back();
    }
    refuse_foreign(options);  // before this writes anything there
    if (list_ < 0) take_lock();
    refuse_foreign(options);
    part_.emplace(folder_ / kPartFolder);
    part_->clear();  // files of a killed run
    if (exists_in(descriptor_, kGone)) WorkFolder(folder_ / kGone);
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
  const auto is_missing = [&](const fs::path& path) {
    struct stat is {};
    if (stat(path.c_str(), &is) == 0) return false;
    if (errno != ENOENT && errno != ENOTDIR)
      fail("cannot be reached");  // a path without access may exist
    return true;
  };
  for (fs::path at = folder_; is_missing(at); at = at.parent_path()) {
    made_.insert(made_.begin(), at);
  }
  for (std::size_t i = 0; i < made_.size();) {
    if (mkdir(made_[i].c_str(), 0777) == 0) {
      ++i;
    } else if (errno == EEXIST) {  // another process made it meanwhile
      made_.erase(made_.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      const int error = errno;
      made_.resize(i);  // the others were not made
      errno = error;
      fail("cannot be made");
    }
  }
  if (!fs::is_directory(folder_)) {
    throw std::runtime_error(path_ + ": is a file; expected the name of a folder");
  }
  folder_ = fs::canonical(folder_);
  descriptor_ = open_folder(AT_FDCWD, folder_.string());
  if (descriptor_ < 0) fail("cannot be opened");
}

void OutputFolder::refuse_foreign(const Options& options) const {
  for (const fs::path& other : options.others) {
    if (other == "-") continue;  // standard input is in no folder
    std::error_code unknown;
    const fs::path canonical = fs::weakly_canonical(other, unknown);
    if (unknown) throw std::runtime_error(other.string() + ": " + unknown.message());
    if (lies_in(folder_, canonical)) {
      throw std::runtime_error(path_ + ": holds " + other.string() +
                               ", which this command uses; expected another folder");
    }
  }
  std::set<std::string> ours;
  const bool listed = read_list(descriptor_, ours);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    const bool book = name == kList || name == kPartFolder || name == kOld || name == kGone;
    if ((listed && book) || (ours.contains(name) && fs::is_regular_file(entry.symlink_status()))) {
      continue;
    }
    fail_of_foreign(path_, name);
  }
  if (!ours.empty() && !options.overwrite) {
    throw Exists(path_ + ": exists already");
  }
}

/// Opens and locks the list. Repeats this if the list was removed in between.
void OutputFolder::take_lock() {
  const fs::path path = folder_ / kList;
  listed_ = exists_in(descriptor_, kList);
  struct stat opened {
  }, named{};
  do {
    if (list_ >= 0) close(list_);
    list_ = openat(descriptor_, kList, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (list_ < 0) fail("cannot be written");
    if (!lock(list_)) {
      close(std::exchange(list_, -1));
      throw Busy(path_ + ": another headpin is writing there");
    }
  } while (fstat(list_, &opened) != 0 || stat(path.c_str(), &named) != 0 ||
           opened.st_ino != named.st_ino);
  if (opened.st_size < static_cast<off_t>(kTitle.size()) && !write_at(list_, kTitle, 0)) {
    fail("cannot be written");
  }
  read_list(descriptor_, ours_);
}

/// After a crash within commit(): moves the old files back, and the new files to their working
/// folder.
void OutputFolder::take_back() {
  WorkFolder old(folder_ / kOld);
  old.keep(true);
  std::vector<Move> done;
  if (exists_in(descriptor_, kPartFolder)) {
    WorkFolder part(folder_ / kPartFolder);
    part.keep(true);
    for (const std::string& name : part.names()) {
      const bool came = !exists_in(part.descriptor(), name) && exists_in(descriptor_, name);
      const bool was_there = old.names().contains(name) && !exists_in(old.descriptor(), name);
      if (came && !was_there) move({name, nullptr, &part}, done);
    }
    part.keep(false);
  }
  for (const std::string& name : old.names()) {
    if (exists_in(old.descriptor(), name)) move({name, &old, nullptr}, done);
  }
  if (fsync(descriptor_) != 0) fail("cannot be written");
  old.keep(false);
}

void OutputFolder::move(const Move& move, std::vector<Move>& done) const {
  const int from = move.from ? move.from->descriptor() : descriptor_;
  const int to = move.to ? move.to->descriptor() : descriptor_;
  if (rename_new(from, move.name, to, move.name) != 0) fail("cannot move " + move.name + " there");
  done.push_back(move);
}

/// Syncs the new files to the disk before they replace others.
void OutputFolder::sync_parts() const {
  constexpr std::size_t kFew = 32;  // a folder of 2000 pictures would wait for the disk 2000 times
  if (part_->names().size() > kFew) {
    if (syncfs(part_->descriptor()) != 0) fail("cannot be written");
    return;
  }
  for (const std::string& name : part_->names()) {
    const int file = openat(part_->descriptor(), name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) fail(name + " cannot be written");
    const int failed = fsync(file);
    const int error = errno;
    close(file);
    errno = error;
    if (failed != 0) fail(name + " cannot be written");
  }
  part_->sync();
}

/// Moves the existing files of headpin to the folder of old files, and the new files to their
/// places.
void OutputFolder::exchange_files(const std::set<std::string>& names, const std::string& last,
                                  WorkFolder& old, std::vector<Move>& done) const {
  std::set<std::string> there;
  for (const std::string& name : ours_) {
    if (!exists_in(descriptor_, name)) continue;
    old.file(name);
    there.insert(name);
  }
  old.sync();
  if (fsync(descriptor_) != 0) fail("cannot be written");
  // The file that marks a complete set is removed first and comes last.
  if (there.contains(last)) move({last, nullptr, &old}, done);
  for (const std::string& name : there) {
    if (name != last) move({name, nullptr, &old}, done);
  }
  for (const std::string& name : names) {
    if (name != last) move({name, &*part_, nullptr}, done);
  }
  move({last, &*part_, nullptr}, done);
  // From here on, the new files are valid instead of the old ones.
  if (fsync(descriptor_) != 0 || rename_new(descriptor_, kOld, descriptor_, kGone) != 0) {
    fail("cannot be written");
  }
}

/// @return  the names of the files that could not be moved back, each after a space
std::string OutputFolder::move_back(const std::vector<Move>& done) const {
  std::string stuck;
  for (auto it = done.rbegin(); it != done.rend(); ++it) {
    std::vector<Move> back;
    try {
      move({it->name, it->to, it->from}, back);
    } catch (const std::runtime_error&) {
      stuck += " " + it->name;
    }
  }
  return stuck;
}

void OutputFolder::commit(const std::string& last) {
  sync_parts();
  const std::set<std::string> names = part_->names();
  // From here on, the list has old and new files, whatever happens. It grows only while it can
  // still be truncated, and it shrinks only where this needs no new space.
  const std::string before = kTitle + lines_of(ours_);
  const auto cut_back = [&] {
    const int error = errno;
    [[maybe_unused]] const int cut = ftruncate(list_, static_cast<off_t>(before.size()));
    errno = error;
  };
  if (!write_at(list_, before + lines_of(names), 0) || fsync(list_) != 0) {
    cut_back();
    fail("cannot be written");
  }
  std::optional<WorkFolder> old(std::in_place, folder_ / kOld);
  std::vector<Move> done;
  try {
    exchange_files(names, last, *old, done);
  } catch (const std::runtime_error& error) {
    const std::string stuck = move_back(done);
    if (stuck.empty()) {
      cut_back();
      throw;
    }
    // All three show the next headpin where the files belong.
    old->keep(true);
    part_->keep(true);
    listed_ = true;
    throw std::runtime_error(std::string(error.what()) + "; and these could not be moved back:" +
                             stuck + "; the old ones are in " + (folder_ / kOld).string());
  }
  // The rest is removed now or by the next headpin. Until the new name of the old folder is on the
  // disk, the empty folder of parts shows which files are the new ones.
  old->keep(true);
  old.reset();
  part_->keep(true);
  if (fsync(descriptor_) != 0) fail("cannot be written");
  part_->keep(false);
  part_.reset();
  const std::string now = kTitle + lines_of(names);
  if (!write_at(list_, now, 0) || ftruncate(list_, static_cast<off_t>(now.size())) != 0 ||
      fsync(list_) != 0) {
    fail("cannot be written");
  }
  WorkFolder(folder_ / kGone);
  made_.clear();
  listed_ = true;
  close(std::exchange(list_, -1));
}

void OutputFolder::give_up() noexcept {
  if (list_ >= 0) {  // this process has the folder locked
    part_.reset();
    if (!listed_) unlinkat(descriptor_, kList, 0);
    close(std::exchange(list_, -1));
  }
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) rmdir(folder->c_str());
  made_.clear();
}

}  // namespace headpin::base
