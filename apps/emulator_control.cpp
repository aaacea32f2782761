#include "apps/emulator_control.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/streams.h"
#include "files/names.h"

namespace headpin::apps {

Control::Control(const std::string& path) {
  if (path.empty()) return;
  if (path == "-") {
    fd_ = STDIN_FILENO;
    fcntl(fd_, F_SETFL, fcntl(fd_, F_GETFL) | O_NONBLOCK);
    return;
  }
  if (mkfifo(path.c_str(), 0600) == 0) {
    made_ = path;
  } else if (errno != EEXIST) {
    throw std::runtime_error(path + ": " + std::strerror(errno));
  }
  struct stat file {};
  // Also open for writing, so that the pipe does not end when the first writer closes it.
  fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0 || fstat(fd_, &file) != 0 || !S_ISFIFO(file.st_mode)) {
    if (fd_ >= 0) ::close(fd_);
    throw std::runtime_error(path + ": exists and is not a named pipe");
  }
}

Control::~Control() {
  if (!made_.empty()) files::remove_pipe(made_, fd_);
  if (fd_ > STDIN_FILENO) ::close(fd_);
}

std::vector<std::string> Control::lines() {
  constexpr std::size_t kLongest = 4096;  // longest line; the longest valid one has 300
  std::array<char, 65536> bytes{};
  if (fd_ < 0) return {};
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n > 0) text_.append(bytes.data(), static_cast<std::size_t>(n));
  if (n == 0) fd_ = -1;  // the end of standard input
  if (text_.size() > kLongest && text_.find('\n') > kLongest) {
    text_.erase(0, std::min(text_.find('\n'), text_.size()));
    if (!told_) say("headpin emulate: control: lines longer than {} bytes are ignored\n", kLongest);
    told_ = true;
  }
  std::vector<std::string> whole;
  for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
    whole.push_back(text_.substr(0, end));
    text_.erase(0, end + 1);
  }
  return whole;
}

bool obey(const std::string& line, devices::FastrakEmulator& emulator, Feed& feed, bool stylus,
          EmulatedMouse* mouse, Time now) {
  const auto word = [&](std::string_view begin) { return line.starts_with(begin); };
  if (line == "power-cycle") {
    emulator.power_cycle(now);
  } else if (line == "press" || line == "release") {
    if (!stylus && !mouse) {
      throw std::invalid_argument("control line '" + line + "': expected --stylus or --mouse");
    }
    feed.pressed = line == "press";
    if (mouse) mouse->typed.trigger = feed.pressed;
  } else if (word("left-thumb ") || word("right-thumb ")) {
    const bool down = line.ends_with(" down");
    if (!mouse || (!down && !line.ends_with(" up"))) {
      throw std::invalid_argument("control line '" + line + "': expected " +
                                  (mouse ? "up or down after it" : "the option --mouse"));
    }
    (word("left") ? mouse->typed.left_thumb : mouse->typed.right_thumb) = down;
  } else if (line == "rewind") {
    feed.begin = devices::begin_of(feed.first, emulator, now);
  } else if (line.starts_with("faults")) {
    emulator.set_faults(devices::parse_faults(line.size() > 7 ? line.substr(7) : ""));
  } else if (!line.empty() && line != "quit") {
    throw std::invalid_argument(
        "control line '" + line +
        "': expected power-cycle, press, release, left-thumb or right-thumb up or down, rewind, "
        "faults SPEC or quit");
  }
  return line != "quit";
}

}  // namespace headpin::apps
