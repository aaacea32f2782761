#include "base/work_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/input_file.h"
#include "base/output_file.h"

namespace headpin::base {

namespace fs = std::filesystem;

namespace {

/// The internal folders of an OutputFolder; each is a WorkFolder.
constexpr std::array<const char*, 3> kBooks = {".headpin.part", ".headpin.old", ".headpin.gone"};

std::string text_in(int folder, const char* name) {
  const int file = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) throw std::runtime_error(std::string(name) + ": " + std::strerror(errno));
  std::string text;
  try {
    std::array<std::uint8_t, 4096> bytes{};
    while (const std::size_t n = read_some(file, bytes, name)) {
      text.append(reinterpret_cast<const char*>(bytes.data()), n);
    }
  } catch (...) {
    close(file);
    throw;
  }
  close(file);
  return text;
}

/// Appends text to a file.
bool append(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool is_regular(int folder, const std::string& name) {
  struct stat is {};
  return fstatat(folder, name.c_str(), &is, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(is.st_mode);
}

/// All entries of an open folder. Throws if it cannot be read, because it may not be empty.
std::vector<std::string> entries(int folder) {
  const auto fail = [] {
    throw std::runtime_error(std::string("a folder cannot be read: ") + std::strerror(errno));
  };
  const int again = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (again < 0) fail();
  const std::unique_ptr<DIR, int (*)(DIR*)> all(fdopendir(again), &closedir);
  if (all == nullptr) {
    close(again);
    fail();
  }
  std::vector<std::string> names;
  for (;;) {
    errno = 0;
    const dirent* one = readdir(all.get());
    if (one == nullptr) break;
    const std::string_view name = one->d_name;
    if (name != "." && name != "..") names.emplace_back(name);
  }
  if (errno != 0) fail();
  return names;
}

/// Whether `name` is the temporary name of an OutputFile for one of `names`: NAME.PROCESS-N.part.
bool is_part_of(const std::string& name, const std::set<std::string>& names) {
  constexpr std::string_view kEnd = ".part";
  if (!name.ends_with(kEnd)) return false;
  const std::string stem = name.substr(0, name.size() - kEnd.size());
  const std::size_t dot = stem.rfind('.');
  return dot != std::string::npos && names.contains(stem.substr(0, dot)) &&
         stem.find_first_not_of("0123456789-", dot + 1) == std::string::npos;
}

/// Whether an entry of an open folder is neither in `names` nor one of headpin's own lists.
bool is_foreign(int folder, const std::string& name, const std::set<std::string>& names) {
  if (name == kList || std::ranges::count(kBooks, name) > 0) return false;
  const bool file = names.contains(name) || is_part_of(name, names);
  return !(file && is_regular(folder, name)) && !names.contains(name + "/");
}

/// Whether an entry of an open folder tells of it: a hidden one, or a file or link such as
/// readme.md.
bool tells_of_its_folder(int folder, const std::string& entry) {
  if (entry.starts_with('.')) return true;
  std::string name = entry;
  for (char& c : name) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  constexpr std::array<std::string_view, 4> kBegins = {"readme", "license", "licence", "copying"};
  const auto begins = [&name](std::string_view one) { return name.starts_with(one); };
  struct stat is {};
  return std::ranges::any_of(kBegins, begins) &&
         fstatat(folder, entry.c_str(), &is, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISDIR(is.st_mode);
}

/// The entries of a folder that these files are, or lie in, by their names or with links followed.
std::set<std::string> entries_with(const fs::path& folder, const std::vector<fs::path>& files) {
  std::set<std::string> names;
  const auto insert = [&](const fs::path& file, const fs::path& root) {
    names.insert(file.lexically_relative(root).begin()->string());  // `..` outside
  };
  const fs::path named = fs::absolute(folder).lexically_normal();
  const fs::path root = fs::canonical(folder);
  for (const fs::path& file : files) {
    const fs::path whole = fs::absolute(file);
    insert(fs::weakly_canonical(whole.parent_path()) / file.filename(), root);
    insert(whole.lexically_normal(), named);
  }
  return names;
}

/// Removes the listed files of an open folder, and last the list.
void remove_listed(int folder) {
  std::set<std::string> names;
  if (!read_list(folder, names)) return;
  for (const std::string& name : entries(folder)) {
    const bool ours = names.contains(name) || is_part_of(name, names);
    if (ours && is_regular(folder, name)) unlinkat(folder, name.c_str(), 0);
  }
  std::vector<std::string> folders(kBooks.begin(), kBooks.end());
  for (const std::string& name : names) {
    if (name.ends_with('/')) folders.push_back(name.substr(0, name.size() - 1));
  }
  for (const std::string& name : folders) {
    const int inner = open_folder(folder, name);
    if (inner < 0) continue;
    remove_listed(inner);
    close(inner);
    unlinkat(folder, name.c_str(), AT_REMOVEDIR);  // fails if it contains other files
  }
  if (is_regular(folder, kList)) unlinkat(folder, kList, 0);
}

}  // namespace

bool read_list(int folder, std::set<std::string>& names) {
  if (!is_regular(folder, kList)) return entries(folder).empty();
  const std::string text = text_in(folder, kList);
  const std::string_view title = kListTitle;
  if (title.starts_with(text)) return true;
  if (!text.starts_with(title)) return false;
  for (std::size_t at = title.size(), end = 0; (end = text.find('\n', at)) != std::string::npos;
       at = end + 1) {
    const std::string name = text.substr(at, end - at);
    const std::size_t slash = name.find('/');
    const bool here = slash == std::string::npos || slash == name.size() - 1;
    if (here && !name.empty() && !name.starts_with("./") && !name.starts_with("../") &&
        name != "." && name != ".." && name != "/") {
      names.insert(name);
    }
  }
  return true;
}

std::string find_foreign(int folder, const std::set<std::string>& names) {
  for (const std::string& name : entries(folder)) {
    if (is_foreign(folder, name, names)) return name;
  }
  return "";
}

void fail_of_foreign(const std::string& folder, const std::string& name) {
  throw std::runtime_error(folder + ": holds " + name +
                           ", which headpin did not write there; expected a new or empty folder");
}

void require_no_foreign(const fs::path& folder, const std::set<std::string>& names,
                        const std::vector<fs::path>& given) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) {
    if (errno == ENOENT || errno == ENOTDIR) return;  // who makes the folder says what is wrong
    throw std::runtime_error(folder.string() + ": cannot be read: " + std::strerror(errno));
  }
  std::set<std::string> foreign;  // so that the first by its name is told
  try {
    const std::set<std::string> known = entries_with(folder, given);
    for (const std::string& name : entries(opened)) {
      const auto leads_there = [&](const fs::path& file) { return same_file(folder / name, file); };
      if (tells_of_its_folder(opened, name) || known.contains(name)) continue;
      if (std::ranges::any_of(given, leads_there)) continue;
      if (is_foreign(opened, name, names)) foreign.insert(name);
    }
  } catch (...) {
    close(opened);
    throw;
  }
  close(opened);
  if (!foreign.empty()) fail_of_foreign(folder.string(), *foreign.begin());
}

int open_folder(int parent, const std::string& name) {
  return openat(parent, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

void WorkFolder::fail(const std::string& doing) const {
  const int error = errno;
  // Messages name the OutputFolder instead of its internal folders.
  const bool book = std::ranges::count(kBooks, path_.filename().string()) > 0;
  throw std::runtime_error((book ? path_.parent_path() : path_).string() + ": " + doing + ": " +
                           std::strerror(error));
}

WorkFolder::WorkFolder(fs::path path) : path_(std::move(path)) {
  const bool made = mkdir(path_.c_str(), 0777) == 0;
  if (!made && errno != EEXIST) fail("cannot be made");
  try {
    folder_ = open_folder(AT_FDCWD, path_.string());
    if (folder_ < 0 && (errno == ELOOP || errno == ENOTDIR)) {
      throw std::runtime_error(path_.string() + ": exists already, and headpin did not make it");
    }
    if (folder_ < 0) fail("cannot be opened");
    if (!read_list(folder_, names_)) {
      throw std::runtime_error(path_.string() + ": exists already, and headpin did not make it");
    }
    if (const std::string foreign = find_foreign(folder_, names_); !foreign.empty()) {
      throw std::runtime_error(path_.string() + ": holds " + foreign +
                               ", which headpin did not write there; expected it elsewhere");
    }
    list_ = openat(folder_, kList, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (list_ < 0) fail("cannot be written");
    if (!lock(list_)) throw Busy(path_.string() + ": another headpin is writing there");
    struct stat is {};
    const std::string_view title = kListTitle;
    if (fstat(list_, &is) != 0) fail("cannot be written");
    if (is.st_size < static_cast<off_t>(title.size()) &&
        (ftruncate(list_, 0) != 0 || !append(list_, title))) {
      fail("cannot be written");
    }
    char last = '\n';  // otherwise a crash cut the list inside a name
    if (fstat(list_, &is) != 0 || pread(list_, &last, 1, is.st_size - 1) != 1 ||
        (last != '\n' && !append(list_, "\n"))) {
      fail("cannot be written");
    }
  } catch (...) {
    const bool ours = list_ >= 0 && made;
    if (ours) remove_listed(folder_);
    close_all();
    if (made) rmdir(path_.c_str());
    throw;
  }
}

WorkFolder::~WorkFolder() {
  if (!keep_) {
    try {
      remove_listed(folder_);
    } catch (const std::exception&) {  // the list cannot be read: its files stay
    }
  }
  close_all();
  if (!keep_) rmdir(path_.c_str());
}

void WorkFolder::close_all() noexcept {
  if (list_ >= 0) close(std::exchange(list_, -1));
  if (folder_ >= 0) close(std::exchange(folder_, -1));
}

fs::path WorkFolder::add(const std::string& name, const std::string& listed) {
  if (names_.insert(listed).second && !append(list_, listed + "\n")) fail("cannot be written");
  return path_ / name;
}

fs::path WorkFolder::file(const std::string& name) {
  return add(name, name);
}

fs::path WorkFolder::folder(const std::string& name) {
  return add(name, name + "/");
}

void WorkFolder::sync() const {
  if (fsync(list_) != 0 || fsync(folder_) != 0) fail("cannot be written");
}

void WorkFolder::clear() {
  // The list is cleared last, in the same file, because the lock is on this file.
  for (const std::string& name : names_) {
    if (!name.ends_with('/')) {
      if (is_regular(folder_, name)) unlinkat(folder_, name.c_str(), 0);
      continue;
    }
    const std::string bare = name.substr(0, name.size() - 1);
    const int inner = open_folder(folder_, bare);
    if (inner < 0) continue;
    remove_listed(inner);
    close(inner);
    unlinkat(folder_, bare.c_str(), AT_REMOVEDIR);
  }
  for (const std::string& name : entries(folder_)) {
    if (is_part_of(name, names_) && is_regular(folder_, name)) {
      unlinkat(folder_, name.c_str(), 0);
    }
  }
  if (const std::string left = find_foreign(folder_, {}); !left.empty()) {
    throw std::runtime_error((path_ / left).string() + ": cannot be removed");
  }
  if (ftruncate(list_, static_cast<off_t>(std::strlen(kListTitle))) != 0) fail("cannot be written");
  names_.clear();
}

}  // namespace headpin::base
