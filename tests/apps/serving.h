#pragma once

#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tests/apps/command_line.h"
#include "tests/apps/http.h"

/// A server of games, and what a guest's page sends to it.
namespace headpin {

inline const std::string kDemoLog = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
inline const std::string kKey(32, 'a'), kOtherKey(32, 'b');
inline const std::string kNowhere = "/play/" + std::string(32, '0');

/// To all questions of the study that is planned without a design.
inline nlohmann::json all_answers() {
  nlohmann::json answers;
  for (int i = 1; i <= 6; ++i) answers[fmt::format("presence{}", i)] = "6";
  for (const char* item : {"sick", "noticed", "vrbefore", "sex", "occupation"}) {
    answers[item] = "n/a";
  }
  return answers;
}

/// `headpin serve` in the test's folder. The pages are made elsewhere; here stand their marks.
class Serve : public CommandLine {
 protected:
  Serve() {
    for (const char* name : {"page.html", "watch.html"}) {
      std::ofstream(folder_ / name) << "<html>img-src data: blob:<!--headpin:data--></html>";
    }
  }
  ~Serve() override {
    if (process_ > 0) stop(SIGKILL);
  }

  /// Starts it, and waits until it says where it is.
  /// @param before  of the shell, such as a limit
  void start(const std::string& words, const std::string& before = "") {
    const std::string command = fmt::format(
        "cd '{}' && {} exec '{}' serve --json --port 0 --page page.html --watch-page watch.html {} "
        ">said.json 2>said.txt </dev/null",
        folder_.string(), before, HEADPIN_PROGRAM, words);
    process_ = fork();
    if (process_ == 0) {
      execl("/bin/bash", "bash", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    while (slurp(folder_ / "said.json").find('\n') == std::string::npos) {
      if (waitpid(process_, nullptr, WNOHANG) != 0) {
        process_ = 0;
        FAIL() << slurp(folder_ / "said.txt");
      }
      std::this_thread::yield();
    }
    const auto said = nlohmann::json::parse(slurp(folder_ / "said.json"));
    operator_ = said["operator"];
    for (const std::string link : said["links"]) links_.push_back(path_of(link));
    const std::size_t colon = operator_.find(':', 8);
    port_ = std::stoi(operator_.substr(colon + 1));
    operator_ = path_of(operator_);
  }

  static std::string path_of(const std::string& url) { return url.substr(url.find('/', 8)); }

  /// @return  the exit code
  int stop(int signal = SIGTERM) {
    kill(process_, signal);
    int status = 0;
    waitpid(std::exchange(process_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status;
  }

  Reply ask(const std::string& method, const std::string& target, const std::string& body = "") {
    Connection connection(port_);
    connection.send(request(method, target, body));
    return reply_of(connection.rest());
  }

  Reply post(const std::string& link, const std::string& doing, const std::string& body = "",
             const std::string& key = kKey) {
    return ask(
        "POST",
        fmt::format("{}/{}&key={}", link, doing.find('?') == doing.npos ? doing + "?" : doing, key),
        body);
  }

  std::string state_query() const { return "/state" + operator_.substr(1); }
  nlohmann::json guest(std::size_t number) {
    return nlohmann::json::parse(ask("GET", state_query()).body)["guests"][number];
  }

  std::int64_t most_memory_kb() const {
    const std::string status = slurp(fmt::format("/proc/{}/status", process_));
    return std::stoll(status.substr(status.find("VmHWM:") + 6));
  }

  std::size_t files_in(const std::string& folder) const {
    std::size_t count = 0;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder_ / folder, none)) {
      count += entry.exists() ? 1 : 0;
    }
    return count;
  }

  pid_t process_ = 0;
  int port_ = 0;
  std::string operator_;
  std::vector<std::string> links_;
};

}  // namespace headpin
