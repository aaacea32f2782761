#include "devices/fastrak/asking.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace headpin::devices {

std::string shown_bytes(std::string_view bytes) {
  if (bytes.empty()) return "nothing";
  std::string text;
  for (const char c : bytes.substr(0, 60)) {
    const auto byte = static_cast<unsigned char>(c);
    text += byte >= ' ' && byte < 0x7F ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return fmt::format("{} bytes '{}{}'", bytes.size(), text, bytes.size() > 60 ? "..." : "");
}

Time time_of(std::size_t bytes, const FastrakLine& line) {
  return Time{static_cast<std::int64_t>(bytes) * 10'000'000 / line.baud()};
}

void demand(FastrakLine& line, FastrakDemands& demands, std::string what, bool met,
            std::string_view found) {
  demands.push_back(
      {shown_bytes(line.sent()), std::move(what), met, met ? "" : shown_bytes(found)});
}

void tell(FastrakLine& line, FastrakDemands& demands, std::string_view text, Time span) {
  const std::string heard = line.ask(text, span);
  demand(line, demands, "no answer", heard.empty(), heard);
}

void tell_each(FastrakLine& line, FastrakDemands& demands, int last, std::string_view command,
               Time span) {
  for (int station = 1; station <= last; ++station) {
    std::string text(command);
    std::ranges::replace(text, '#', static_cast<char>('0' + station));
    tell(line, demands, text, span);
  }
}

}  // namespace headpin::devices
