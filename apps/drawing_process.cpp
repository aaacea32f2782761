#include "apps/drawing_process.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace headpin::apps {

namespace {

using scene::RealTime;

constexpr int kNoAnswer_ms = 30'000;  // a process that is silent for this long hangs
constexpr int kMostStarts = 3;        // in a row without a frame
constexpr char kReady = 'r', kDrawn = 'd', kFailed = 'f';

/// A message between two processes of one program: the bytes of fields, one after the other.
class Packing {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_ += text;
  }
  void add(const Pose& X) {
    for (const double x : {X.q.w(), X.q.x(), X.q.y(), X.q.z(), X.p.x(), X.p.y(), X.p.z()}) add(x);
  }
  template <typename T>
  void add(const std::vector<T>& all) {
    add(all.size());
    for (const T& one : all) add(one);
  }
  template <typename T>
  void add(const std::optional<T>& maybe) {
    add(maybe.has_value());
    if (maybe) add(*maybe);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Unpacking {
 public:
  explicit Unpacking(std::string bytes) : bytes_(std::move(bytes)) {}

  template <typename T>
  void take(T& value) {
    static_assert(std::is_arithmetic_v<T>);
    std::memcpy(&value, next(sizeof value), sizeof value);
  }
  void take(std::string& text) {
    std::size_t size = 0;
    take(size);
    text.assign(next(size), size);
  }
  void take(Pose& X) {
    for (double* x : {&X.q.w(), &X.q.x(), &X.q.y(), &X.q.z(), &X.p.x(), &X.p.y(), &X.p.z()}) {
      take(*x);
    }
  }
  template <typename T>
  void take(std::vector<T>& all) {
    std::size_t size = 0;
    take(size);
    all.clear();
    for (std::size_t i = 0; i < size; ++i) take(all.emplace_back());
  }
  template <typename T>
  void take(std::optional<T>& maybe) {
    bool there = false;
    take(there);
    maybe.reset();
    if (there) take(maybe.emplace());
  }

 private:
  const char* next(std::size_t size) {
    if (size > bytes_.size() - at_) throw std::runtime_error("a message is incomplete");
    const char* from = bytes_.data() + at_;
    at_ += size;
    return from;
  }

  std::string bytes_;
  std::size_t at_ = 0;
};

/// @return  whether all of it was sent
bool send_all(int socket, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t n = send(socket, bytes, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool send_message(int socket, const Packing& message) {
  const std::size_t size = message.bytes().size();
  return send_all(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         send_all(socket, message.bytes().data(), size);
}

/// @param wait_ms  longest wait for each part; -1: no limit
bool receive_all(int socket, char* bytes, std::size_t size, int wait_ms) {
  while (size > 0) {
    pollfd one{socket, POLLIN, 0};
    const int ready = poll(&one, 1, wait_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    const ssize_t n = recv(socket, bytes, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

std::optional<Unpacking> receive_message(int socket, int wait_ms) {
  std::size_t size = 0;
  if (!receive_all(socket, reinterpret_cast<char*>(&size), sizeof size, wait_ms)) {
    return std::nullopt;
  }
  std::string bytes(size, '\0');
  if (!receive_all(socket, bytes.data(), size, wait_ms)) return std::nullopt;
  return Unpacking(std::move(bytes));
}

// The messages. Each is packed and unpacked field by field, in the same order.

template <typename Pack, typename Order>
void fields_of_order(Pack&& each, Order& o) {
  each(o.scenario), each(o.eyes), each(o.url), each(o.gl), each(o.gives_way), each(o.first);
}

template <typename Pack, typename Fingerprint>
void fields_of_fingerprint(Pack&& each, Fingerprint& f) {
  each(f.renderer), each(f.processor), each(f.environment), each(f.picture);
}

template <typename Pack, typename Glimpse>
void fields_of_glimpse(Pack&& each, Glimpse& g) {
  each(g.X_WD), each(g.X_WB_skittles), each(g.X_WB_balls), each(g.ellipsoids);
  each(g.skittle_centre), each(g.X_WH), each(g.closed), each(g.X_WC);
  each(g.ringed), each(g.X_BG_rings), each(g.board);
}

template <typename Pack, typename Record>
void fields_of_record(Pack&& each, Record& r) {
  each(r.frame), each(r.tick);
  for (std::size_t eye = 0; eye < 2; ++eye) each(r.X_WE[eye]), each(r.hash[eye]);
}

auto into(Packing& message) {
  return [&message](const auto& field) { message.add(field); };
}

auto from(Unpacking& message) {
  return [&message](auto& field) { message.take(field); };
}

std::int64_t count(RealTime::Clock::time_point t) {
  return t.time_since_epoch().count();
}

RealTime::Clock::time_point time_point(std::int64_t count) {
  return RealTime::Clock::time_point(RealTime::Clock::duration(count));
}

/// This program, started again with a socket as standard input and no other open file.
class Process {
 public:
  Process() {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw std::runtime_error(std::string("no socket: ") + std::strerror(errno));
    }
    socket_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    // A signal from the terminal stops only the session, which ends this process after its last
    // frame.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t held;
    sigemptyset(&held);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, signal);
    posix_spawnattr_setsigmask(&attributes, &held);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    std::string program = "headpin", command = "draw";
    std::array<char*, 3> words{program.data(), command.data(), nullptr};
    const int error =
        posix_spawn(&process_, "/proc/self/exe", &actions, &attributes, words.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error == 0) return;
    close(socket_);
    throw std::runtime_error(std::string("cannot run headpin itself: ") + std::strerror(error));
  }
  ~Process() { end(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int socket() const { return socket_; }

  /// Ends the process, if it is still running.
  /// @return  how it ended
  std::string end() {
    if (process_ < 0) return "";
    close(std::exchange(socket_, -1));  // the process ends when its socket is closed
    int status = 0;
    bool killed = false;
    for (int i = 0; waitpid(process_, &status, WNOHANG) == 0; ++i) {
      if (i == kPatience) killed = kill(process_, SIGKILL) == 0;
      poll(nullptr, 0, 10);
    }
    process_ = -1;
    if (killed) return "it did not answer";
    if (WIFSIGNALED(status)) {
      return fmt::format("by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    }
    return fmt::format("with exit code {}", WEXITSTATUS(status));
  }

 private:
  static constexpr int kPatience = 500;  // of 10 ms

  pid_t process_ = -1;
  int socket_ = -1;
};

class DrawerElsewhere : public scene::FrameDrawer {
 public:
  explicit DrawerElsewhere(DrawingOrder order) : order_(std::move(order)) {
    order_.first = true;
    try {
      start();
    } catch (const scene::DrawingFailed& failed) {
      throw std::runtime_error(failed.what());
    }
    order_.first = false;
  }

  const render::Fingerprint& drawn_by() const override { return drawn_by_; }

  std::optional<scene::DrawnFrame> draw(const scene::FrameJob& job) override {
    if (fruitless_ >= kMostStarts) return std::nullopt;
    if (!process_) start();
    Packing message;
    message.add(job.frame);
    message.add(job.tick);
    message.add(std::int64_t{job.time.count()});
    fields_of_glimpse(into(message), job.glimpse);
    Unpacking answer = ask(message, kDrawn);
    scene::DrawnFrame done;
    fields_of_record(from(answer), done.record);
    done.record.time = job.time;
    std::int64_t drawn = 0, published = 0;
    answer.take(drawn);
    answer.take(published);
    done.drawn = time_point(drawn);
    done.published = time_point(published);
    fruitless_ = 0;
    return done;
  }

 private:
  void start() {
    try {
      process_.emplace();
    } catch (const std::runtime_error& error) {
      ++fruitless_;
      throw scene::DrawingFailed(error.what());
    }
    Packing message;
    fields_of_order(into(message), order_);
    Unpacking answer = ask(message, kReady);
    render::Fingerprint who;
    fields_of_fingerprint(from(answer), who);
    if (order_.first) drawn_by_ = who;
  }

  /// @throws scene::DrawingFailed  without an answer, or for an unexpected one
  Unpacking ask(const Packing& message, char expected) {
    // The first time, compiling shaders may take long.
    const int patience = order_.first ? -1 : kNoAnswer_ms;
    std::optional<Unpacking> answer;
    if (send_message(process_->socket(), message)) {
      answer = receive_message(process_->socket(), patience);
    }
    char kind = 0;
    if (answer) answer->take(kind);
    if (kind == expected) return std::move(*answer);
    std::string why;
    if (kind == kFailed) answer->take(why);
    const std::string end = process_->end();
    process_.reset();
    ++fruitless_;
    if (why.empty()) why = "the process that draws has ended, " + end;
    if (!order_.first) {
      why +=
          fruitless_ < kMostStarts
              ? "; it is started again"
              : fmt::format("; it has failed {} times without a picture and is not started again",
                            fruitless_);
    }
    throw scene::DrawingFailed(why);
  }

  DrawingOrder order_;
  std::optional<Process> process_;
  render::Fingerprint drawn_by_;
  int fruitless_ = 0;  ///< number of ends since the last frame
};

/// Answers one order; null if there was none.
std::unique_ptr<scene::FrameDrawer> get_ready(int socket, DrawerMaker maker) {
  std::optional<Unpacking> message = receive_message(socket, -1);
  if (!message) return nullptr;
  DrawingOrder order;
  fields_of_order(from(*message), order);
  std::unique_ptr<scene::FrameDrawer> drawer = maker(order);
  Packing answer;
  answer.add(kReady);
  fields_of_fingerprint(into(answer), drawer->drawn_by());
  return send_message(socket, answer) ? std::move(drawer) : nullptr;
}

void draw_until_closed(int socket, scene::FrameDrawer& drawer) {
  while (std::optional<Unpacking> message = receive_message(socket, -1)) {
    scene::FrameJob job;
    std::int64_t time = 0;
    message->take(job.frame);
    message->take(job.tick);
    message->take(time);
    job.time = Time{time};
    fields_of_glimpse(from(*message), job.glimpse);
    const std::optional<scene::DrawnFrame> done = drawer.draw(job);
    if (!done) return;
    Packing answer;
    answer.add(kDrawn);
    fields_of_record(into(answer), done->record);
    answer.add(count(done->drawn));
    answer.add(count(done->published));
    if (!send_message(socket, answer)) return;
  }
}

}  // namespace

std::unique_ptr<scene::FrameDrawer> draw_in_a_process(DrawingOrder order) {
  return std::make_unique<DrawerElsewhere>(std::move(order));
}

void serve_frames(DrawerMaker maker) {
  int type = 0;
  socklen_t size = sizeof type;
  if (getsockopt(STDIN_FILENO, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
    throw std::runtime_error("internal command: only `headpin live` starts it");
  }
  try {
    if (const auto drawer = get_ready(STDIN_FILENO, maker)) {
      draw_until_closed(STDIN_FILENO, *drawer);
    }
  } catch (const std::exception& error) {  // reported by the other process
    Packing answer;
    answer.add(kFailed);
    answer.add(std::string(error.what()));
    send_message(STDIN_FILENO, answer);
  }
}

}  // namespace headpin::apps
