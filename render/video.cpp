#include "render/video.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/temporary.h"

extern char** environ;

namespace headpin::render {

namespace {

/// The nearest fraction of whole numbers up to 255, as text for ffmpeg. If one of the numbers is
/// above 4096, the lossless stream does not decode to its pictures.
std::string ratio(double x) {
  constexpr long kMost = 255;
  long best_over = 1, best_under = 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (long under = 1; under <= kMost; ++under) {
    const long over = std::clamp(std::lround(x * static_cast<double>(under)), 1L, kMost);
    const double off = std::abs(static_cast<double>(over) / static_cast<double>(under) - x);
    if (off >= nearest) continue;
    nearest = off;
    best_over = over;
    best_under = under;
  }
  return std::to_string(best_over) + "/" + std::to_string(best_under);
}

struct CopySize {
  long width, height;
};

/// Of the copy: it has at least 240 lines, square pixels, and even width and height for 4:2:0.
CopySize size_of_copy(int width, int height, double pixel_aspect) {
  const int times = height < 240 ? (240 + height - 1) / height : 1;
  return {2 * std::lround(0.5 * times * width * pixel_aspect), 2 * ((times * height + 1) / 2)};
}

constexpr long kLargestOfH264 = 16384;  // the limit of the H.264 encoder

/// @throws CopyTooLarge  naming it
void require_size_of_copy(const CopySize& copy, const std::string& path) {
  if (copy.width <= kLargestOfH264 && copy.height <= kLargestOfH264) return;
  throw CopyTooLarge("video: the copy " + path + ", which has square pixels, would have " +
                     std::to_string(copy.width) + "x" + std::to_string(copy.height) +
                     " pixels, expected at most " + std::to_string(kLargestOfH264) +
                     " on each side");
}

constexpr int kSoundInput = 3;  // the descriptor of the sound in ffmpeg

void append(std::vector<std::string>& words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
}

std::vector<std::string> arguments(int width, int height, std::int64_t fps, double pixel_aspect,
                                   const std::string& lossless_path, const std::string& copy_path,
                                   bool sound) {
  // With `file:`, because ffmpeg would take the part before a colon for a protocol.
  const std::string lossless = "file:" + lossless_path, copy = "file:" + copy_path;
  const CopySize of_copy = size_of_copy(width, height, pixel_aspect);
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  const std::string scale = "scale=" + std::to_string(of_copy.width) + ":" +
                            std::to_string(of_copy.height) +
                            ":flags=bicubic:out_color_matrix=bt709:out_range=tv,setsar=1";
  std::vector<std::string> words = {"ffmpeg", "-hide_banner", "-nostdin", "-loglevel", "error",
                                    "-xerror", "-y",
                                    // The input.
                                    "-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", size,
                                    "-framerate", std::to_string(fps), "-i", "pipe:0"};
  if (sound) append(words, {"-f", "wav", "-i", "pipe:" + std::to_string(kSoundInput)});
  // The lossless output.
  append(words, {"-map", "0:v"});
  if (sound) append(words, {"-map", "1:a", "-c:a", "pcm_s16le"});
  append(words, {"-vf", "setsar=" + ratio(pixel_aspect) + ":max=255", "-c:v", "libx264rgb",
                 "-preset", "ultrafast", "-qp", "0", "-metadata:s:v:0", "stereo_mode=left_right",
                 "-fflags", "+bitexact", "-f", "matroska", lossless});
  if (copy_path.empty()) return words;
  // The copy, marked for players as side by side.
  append(words, {"-map", "0:v"});
  if (sound) append(words, {"-map", "1:a", "-c:a", "aac", "-b:a", "192k"});
  append(words, {"-vf", scale, "-c:v", "libx264", "-x264-params", "frame-packing=3",
                 // Fast, and a tenth of the size of the lossless file.
                 "-preset", "superfast", "-crf", "18", "-pix_fmt", "yuv420p", "-colorspace",
                 "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-movflags",
                 "+faststart", "-fflags", "+bitexact", "-f", "mp4", copy});
  return words;
}

constexpr int kMostNaps = 200;
constexpr int kNap_ms = 10;  // between two calls of the check

/// Runs ffmpeg between two files; `sound` is a third, or -1. Returns its process id.
int spawn(std::vector<std::string> words, int input, int messages, int sound) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  if (sound >= 0) posix_spawn_file_actions_adddup2(&actions, sound, kSoundInput);
  pid_t process = -1;
  // In its own process group, so that an interrupt from the terminal does not stop ffmpeg.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&process, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(std::string("cannot run ffmpeg, which writes videos: ") +
                             std::strerror(error));
  }
  return process;
}

/// Its last two thousand bytes, on one line.
std::string text_of(int file) {
  std::array<char, 2000> text{};
  const off_t size = lseek(file, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t got = pread(file, text.data(), text.size(), from);
  std::string line(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  while (!line.empty() && line.back() == '\n') line.pop_back();
  std::replace(line.begin(), line.end(), '\n', ';');
  return line;
}

}  // namespace

VideoFiles open_video(const std::filesystem::path& path, base::OutputFile::Options how, bool copy) {
  if (path.extension() != ".mkv") {
    throw std::invalid_argument("video: expected a name that ends in .mkv, found " + path.string());
  }
  how.regular = true;
  VideoFiles files{base::OutputFile(path, how), std::nullopt};
  std::filesystem::path beside = path;
  if (copy) files.copy.emplace(beside.replace_extension(".mp4"), how);
  return files;
}

VideoWriter::VideoWriter(VideoFiles files, int width, int height, std::int64_t fps,
                         double pixel_aspect, int sound)
    : path_(files.lossless.path()), files_(std::move(files)), width_(width), height_(height) {
  if (width < 2 || height < 2 || width > kLargestOfH264 || height > kLargestOfH264 || fps < 1 ||
      !(pixel_aspect > 0.01 && pixel_aspect < 100.0)) {
    throw std::invalid_argument("video: " + std::to_string(width) + "x" + std::to_string(height) +
                                " pixels, " + std::to_string(fps) + " a second, pixel aspect " +
                                std::to_string(pixel_aspect));
  }
  if (files_->copy) {
    require_size_of_copy(size_of_copy(width, height, pixel_aspect), files_->copy->path());
  }
  // A socket, not a pipe: send() can be told to fail where write() would raise SIGPIPE.
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(std::string("cannot make a socket: ") + std::strerror(errno));
  }
  socket_ = ends[0];
  try {
    messages_ = base::nameless_file();
    if (sound >= 0) lseek(sound, 0, SEEK_SET);
    process_ =
        spawn(arguments(width, height, fps, pixel_aspect, files_->lossless.part(),
                        files_->copy ? files_->copy->part().string() : std::string(), sound >= 0),
              ends[1], messages_, sound);
  } catch (...) {
    ::close(ends[0]);
    ::close(ends[1]);
    if (messages_ >= 0) ::close(messages_);
    throw;
  }
  ::close(ends[1]);
}

VideoWriter::~VideoWriter() {
  if (process_ >= 0) {
    kill(process_, SIGKILL);
    wait();
    remove_parts();
  }
  ::close(messages_);
}

void VideoWriter::add(const Image& image) {
  if (image.width != width_ || image.height != height_ ||
      image.rgb.size() !=
          std::size_t{3} * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
    throw std::invalid_argument("video: a picture of " + std::to_string(image.width) + "x" +
                                std::to_string(image.height) + " pixels, expected " +
                                std::to_string(width_) + "x" + std::to_string(height_));
  }
  if (process_ < 0) throw std::runtime_error(path_ + ": the video is finished already");
  for (std::size_t sent = 0; sent < image.rgb.size();) {
    const ssize_t n = send(socket_, image.rgb.data() + sent, image.rgb.size() - sent,
                           MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno == EAGAIN) {
      pollfd room{socket_, POLLOUT, 0};
      poll(&room, 1, kNap_ms);
    }
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) {
      check_();
      continue;
    }
    if (n < 0) fail();
    sent += static_cast<std::size_t>(n);
  }
  ++pictures_;
}

void VideoWriter::finish() {
  if (process_ < 0) return;
  if (pictures_ == 0) {
    kill(process_, SIGKILL);
    wait();
    remove_parts();
    throw std::runtime_error(path_ + ": the video has no pictures");
  }
  ::close(socket_);
  socket_ = -1;
  int status = 0;
  while (waitpid(process_, &status, WNOHANG) == 0) {
    check_();
    poll(nullptr, 0, kNap_ms);
  }
  process_ = -1;
  if (status != 0) fail();
  const auto require_bytes = [this](const base::OutputFile& file) {
    struct stat written {};
    if (fstat(file.descriptor(), &written) == 0 && written.st_size == 0) fail();
  };
  require_bytes(files_->lossless);
  if (files_->copy) require_bytes(*files_->copy);
}

void VideoWriter::close() {
  finish();
  std::optional<VideoFiles> files = std::exchange(files_, std::nullopt);
  if (!files) return;
  files->lossless.commit();
  if (files->copy) files->copy->commit();
}

/// Ends the connection to ffmpeg and returns its wait status.
int VideoWriter::wait() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  int status = 0;
  while (process_ >= 0 && waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  process_ = -1;
  return status;
}

void VideoWriter::fail() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  for (int nap = 0; process_ >= 0; ++nap) {  // without input it ends, or it is killed
    if (nap == kMostNaps) kill(process_, SIGKILL);
    if (waitpid(process_, nullptr, nap < kMostNaps ? WNOHANG : 0) == process_) process_ = -1;
    if (process_ >= 0) poll(nullptr, 0, kNap_ms);
  }
  remove_parts();
  const std::string said = text_of(messages_);
  throw std::runtime_error(path_ +
                           ": ffmpeg has stopped: " + (said.empty() ? "without a message" : said));
}

void VideoWriter::remove_parts() {
  files_.reset();
}

}  // namespace headpin::render
