#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

/// XDF as its specification has it, written by hand: for readers.
namespace headpin::xdf {

/// The bytes of a number, the least significant first.
template <typename T>
std::string bytes(T number) {
  std::string out(sizeof number, '\0');
  std::memcpy(out.data(), &number, sizeof number);
  return out;
}

inline std::string chunk(std::uint16_t tag, const std::string& content) {
  const auto length = static_cast<std::uint32_t>(content.size() + 2);
  return '\x04' + bytes(length) + bytes(tag) + content;
}

inline std::string begin() {
  return "XDF:" + chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>");
}

/// A channel's label, and its XML beside the label.
using Channels = std::vector<std::pair<std::string, std::string>>;

inline std::string stream(std::uint32_t id, const std::string& name, const std::string& type,
                          const std::string& format, double rate, const Channels& channels) {
  std::string xml = "<?xml version=\"1.0\"?>\n<info>\n\t<name>" + name + "</name>\n\t<type>" +
                    type + "</type>\n\t<channel_count>" + std::to_string(channels.size()) +
                    "</channel_count>\n\t<nominal_srate>" + std::to_string(rate) +
                    "</nominal_srate>\n\t<channel_format>" + format +
                    "</channel_format>\n\t<desc><channels>";
  for (const auto& [label, more] : channels)
    xml += "<channel><label>" + label + "</label>" + more + "</channel>";
  return chunk(2, bytes(id) + xml + "</channels></desc></info>");
}

/// A sample: its time, or none, and its values.
inline std::string sample(double time, const std::string& values) {
  return '\x08' + bytes(time) + values;
}
inline std::string sample(const std::string& values) {
  return std::string(1, '\0') + values;
}

inline std::string text(const std::string& word) {
  return '\x01' + std::string(1, static_cast<char>(word.size())) + word;
}

inline std::string samples(std::uint32_t id, std::uint8_t count, const std::string& all) {
  return chunk(3, bytes(id) + '\x01' + bytes(count) + all);
}

inline std::string offset(std::uint32_t id, double time, double value) {
  return chunk(4, bytes(id) + bytes(time) + bytes(value));
}

inline std::string boundary() {
  return chunk(5, "\x43\xa5\x46\xdc\xcb\xf5\x41\x0f\xb3\x0e\xd5\x46\x73\x83\xcb\xe4");
}

inline std::string footer(std::uint32_t id) {
  return chunk(6, bytes(id) + "<?xml version=\"1.0\"?><info></info>");
}

}  // namespace headpin::xdf
