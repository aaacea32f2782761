#include "render/egl_devices.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/egl_context.h"
#include "render/gl_functions.h"

namespace headpin::render {

namespace {

constexpr std::string_view kPrefix = "egl:", kAuto = "auto";
constexpr unsigned kPatience = 60;  // longest time for a device [s]

std::optional<int> number_in(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

/// The message of a child: '+' or '-', whether it is a card, CUDA's number if any, then the text.
std::string told(bool works, bool card, const std::optional<int>& cuda, const std::string& says) {
  return std::string(works ? "+" : "-") + (card ? "c" : "p") +
         (cuda ? std::to_string(*cuda) : std::string()) + "\n" + says;
}

/// Sends `text` and ends the child. No destructor runs, because it could crash or hang.
[[noreturn]] void say_and_end(int out, const std::string& text) {
  const ssize_t written = write(out, text.data(), text.size());
  _exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
}

std::string all_from(int in) {
  std::string text;
  std::array<char, 512> piece{};
  for (;;) {
    const ssize_t count = read(in, piece.data(), piece.size());
    if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) return text;
  }
}

/// The result of `work` in a separate process.
/// @throws std::runtime_error  if the process fails or takes too long
std::string in_a_child(const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) {
    signal(SIGALRM, SIG_DFL);
    alarm(kPatience);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nowhere, STDERR_FILENO);  // hides messages of drivers; errors are reported below
    try {
      say_and_end(ends[1], work());
    } catch (const std::exception& error) {
      say_and_end(ends[1], told(false, false, std::nullopt, error.what()));
    }
  }
  close(ends[1]);
  const std::string said = all_from(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return said;
  const int by = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (by == SIGALRM) {
    throw std::runtime_error("no answer within " + std::to_string(kPatience) + " s");
  }
  throw std::runtime_error(std::string("its driver ended the process") +
                           (by != 0 ? std::string(": ") + strsignal(by) : ""));
}

std::string tried(int device) {
  const std::optional<int> cuda = cuda_number(device);
  try {
    const std::unique_ptr<GlContext> context = egl_device_context(device);
    context->make_current();
    const Gl gl = load_functions(*context);
    check_drawing(gl);
    return told(true, !draws_on_the_processor(renderer_name(gl)), cuda, describe(*context, gl));
  } catch (const std::exception& error) {
    return told(false, false, cuda, error.what());
  }
}

EglDevice look_at(int number) {
  try {
    const std::string said = in_a_child([number] { return tried(number); });
    const std::size_t line = std::min(said.find('\n'), said.size());
    if (line < 2) throw std::runtime_error("no answer");
    return {number, said[0] == '+', said[1] == 'c',
            number_in(std::string_view(said).substr(2, line - 2)), said.substr(line + 1)};
  } catch (const std::runtime_error& error) {
    return {number, false, false, std::nullopt, error.what()};
  }
}

std::vector<int> numbers_of(std::string_view list) {
  std::vector<int> numbers;
  while (!list.empty()) {
    const std::string_view one = list.substr(0, list.find(','));
    const std::optional<int> number = number_in(one);
    if (one == "-1") break;  // CUDA ignores the devices after it
    if (!number) {
      throw std::invalid_argument("CUDA_VISIBLE_DEVICES is " + std::string(list) +
                                  ": egl:auto expects numbers; name the device: egl:NUMBER");
    }
    numbers.push_back(*number);
    list.remove_prefix(std::min(list.size(), one.size() + 1));
  }
  return numbers;
}

}  // namespace

std::vector<EglDevice> egl_devices() {
  const std::string count = in_a_child([] { return std::to_string(egl_device_count()); });
  const std::optional<int> number = number_in(count);
  if (!number)
    throw std::runtime_error("EGL lists no devices: " + count.substr(count.find('\n') + 1));
  std::vector<EglDevice> devices;
  for (int i = 0; i < *number; ++i) devices.push_back(look_at(i));
  return devices;
}

bool is_egl_device(std::string_view name) {
  if (!name.starts_with(kPrefix)) return false;
  name.remove_prefix(kPrefix.size());
  return name == kAuto || number_in(name).has_value();
}

std::optional<int> chosen_device(const std::vector<EglDevice>& devices,
                                 std::optional<std::string_view> visible) {
  const auto first = [&](auto&& fits) -> std::optional<int> {
    const auto found = std::ranges::find_if(
        devices, [&](const EglDevice& device) { return device.works && fits(device); });
    return found == devices.end() ? std::nullopt : std::optional(found->number);
  };
  if (visible) {
    for (const int cuda : numbers_of(*visible)) {
      if (const auto card = first([&](const EglDevice& d) { return d.cuda == cuda; })) return card;
    }
  } else if (const auto card = first([](const EglDevice& d) { return d.card; })) {
    return card;
  }
  return first([](const EglDevice& d) { return !d.card; });
}

std::unique_ptr<GlContext> open_egl_device(std::string_view name) {
  std::string_view which = name.substr(kPrefix.size());
  std::optional<int> number = number_in(which);
  std::string why;
  if (number) {
    const EglDevice device = look_at(*number);
    if (!device.works) number.reset();
    why = device.says;
  } else {
    const char* const visible = std::getenv("CUDA_VISIBLE_DEVICES");
    const std::vector<EglDevice> devices = egl_devices();
    number =
        chosen_device(devices, visible ? std::optional<std::string_view>(visible) : std::nullopt);
    for (const EglDevice& d : devices) {
      why += (why.empty() ? "egl:" : "; egl:") + std::to_string(d.number) + ": " + d.says;
    }
    if (devices.empty()) why = "EGL lists no device";
  }
  if (!number) throw std::runtime_error(std::string(name) + ": cannot be drawn with: " + why);
  std::unique_ptr<GlContext> context = egl_device_context(*number);
  context->make_current();
  check_drawing(load_functions(*context));
  return context;
}

}  // namespace headpin::render
