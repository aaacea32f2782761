#include "apps/frame_parts.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/stop.h"
#include "engine/hash.h"
#include "files/lock.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "what";  // they are parts of
constexpr std::size_t kFewest = 60;    // frames of a part: starting a process costs some ten
constexpr std::size_t kMostParts = 64;

std::string text_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string hash_of_file(const std::string& path) {
  Fnv hash;
  for (const char c : text_of_file(path)) hash.add(static_cast<std::uint8_t>(c));
  return fmt::format("{:016x}", hash.value());
}

/// As --frames takes them: 0-59,70.
std::string as_ranges(std::span<const std::int64_t> frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    text += fmt::format("{}{}-{}", text.empty() ? "" : ",", frames[i], frames[last]);
    i = last + 1;
  }
  return text;
}

/// Where the parts are. Locked, so that two of us never draw the same ones.
class PartsFolder {
 public:
  explicit PartsFolder(const FrameParts& parts)
      : path_(parts.folder.substr(0, parts.folder.find_last_not_of('/') + 1) + ".parts"),
        resume_(parts.resume) {
    const std::string what =
        fmt::format("trial {}\ndrawn by {}\nframes {}\nwith {}\n", hash_of_file(parts.trial),
                    parts.made_by, as_ranges(parts.frames), fmt::join(parts.arguments, " "));
    if (fs::exists(path_) && !fs::exists(path_ / kWhat)) {
      throw std::runtime_error(path_.string() + ": exists already, and headpin did not make it");
    }
    fs::create_directory(path_);
    lock_ = open((path_ / kWhat).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) {
      throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
    }
    if (!files::lock(lock_)) {
      close(std::exchange(lock_, -1));
      throw files::Busy(path_.string() + ": another headpin is drawing there");
    }
    const std::string found = text_of_file(path_ / kWhat);
    if (resume_ && !found.empty() && found != what) {
      close(std::exchange(lock_, -1));
      throw std::runtime_error(path_.string() +
                               ": holds parts of another trial, of other frames, or drawn "
                               "otherwise; without --resume they are drawn anew");
    }
    if (resume_) {
      keep_ = true;
    } else {
      clear();
    }
    std::ofstream(path_ / kWhat, std::ios::binary | std::ios::trunc) << what;
  }
  ~PartsFolder() {
    std::error_code ignored;
    if (lock_ >= 0 && !keep_) fs::remove_all(path_, ignored);
    if (lock_ >= 0) close(lock_);
  }
  PartsFolder(const PartsFolder&) = delete;
  PartsFolder& operator=(const PartsFolder&) = delete;

  fs::path part(std::size_t i) const { return path_ / fmt::format("{:05}", i); }
  fs::path messages(std::size_t i) const { return path_ / fmt::format("{:05}.txt", i); }
  bool is_done(std::size_t i) const { return fs::exists(part(i) / "frames.csv"); }
  void done() { keep_ = false; }

 private:
  void clear() const {
    for (const auto& entry : fs::directory_iterator(path_)) {
      if (entry.path().filename() != kWhat) fs::remove_all(entry.path());
    }
  }

  fs::path path_;
  bool resume_, keep_ = false;
  int lock_ = -1;
};

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  all.reserve(words.size() + 1);
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);  // all of it where there is one
}

/// Processes that draw, each a part.
class Drawers {
 public:
  explicit Drawers(const FrameParts& parts, const PartsFolder& folder)
      : parts_(parts), folder_(folder) {}
  ~Drawers() {
    for (const auto& [process, part] : running_) kill(process, SIGTERM);
    for (const auto& [process, part] : running_) waitpid(process, nullptr, 0);
  }
  Drawers(const Drawers&) = delete;
  Drawers& operator=(const Drawers&) = delete;

  std::size_t running() const { return running_.size(); }

  void begin(std::size_t part, std::span<const std::int64_t> frames) {
    std::vector<std::string> words = {
        "headpin",  "frames",         parts_.trial, "-o", folder_.part(part).string(),
        "--frames", as_ranges(frames)};
    words.insert(words.end(), parts_.arguments.begin(), parts_.arguments.end());
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, folder_.messages(part).c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
    pid_t process = -1;
    const int error =
        posix_spawn(&process, "/proc/self/exe", &actions, nullptr, pointers(words).data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
      throw std::runtime_error(std::string("cannot run headpin itself: ") + std::strerror(error));
    }
    running_.emplace(process, part);
  }

  /// Waits a little for one of them to end.
  /// @return  the part that is done by that
  /// @throws  what it said when it failed
  std::optional<std::size_t> wait() {
    for (auto it = running_.begin(); it != running_.end(); ++it) {
      const auto [process, part] = *it;
      int status = 0;
      if (waitpid(process, &status, WNOHANG) != process) continue;
      running_.erase(it);
      check_stop();  // it was told too
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return part;
      const std::string said = last_line(text_of_file(folder_.messages(part)));
      const std::string start = "headpin frames: ";
      if (said.starts_with(start)) throw std::runtime_error(said.substr(start.size()));
      throw std::runtime_error(
          fmt::format("a process that drew has ended, {}: {}",
                      WIFSIGNALED(status) ? fmt::format("by signal {}", WTERMSIG(status))
                                          : fmt::format("with exit code {}", WEXITSTATUS(status)),
                      said.empty() ? "it said nothing" : said));
    }
    check_stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return std::nullopt;
  }

 private:
  const FrameParts& parts_;
  const PartsFolder& folder_;
  std::map<pid_t, std::size_t> running_;
};

/// A second name for a file, or a copy of it where that cannot be.
void put(const fs::path& file, const fs::path& to) {
  std::error_code failed;
  fs::create_hard_link(file, to, failed);
  if (failed) fs::copy_file(file, to, fs::copy_options::overwrite_existing);
}

void put_together(const PartsFolder& folder, std::size_t count, const fs::path& to) {
  std::ofstream index(to / "frames.csv", std::ios::binary);
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& entry : fs::directory_iterator(folder.part(i))) {
      const std::string name = entry.path().filename().string();
      if (name == "frames.csv") {
        const std::string rows = text_of_file(entry.path());
        index << (i == 0 ? rows : rows.substr(rows.find('\n') + 1));
      } else if (!name.starts_with(".") && !(i > 0 && name == "ids.csv")) {
        put(entry.path(), to / name);
      }
    }
  }
  index.close();
  if (!index) throw std::runtime_error((to / "frames.csv").string() + ": cannot be written");
}

}  // namespace

std::int64_t draw_in_parts(const FrameParts& parts, files::OutputFolder& result) {
  PartsFolder folder(parts);
  const std::span<const std::int64_t> all = parts.frames;
  const std::size_t size = std::max(kFewest, (all.size() + kMostParts - 1) / kMostParts);
  const std::size_t count = (all.size() + size - 1) / size;
  const auto frames_of = [&](std::size_t i) {
    return all.subspan(i * size, std::min(size, all.size() - i * size));
  };
  std::int64_t drawn = 0;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < count; ++i) {
    if (folder.is_done(i)) {
      drawn += static_cast<std::int64_t>(frames_of(i).size());
    } else {
      left.push_back(i);
    }
  }
  const std::int64_t there = drawn;
  Drawers drawers(parts, folder);
  for (std::size_t next = 0; next < left.size() || drawers.running() > 0;) {
    if (next < left.size() && drawers.running() < static_cast<std::size_t>(parts.jobs)) {
      drawers.begin(left[next], frames_of(left[next]));
      ++next;
      continue;
    }
    if (const std::optional<std::size_t> part = drawers.wait()) {
      drawn += static_cast<std::int64_t>(frames_of(*part).size());
      parts.progress(drawn);
    }
  }
  put_together(folder, count, result.part());
  result.commit("frames.csv");
  folder.done();
  return there;
}

}  // namespace headpin::apps
