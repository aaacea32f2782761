#include "devices/recordings/xdf_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/recordings/any_table.h"
#include "devices/recordings/text_encoding.h"

namespace headpin::devices {
namespace {

using ByteSpan = std::span<const std::uint8_t>;

constexpr std::size_t kMostNumbers = 30'000'000;  // that are kept
constexpr std::size_t kMostChannels = 100'000;    // of a stream
constexpr std::size_t kMostStreams = 10'000;
constexpr std::size_t kLongestHeader = 4'000'000;  // bytes of XML
constexpr std::uint16_t kLargestTag = 100;         // 7 and above may get a meaning some day

/// A chunk that is not as the format says.
struct BadChunk : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::uint64_t number_at_front(ByteSpan bytes, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < size; ++i) number |= std::uint64_t{bytes[i]} << (8 * i);
  return number;
}

/// Takes from the front of a chunk.
class ChunkContent {
 public:
  explicit ChunkContent(ByteSpan bytes) : rest_(bytes) {}

  std::size_t left() const { return rest_.size(); }

  ByteSpan take(std::size_t size) {
    if (size > rest_.size()) throw BadChunk("it is shorter than what it says");
    const ByteSpan taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  std::uint64_t number(std::size_t size) { return number_at_front(take(size), size); }
  double real() { return std::bit_cast<double>(number(8)); }
  std::string text(std::size_t size) {
    const ByteSpan taken = take(size);
    return {taken.begin(), taken.end()};
  }
  /// A number after the number of its bytes: 1, 4 or 8.
  std::uint64_t counted() {
    const std::uint64_t size = number(1);
    if (size != 1 && size != 4 && size != 8) throw BadChunk("a length has no 1, 4 or 8 bytes");
    return number(static_cast<std::size_t>(size));
  }

 private:
  ByteSpan rest_;
};

/// Bytes of one value; 0 for a string, nothing for an unknown format.
std::optional<std::size_t> size_of(std::string_view format) {
  if (format == "string") return 0;
  if (format == "int8") return 1;
  if (format == "int16") return 2;
  if (format == "float32" || format == "int32") return 4;
  if (format == "double64" || format == "int64") return 8;
  return std::nullopt;
}

double value_of(std::uint64_t bits, std::string_view format) {
  if (format == "double64") return std::bit_cast<double>(bits);
  if (format == "float32") return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  if (format == "int8") return static_cast<std::int8_t>(bits);
  if (format == "int16") return static_cast<std::int16_t>(bits);
  if (format == "int32") return static_cast<std::int32_t>(bits);
  return static_cast<double>(static_cast<std::int64_t>(bits));
}

double real_in(const std::string& text) {
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Samples a second, with or without "Hz" in letters of any size; nothing for a text that is none.
std::optional<double> rate_in(const std::string& text) {
  double rate = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, rate);
  if (read.ec != std::errc{} || !std::isfinite(rate) || rate < 0.0) return std::nullopt;
  const std::string_view rest(read.ptr, static_cast<std::size_t>(end - read.ptr));
  const std::string_view unit = rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
  if (!unit.empty() && small_letters(unit) != "hz") return std::nullopt;
  return rate;
}

XdfStream stream_of(std::uint32_t id, const XmlElement& info) {
  XdfStream stream;
  stream.id = id;
  stream.name = info.text_at({"name"});
  stream.type = info.text_at({"type"});
  stream.format = info.text_at({"channel_format"});
  stream.rate_hz = rate_in(info.text_at({"nominal_srate"})).value_or(0.0);
  const double count = real_in(info.text_at({"channel_count"}));
  if (!(count >= 1.0 && count <= kMostChannels)) {
    throw BadChunk(fmt::format("expected 1 to {} channels, found '{}'", kMostChannels,
                               beginning(info.text_at({"channel_count"}), 20)));
  }
  if (!size_of(stream.format)) {
    throw BadChunk(fmt::format("unknown channel_format '{}'", beginning(stream.format, 20)));
  }
  stream.channels.resize(static_cast<std::size_t>(count));
  const XmlElement* described = info.find({"desc", "channels"});
  std::size_t c = 0;
  for (const XmlElement& channel : described ? described->children : std::vector<XmlElement>{}) {
    if (channel.name != "channel") continue;
    if (c == stream.channels.size()) break;
    std::string object = channel.text_at({"object"});
    // Programs give the markers of an object its name.
    const std::string marker = channel.text_at({"marker"});
    if (object.empty() && !marker.empty()) object = marker + " marker";
    stream.channels[c++] = {channel.text_at({"label"}), channel.text_at({"type"}),
                            channel.text_at({"unit"}), std::move(object)};
  }
  return stream;
}

class XdfReader {
 public:
  XdfReader(const XdfBytes& bytes, std::string_view where,
            const std::function<bool(const XdfStream&)>& wanted)
      : bytes_(bytes), where_(where), wanted_(wanted) {}

  bool begins() const { return std::ranges::equal(bytes_.read(0, kXdfMagic.size()), kXdfMagic); }

  std::optional<XmlElement> read_header() {
    if (!begins()) return std::nullopt;
    at_ = kXdfMagic.size();
    try {
      const Chunk chunk = chunk_here();
      if (chunk.tag != static_cast<std::uint16_t>(XdfTag::header)) return std::nullopt;
      take_header(chunk);
      return std::move(file_.header);
    } catch (const BadChunk&) {
      return std::nullopt;
    }
  }

  XdfFile read() {
    if (!begins()) {
      throw std::invalid_argument(fmt::format("{}: expected XDF, which begins with XDF:", where_));
    }
    for (at_ = kXdfMagic.size(); at_ < bytes_.size;) {
      try {
        take_chunk();
      } catch (const BadChunk& bad) {
        if (!go_on(bad.what())) break;
      }
    }
    say_what_is_missing();
    return std::move(file_);
  }

 private:
  /// Where the content of the chunk at at_ begins and ends.
  struct Chunk {
    std::size_t begin = 0, end = 0;
    std::uint16_t tag = 0;
  };

  Chunk chunk_here() const {
    ChunkContent head(bytes_.read(at_, 11));
    const std::size_t before = head.left();
    const std::uint64_t length = head.counted();
    const std::size_t begin = at_ + before - head.left();
    if (length > bytes_.size - begin) throw BadChunk("it is longer than the rest of the file");
    if (length < 2) throw BadChunk("it has no tag");
    const auto tag = static_cast<std::uint16_t>(head.number(2));
    if (tag == 0 || tag > kLargestTag) throw BadChunk(fmt::format("unknown tag {}", tag));
    return {begin + 2, begin + static_cast<std::size_t>(length), tag};
  }

  void take_chunk() {
    const Chunk chunk = chunk_here();
    const auto tag = static_cast<XdfTag>(chunk.tag);
    try {
      if (tag == XdfTag::header) take_header(chunk);
      if (tag == XdfTag::stream) take_stream(chunk);
      if (tag == XdfTag::samples) take_samples(chunk);
      if (tag == XdfTag::offset) take_offset(chunk);
      if (tag == XdfTag::footer) ++footers_;
    } catch (const BadChunk& bad) {
      // Its length leads to another chunk, so this one alone is left out.
      note(fmt::format("the chunk at byte {} is damaged ({}): ignored", at_, bad.what()));
    }
    at_ = chunk.end;
  }

  ChunkContent content(const Chunk& chunk) const {
    return ChunkContent(bytes_.read(chunk.begin, chunk.end - chunk.begin));
  }

  XmlElement xml_of(ChunkContent& content) const {
    if (content.left() > kLongestHeader) throw BadChunk("its XML is too long");
    try {
      return parse_xml(content.text(content.left()));
    } catch (const std::invalid_argument& error) {
      throw BadChunk(error.what());
    }
  }

  void take_header(const Chunk& chunk) {
    ChunkContent in = content(chunk);
    file_.header = xml_of(in);
  }

  void take_stream(const Chunk& chunk) {
    ChunkContent in = content(chunk);
    const auto id = static_cast<std::uint32_t>(in.number(4));
    if (places_.contains(id)) throw BadChunk(fmt::format("stream {} has begun before", id));
    if (places_.size() == kMostStreams) throw BadChunk("too many streams");
    const XmlElement info = xml_of(in);
    XdfStream& stream = file_.streams.emplace_back(stream_of(id, info));
    stream.kept = wanted_(stream);
    const std::string rate = info.text_at({"nominal_srate"});
    if (stream.kept && !rate.empty() && !rate_in(rate)) {
      note(fmt::format("stream '{}': expected a nominal_srate of 0 or more, found '{}': taken as 0",
                       beginning(stream.name, 40), beginning(rate, 20)));
    }
    places_[id] = {file_.streams.size() - 1, 0.0};
  }

  struct Place {
    std::size_t index = 0;
    double last = 0.0;  ///< time of the last sample
  };

  Place& place_of(ChunkContent& in) {
    const auto id = static_cast<std::uint32_t>(in.number(4));
    const auto found = places_.find(id);
    if (found == places_.end()) throw BadChunk(fmt::format("stream {} has no header", id));
    return found->second;
  }

  void take_samples(const Chunk& chunk) {
    ChunkContent head(bytes_.read(chunk.begin, std::min<std::size_t>(4, chunk.end - chunk.begin)));
    Place& place = place_of(head);
    XdfStream& stream = file_.streams[place.index];
    if (!stream.kept) return;
    ChunkContent in = content(chunk);
    in.take(4);
    const std::uint64_t count = in.counted();
    if (count > in.left()) throw BadChunk("it has fewer bytes than samples");
    const std::array<std::size_t, 3> before = {stream.times.size(), stream.numbers.size(),
                                               stream.words.size()};
    const double last = place.last;
    try {
      for (std::uint64_t i = 0; i < count; ++i) take_sample(in, stream, place);
    } catch (const BadChunk&) {
      stream.times.resize(before[0]);
      stream.numbers.resize(before[1]);
      stream.words.resize(before[2]);
      place.last = last;
      throw;
    }
  }

  void take_sample(ChunkContent& in, XdfStream& stream, Place& place) {
    const std::uint64_t size = in.number(1);
    if (size != 0 && size != 8) throw BadChunk("a time has neither 0 nor 8 bytes");
    // A time that is left out follows from the one before.
    const double step = stream.rate_hz > 0.0 ? 1.0 / stream.rate_hz : 0.0;
    const double time = size == 8 ? in.real() : place.last + step;
    const std::size_t width = *size_of(stream.format);
    for (std::size_t c = 0; c < stream.channels.size(); ++c) {
      if (++numbers_ > kMostNumbers) {
        throw std::invalid_argument(fmt::format(
            "{}: expected at most {} numbers of motion, found more", where_, kMostNumbers));
      }
      if (width == 0) {
        stream.words.push_back(in.text(static_cast<std::size_t>(in.counted())));
      } else {
        stream.numbers.push_back(value_of(in.number(width), stream.format));
      }
    }
    stream.times.push_back(place.last = time);
  }

  void take_offset(const Chunk& chunk) {
    ChunkContent in = content(chunk);
    XdfStream& stream = file_.streams[place_of(in).index];
    const double time = in.real(), value = in.real();
    stream.offsets.push_back({time, value, stream.times.size()});
  }

  /// After a chunk whose end is not known: goes to the next boundary. False at the end of the file.
  bool go_on(const std::string& what) {
    const std::size_t from = at_;
    const std::size_t boundary = find_boundary(from);
    if (boundary == bytes_.size) {
      note(fmt::format(
          "the file ends inside a chunk, or is damaged from byte {} on ({}): the {} bytes "
          "from there are ignored",
          from, what, bytes_.size - from));
      return false;
    }
    at_ = boundary + kXdfBoundary.size();
    note(fmt::format("bytes {} to {} are damaged ({}): ignored", from, at_, what));
    return true;
  }

  std::size_t find_boundary(std::size_t from) const {
    constexpr std::size_t kPiece = 1 << 16;
    for (; from < bytes_.size; from += kPiece) {
      const ByteSpan piece = bytes_.read(from, kPiece + kXdfBoundary.size() - 1);
      const std::string_view text(reinterpret_cast<const char*>(piece.data()), piece.size());
      const std::size_t found = text.find(kXdfBoundary);
      if (found != std::string_view::npos) return from + found;
    }
    return bytes_.size;
  }

  void say_what_is_missing() {
    if (damaged_ > kMostNotes) {
      file_.notes.push_back(fmt::format("{} more places are damaged", damaged_ - kMostNotes));
    }
    if (footers_ < places_.size()) {
      file_.notes.push_back(
          fmt::format("{} of {} streams have no footer: the recorder did not end the file",
                      places_.size() - footers_, places_.size()));
    }
  }

  void note(std::string what) {
    if (++damaged_ <= kMostNotes) file_.notes.push_back(std::move(what));
  }

  static constexpr std::size_t kMostNotes = 5;

  const XdfBytes& bytes_;
  std::string_view where_;
  const std::function<bool(const XdfStream&)>& wanted_;
  std::size_t at_ = 0, numbers_ = 0, footers_ = 0, damaged_ = 0;
  std::map<std::uint32_t, Place> places_;
  XdfFile file_;
};

}  // namespace

XdfFile read_xdf(const XdfBytes& bytes, std::string_view where,
                 const std::function<bool(const XdfStream&)>& wanted) {
  return XdfReader(bytes, where, wanted).read();
}

std::optional<XmlElement> xdf_header(const XdfBytes& bytes) {
  const std::function<bool(const XdfStream&)> none = [](const XdfStream&) { return false; };
  return XdfReader(bytes, "", none).read_header();
}

}  // namespace headpin::devices
