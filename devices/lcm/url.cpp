#include "devices/lcm/url.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

namespace headpin::devices {
namespace {

/// Reads all of a text as a number. @return  false if it is none
template <typename T>
bool reads_all(std::string_view text, T& number) {
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc{} && read.ptr == end;
}

std::string_view or_nothing(std::string_view text) {
  return text.empty() ? "nothing" : text;
}

/// The text before the first `sign`, and the text behind it if there is one.
std::pair<std::string_view, std::optional<std::string_view>> split_at(std::string_view text,
                                                                      char sign) {
  const std::size_t at = text.find(sign);
  if (at == std::string_view::npos) return {text, std::nullopt};
  return {text.substr(0, at), text.substr(at + 1)};
}

/// Calls take(name, value) for each parameter of a URL. LCM separates them by any of these signs.
template <typename Take>
void for_each_parameter(std::string_view parameters, Take take) {
  while (!parameters.empty()) {
    const std::string_view one = parameters.substr(0, parameters.find_first_of("&,?"));
    parameters.remove_prefix(std::min(parameters.size(), one.size() + 1));
    const auto [name, value] = split_at(one, '=');
    if (!one.empty()) take(name, value.value_or(""));
  }
}

}  // namespace

LcmUrl::LcmUrl(std::string typed, std::string_view before, LcmUse use)
    : url_(std::move(typed)), name_(std::string(before) + url_), shown_(url_) {
  if (url_.empty()) take_default();
  read();
  check(use);
}

void LcmUrl::take_default() {
  const char* const of_environment = std::getenv("LCM_DEFAULT_URL");
  of_environment_ = of_environment != nullptr && *of_environment != '\0';
  url_ = of_environment_ ? of_environment : "udpm://";
  name_ = of_environment_ ? "LCM_DEFAULT_URL in the environment" : "LCM's default URL";
  shown_ = of_environment_ ? url_ : "its default URL";
}

void LcmUrl::read() {
  const std::string_view url = url_;
  const std::size_t mark = url.find("://");
  const std::string_view provider =
      mark == std::string_view::npos ? std::string_view() : url.substr(0, mark);
  const auto [place, parameters] =
      split_at(provider.empty() ? std::string_view() : url.substr(mark + 3), '?');
  if (provider == "udpm") return read_group(place, parameters.value_or(""));
  if (provider == "file") return read_log(place, parameters.value_or(""));
  if (provider == "tcpq") return read_server(place);
  if (provider == "mpudpm") {
    refuse(
        "two datagrams of anybody end a program in which liblcm 1.3.1 reads mpudpm; expected "
        "udpm://");
  }
  if (provider != "memq") {
    refuse_whole(
        "expected an LCM URL such as udpm://239.255.76.67:7667?ttl=0 or file://LOG?mode=w");
  }
}

void LcmUrl::read_group(std::string_view network, std::string_view parameters) {
  constexpr std::string_view kExpected =
      "expected udpm://ADDRESS:PORT with an address from 224.0.0.0 to 239.255.255.255 and a port "
      "from 1 to 65535";
  const auto [host, port] = split_at(network, ':');
  const std::string address = host.empty() ? "239.255.76.67" : std::string(host);
  in_addr number{};
  if (inet_pton(AF_INET, address.c_str(), &number) != 1 || !IN_MULTICAST(ntohl(number.s_addr))) {
    refuse_whole(kExpected);
  }
  // liblcm 1.3.1 takes port 0 where none is given, against its documentation.
  group_ = MulticastGroup{.address = ntohl(number.s_addr), .port = 7667};
  if (port && (!reads_all(*port, group_->port) || group_->port == 0)) refuse_whole(kExpected);

  for_each_parameter(parameters, [&](std::string_view name, std::string_view value) {
    const auto take = [&](int& into, int most) {
      if (reads_all(value, into) && into >= 0 && into <= most) return;
      refuse(fmt::format("{}: expected a whole number from 0 to {}, found {}", name, most,
                         or_nothing(value)));
    };
    if (name == "ttl") return take(ttl_, 255);
    if (name == "recv_buf_size") return take(receive_buffer_, std::numeric_limits<int>::max());
    if (name == "transmit_only") return;  // of older versions of LCM, without an effect
    refuse(fmt::format("unknown parameter '{}'; expected ttl or recv_buf_size", name));
  });
}

void LcmUrl::read_log(std::string_view path, std::string_view parameters) {
  if (path.empty()) refuse("expected the name of a log after file://, found nothing");
  log_.emplace().path = path;
  for_each_parameter(parameters, [&](std::string_view name, std::string_view value) {
    const auto refuse_value = [&](std::string_view expected) {
      refuse(fmt::format("{}: expected {}, found {}", name, expected, or_nothing(value)));
    };
    std::int64_t begin = 0;
    if (name == "mode") {
      if (value == "a") refuse("cannot append to a log; expected mode=w");
      if (value != "r" && value != "w") refuse_value("r or w");
      log_->written = value == "w";
    } else if (name == "speed") {
      const bool good = reads_all(value, log_->speed);
      if (!good || !(log_->speed >= 0.0) || !std::isfinite(log_->speed)) {
        refuse_value("a number, 0 (as fast as possible) or more");
      }
    } else if (name == "start_timestamp") {
      if (!reads_all(value, begin)) refuse_value("a whole number of microseconds");
      log_->begin = Time{begin};
    } else {
      refuse(fmt::format("unknown parameter '{}'; expected mode, speed or start_timestamp", name));
    }
  });
}

void LcmUrl::read_server(std::string_view network) {
  const auto [host, port] = split_at(network, ':');
  server_.emplace();
  if (!host.empty()) server_->host = host;
  if (!port) return;
  if (!reads_all(*port, server_->port) || server_->port < 1 || server_->port > 65535) {
    refuse_whole("expected tcpq://HOST:PORT with a port from 1 to 65535");
  }
}

void LcmUrl::check(LcmUse use) const {
  if (!log_) return;
  if (use == LcmUse::publishing && !log_->written) {
    refuse(
        fmt::format("this would be read; to write a log, expected file://{}?mode=w", log_->path));
  }
  if (use == LcmUse::reading && log_->written) {
    refuse(fmt::format("this would be written; to read a log, expected file://{}", log_->path));
  }
}

std::string LcmUrl::for_liblcm() const {
  if (!group_) return "memq://";
  const std::uint32_t a = group_->address;
  std::string url = fmt::format("udpm://{}.{}.{}.{}:{}?ttl={}", a >> 24, a >> 16 & 0xFF,
                                a >> 8 & 0xFF, a & 0xFF, group_->port, ttl_);
  if (receive_buffer_ > 0) url += fmt::format("&recv_buf_size={}", receive_buffer_);
  return url;
}

void LcmUrl::refuse(std::string_view why) const {
  throw std::invalid_argument(fmt::format("{}: {}", name_, why));
}

/// For a URL of which the user sees only the name of the variable that has it.
void LcmUrl::refuse_whole(std::string_view expected) const {
  if (!of_environment_) refuse(expected);
  refuse(fmt::format("{}, found '{}'", expected, url_));
}

}  // namespace headpin::devices
