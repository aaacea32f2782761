#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/plain_xml.h"

/// Reads XDF, the Extensible Data Format of the Lab Streaming Layer, which LabRecorder writes.
///
/// A file is "XDF:" and chunks: a length, a tag, and the content. Numbers are little-endian.
namespace headpin::devices {

struct XdfChannel {
  std::string label, type, unit;
  std::string object;  ///< that it belongs to, or "NAME marker"; empty if the header has neither
};

/// A measurement: at `time` of the stream's clock, the recorder's clock was ahead by `value` [s].
struct XdfClockOffset {
  double time = 0.0, value = 0.0;
  std::size_t after = 0;  ///< samples of the stream that stand before it in the file
};

struct XdfStream {
  std::uint32_t id = 0;
  std::string name, type, format;  ///< format: "double64", "float32", "int8" to "int64", "string"
  double rate_hz = 0.0;            ///< 0: irregular
  std::vector<XdfChannel> channels;
  std::vector<double> times;       ///< of the samples, on the stream's clock [s]
  std::vector<double> numbers;     ///< sample by sample; of a stream of numbers
  std::vector<std::string> words;  ///< the same of a stream of strings
  std::vector<XdfClockOffset> offsets;
  bool kept = false;  ///< else its samples were passed over

  bool has_words() const { return format == "string"; }
};

struct XdfFile {
  XmlElement header;
  std::vector<XdfStream> streams;  ///< in the order of their headers
  std::vector<std::string> notes;  ///< what is damaged or missing
};

/// Bytes that are read in pieces.
struct XdfBytes {
  std::size_t size = 0;
  /// The bytes from a position, fewer at the end; valid until the next call.
  std::function<std::span<const std::uint8_t>(std::size_t at, std::size_t count)> read;
};

/// Reads all chunks. Reading continues at the next boundary after a damaged one, and ends where the file
/// was cut; both are notes.
///
/// @param wanted  whether the samples of a stream, whose header alone is known, are kept
/// @throws std::invalid_argument  naming `where`: no XDF, or more numbers than memory should have
XdfFile read_xdf(const XdfBytes& bytes, std::string_view where,
                 const std::function<bool(const XdfStream&)>& wanted);

/// The header alone; nothing if the file is no XDF, or does not begin with a whole header.
std::optional<XmlElement> xdf_header(const XdfBytes& bytes);

/// The bytes before the first chunk, and those that end a boundary.
inline constexpr std::string_view kXdfMagic = "XDF:";
inline constexpr std::string_view kXdfBoundary =
    "\x43\xa5\x46\xdc\xcb\xf5\x41\x0f\xb3\x0e\xd5\x46\x73\x83\xcb\xe4";

enum class XdfTag : std::uint16_t { header = 1, stream, samples, offset, boundary, footer };

}  // namespace headpin::devices
