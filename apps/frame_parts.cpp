#include "apps/frame_parts.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/child_process.h"
#include "apps/stop.h"
#include "base/hash.h"
#include "base/input_file.h"
#include "base/output_file.h"
#include "base/output_text.h"
#include "base/work_folder.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "what";  // name of the file that says to which job the parts belong
constexpr std::size_t kFewest = 60;    // frames per part: a start of a process costs about ten
constexpr std::size_t kMostParts = 64;

std::string text_of_file(const fs::path& path) {
  constexpr std::size_t kMost = 1'000'000'000;
  return base::read_text(path.string(), kMost);
}

std::string hash_of_file(const std::string& path) {
  const base::InputFile file(path);
  std::vector<std::uint8_t> bytes(1 << 20);
  Fnv hash;
  for (std::size_t at = 0; const std::size_t n = file.read(at, bytes); at += n) {
    for (const std::uint8_t byte : std::span(bytes).first(n)) hash.add(byte);
  }
  return fmt::format("{:016x}", hash.value());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Frames in the notation of --frames: 0-59,70.
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

std::string without_slash(const std::string& folder) {
  return folder.substr(0, folder.find_last_not_of('/') + 1);
}

/// The folder of the parts until they are joined: FOLDER.parts.
class PartsFolder {
 public:
  explicit PartsFolder(const FrameParts& parts) : folder_(without_slash(parts.folder) + ".parts") {
    const std::string what =
        fmt::format("trial {}\ndrawn by {}\nframes {}\nwith {}\n", hash_of_file(parts.trial),
                    parts.made_by, as_ranges(parts.frames), fmt::join(parts.arguments, " "));
    folder_.keep(true);
    if (!parts.resume) folder_.clear();
    const bool begun = folder_.names().contains(kWhat) && fs::exists(folder_.path() / kWhat);
    if (!begun) begin(what);
    if (begun && text_of_file(folder_.path() / kWhat) != what) {
      throw std::runtime_error(folder_.path().string() +
                               ": contains parts of another trial, of other frames, or with other "
                               "drawing options; without --resume they are drawn again");
    }
    folder_.keep(parts.resume);
  }

  fs::path part(std::size_t i) { return folder_.folder(fmt::format("{:05}", i)); }
  bool is_done(std::size_t i) { return fs::exists(part(i) / "frames.csv"); }
  void done() {
    folder_.clear();
    folder_.keep(false);
  }

 private:
  void begin(const std::string& what) {
    try {
      base::OutputFile file(folder_.file(kWhat).string(), {.overwrite = true});
      file.write(what.data(), what.size());
      file.commit();
    } catch (const std::runtime_error& error) {
      folder_.keep(false);
      throw std::runtime_error(
          replaced(error.what(), (folder_.path() / kWhat).string(), folder_.path().string()));
    }
  }

  base::WorkFolder folder_;
};

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);  // the whole text if there is only one line
}

/// Processes that draw one part each.
class Drawers {
 public:
  explicit Drawers(const FrameParts& parts, PartsFolder& folder) : parts_(parts), folder_(folder) {}
  ~Drawers() {
    for (const auto& [process, drawer] : running_) kill(process, SIGTERM);
    for (const auto& [process, drawer] : running_) {
      waitpid(process, nullptr, 0);
      close(drawer.said);
    }
  }
  Drawers(const Drawers&) = delete;
  Drawers& operator=(const Drawers&) = delete;

  std::size_t running() const { return running_.size(); }

  /// @param flow_to  a frame after the others, if the flow to it is wanted
  void begin(std::size_t part, std::span<const std::int64_t> frames,
             const std::optional<std::int64_t>& flow_to) {
    std::string ranges = as_ranges(frames);
    if (flow_to) ranges += fmt::format(",{}", *flow_to);
    std::vector<std::string> words = {
        "headpin", "frames", parts_.trial, "-o", folder_.part(part).string(), "--frames", ranges};
    if (flow_to) words.insert(words.end(), {"--flow-to", fmt::format("{}", *flow_to)});
    words.insert(words.end(), parts_.arguments.begin(), parts_.arguments.end());
    const int in = parts_.trial == "-" ? base::standard_input() : -1;
    const int said = memfd_create("said", MFD_CLOEXEC);  // in memory, because the disk may be full
    const pid_t process =
        said < 0 ? -1 : start_child("/proc/self/exe", words, {.in = in, .err = said}, SIGTERM);
    const int error = errno;
    close(in);
    if (process < 0) {
      close(said);
      throw std::runtime_error(std::string("cannot run headpin itself: ") + std::strerror(error));
    }
    running_.emplace(process, Drawer{part, said});
  }

  /// Waits shortly for one of them to end.
  /// @return  the part that is then finished
  /// @throws  the message of the process if it failed
  std::optional<std::size_t> wait() {
    for (auto it = running_.begin(); it != running_.end(); ++it) {
      const auto [process, drawer] = *it;
      int status = 0;
      if (waitpid(process, &status, WNOHANG) != process) continue;
      running_.erase(it);
      const std::string all = what_it_said(drawer.said);
      check_stop();  // it got the signal too
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return drawer.part;
      // Messages use the final name of a file instead of its name in the part.
      const std::string part = ".parts/" + folder_.part(drawer.part).filename().string();
      const std::string said = replaced(last_line(all), part, "");
      const std::string start = "headpin frames: ";
      if (said.starts_with(start)) throw std::runtime_error(said.substr(start.size()));
      throw std::runtime_error(
          fmt::format("a drawing process ended {}: {}",
                      WIFSIGNALED(status) ? fmt::format("by signal {}", WTERMSIG(status))
                                          : fmt::format("with exit code {}", WEXITSTATUS(status)),
                      said.empty() ? "it said nothing" : said));
    }
    check_stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return std::nullopt;
  }

 private:
  struct Drawer {
    std::size_t part;
    int said;  ///< a file in memory
  };

  static std::string what_it_said(int file) {
    std::string text;
    std::array<std::uint8_t, 4096> bytes{};
    lseek(file, 0, SEEK_SET);
    while (const std::size_t n = base::read_some(file, bytes, "what a process said")) {
      text.append(reinterpret_cast<const char*>(bytes.data()), n);
    }
    close(file);
    return text;
  }

  const FrameParts& parts_;
  PartsFolder& folder_;
  std::map<pid_t, Drawer> running_;
};

/// Makes a hard link to a file, or a copy if a link is not possible.
///
/// @param called  the name of `to` in messages
void put(const fs::path& file, const fs::path& to, const std::string& called) {
  std::error_code failed;
  fs::create_hard_link(file, to, failed);
  if (failed) fs::copy_file(file, to, fs::copy_options::overwrite_existing, failed);
  if (failed) throw std::runtime_error(called + ": cannot be written: " + failed.message());
}

/// @return  how many frames the parts have
std::int64_t put_together(PartsFolder& folder, std::size_t count, const std::string& called,
                          base::OutputFolder& result) {
  base::OutputText index(result.file("frames.csv"));
  std::int64_t frames = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& entry : fs::directory_iterator(folder.part(i))) {
      const std::string name = entry.path().filename().string();
      if (name == "frames.csv") {
        const std::string rows = text_of_file(entry.path());
        index << (i == 0 ? rows : rows.substr(rows.find('\n') + 1));
        frames += std::ranges::count(rows, '\n') - 1;  // less the head
      } else if (!name.starts_with(".") && !(i > 0 && name == "ids.csv")) {
        put(entry.path(), result.file(name), (fs::path(called) / name).string());
      }
    }
  }
  index.close();
  return frames;
}

}  // namespace

DrawnParts draw_in_parts(const FrameParts& parts, base::OutputFolder& result) {
  PartsFolder folder(parts);
  const std::span<const std::int64_t> all = parts.frames;
  const std::size_t size = std::max(kFewest, (all.size() + kMostParts - 1) / kMostParts);
  const std::size_t count = (all.size() + size - 1) / size;
  const auto frames_of = [&](std::size_t i) {
    return all.subspan(i * size, std::min(size, all.size() - i * size));
  };
  const auto flow_to = [&](std::size_t i) {
    return parts.flow && i + 1 < count ? std::optional(frames_of(i + 1).front()) : std::nullopt;
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
      drawers.begin(left[next], frames_of(left[next]), flow_to(left[next]));
      ++next;
      continue;
    }
    if (const std::optional<std::size_t> part = drawers.wait()) {
      drawn += static_cast<std::int64_t>(frames_of(*part).size());
      parts.progress(drawn);
    }
  }
  const std::int64_t frames = put_together(folder, count, parts.folder, result);
  result.commit("frames.csv");
  folder.done();
  return {frames, there};
}

}  // namespace headpin::apps
