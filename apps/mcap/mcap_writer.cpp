#include "apps/mcap/mcap_writer.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

namespace headpin::apps {

namespace {

static_assert(std::endian::native == std::endian::little, "an MCAP file is little-endian");

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

enum class Op : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  metadata = 12,
  metadata_index = 13,
  summary_offset = 14,
  data_end = 15,
};

template <typename T>
void append_fixed(std::string& to, T number) {
  to.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// A string, or bytes, behind their length.
void append_sized(std::string& to, std::string_view text) {
  append_fixed(to, static_cast<std::uint32_t>(text.size()));
  to += text;
}

void append_record(std::string& to, Op op, std::string_view content) {
  to += static_cast<char>(op);
  append_fixed(to, std::uint64_t{content.size()});
  to += content;
}

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string compressed(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size)) {
    throw std::runtime_error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  }
  out.resize(size);
  return out;
}

}  // namespace

void McapWriter::Span::add(std::uint64_t time) {
  first = std::min(first, time);
  last = std::max(last, time);
}

/// Both 0 without messages.
std::pair<std::uint64_t, std::uint64_t> McapWriter::Span::bounds() const {
  return first > last ? std::pair<std::uint64_t, std::uint64_t>() : std::pair(first, last);
}

McapWriter::McapWriter(std::function<void(std::string_view)> put_bytes)
    : put_(std::move(put_bytes)) {
  std::string header, record;
  append_sized(header, "");  // no profile
  append_sized(header, "headpin");
  append_record(record, Op::header, header);
  put(kMcapMagic);
  put(record);
}

void McapWriter::put(std::string_view bytes) {
  put_(bytes);
  written_ += bytes.size();
  crc_ = crc_of(bytes, crc_);
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  std::string schema, record;
  append_fixed(schema, ++schema_count_);
  append_sized(schema, name);
  append_sized(schema, encoding);
  append_sized(schema, data);
  append_record(record, Op::schema, schema);
  chunk_ += record;
  schemas_ += record;
  return schema_count_;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, std::string_view encoding,
                                      std::uint16_t schema) {
  if (topics_.size() == std::numeric_limits<std::uint16_t>::max()) {
    throw std::runtime_error(
        fmt::format("more than {} channels, which MCAP cannot count", topics_.size()));
  }
  topics_.push_back({topic, 0});
  const auto number = static_cast<std::uint16_t>(topics_.size());
  std::string channel, record;
  append_fixed(channel, number);
  append_fixed(channel, schema);
  append_sized(channel, topic);
  append_sized(channel, encoding);
  append_sized(channel, "");  // no metadata
  append_record(record, Op::channel, channel);
  chunk_ += record;
  channels_ += record;
  return number;
}

void McapWriter::add(const Message& message) {
  index_[message.channel].emplace_back(message.log_ns, chunk_.size());
  std::string head;
  append_fixed(head, message.channel);
  append_fixed(head, message.sequence);
  append_fixed(head, message.log_ns);
  append_fixed(head, message.publish_ns);
  chunk_ += static_cast<char>(Op::message);
  append_fixed(chunk_, std::uint64_t{head.size() + message.data.size()});
  chunk_ += head;
  chunk_ += message.data;
  chunk_span_.add(message.log_ns);
  span_.add(message.log_ns);
  ++topics_[message.channel - 1U].messages;
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

/// Writes the records that are kept as a chunk, the indexes of its messages behind it.
void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::string records = compressed(chunk_);
  const auto [first, last] = chunk_span_.bounds();
  std::string chunk, record;
  append_fixed(chunk, first);
  append_fixed(chunk, last);
  append_fixed(chunk, std::uint64_t{chunk_.size()});
  append_fixed(chunk, crc_of(chunk_));
  append_sized(chunk, "zstd");
  append_fixed(chunk, std::uint64_t{records.size()});
  chunk += records;
  append_record(record, Op::chunk, chunk);
  const std::uint64_t at = written_;
  put(record);

  std::string indexes, places;
  for (const auto& [channel, messages] : index_) {
    append_fixed(places, channel);
    append_fixed(places, written_ + indexes.size());
    std::string index, entries;
    for (const auto& [time, place] : messages) {
      append_fixed(entries, time);
      append_fixed(entries, place);
    }
    append_fixed(index, channel);
    append_sized(index, entries);
    append_record(indexes, Op::message_index, index);
  }
  put(indexes);

  std::string entry;
  append_fixed(entry, first);
  append_fixed(entry, last);
  append_fixed(entry, at);
  append_fixed(entry, std::uint64_t{record.size()});
  append_sized(entry, places);
  append_fixed(entry, std::uint64_t{indexes.size()});
  append_sized(entry, "zstd");
  append_fixed(entry, std::uint64_t{records.size()});
  append_fixed(entry, std::uint64_t{chunk_.size()});
  append_record(chunk_index_, Op::chunk_index, entry);
  ++chunk_count_;
  chunk_.clear();
  chunk_span_ = {};
  index_.clear();
}

void McapWriter::add_metadata(std::string_view name,
                              const std::map<std::string, std::string>& facts) {
  end_chunk();
  std::string metadata, pairs, record, entry;
  for (const auto& [key, value] : facts) {
    append_sized(pairs, key);
    append_sized(pairs, value);
  }
  append_sized(metadata, name);
  append_sized(metadata, pairs);
  append_record(record, Op::metadata, metadata);
  append_fixed(entry, written_);
  append_fixed(entry, std::uint64_t{record.size()});
  append_sized(entry, name);
  append_record(metadata_index_, Op::metadata_index, entry);
  ++metadata_count_;
  put(record);
}

std::string McapWriter::statistics() const {
  std::uint64_t all = 0;
  std::string counts;
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    append_fixed(counts, static_cast<std::uint16_t>(i + 1));
    append_fixed(counts, topics_[i].messages);
    all += topics_[i].messages;
  }
  const auto [first, last] = span_.bounds();
  std::string content, record;
  append_fixed(content, all);
  append_fixed(content, schema_count_);
  append_fixed(content, static_cast<std::uint32_t>(topics_.size()));
  append_fixed(content, std::uint32_t{0});  // attachments
  append_fixed(content, metadata_count_);
  append_fixed(content, chunk_count_);
  append_fixed(content, first);
  append_fixed(content, last);
  append_sized(content, counts);
  append_record(record, Op::statistics, content);
  return record;
}

void McapWriter::put_summary() {
  const std::uint64_t summary = written_;
  crc_ = 0;
  std::string offsets;
  const auto put_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    std::string offset;
    offset += static_cast<char>(op);
    append_fixed(offset, written_);
    append_fixed(offset, std::uint64_t{records.size()});
    append_record(offsets, Op::summary_offset, offset);
    put(records);
  };
  put_group(Op::schema, schemas_);
  put_group(Op::channel, channels_);
  put_group(Op::statistics, statistics());
  put_group(Op::metadata_index, metadata_index_);
  put_group(Op::chunk_index, chunk_index_);
  const std::uint64_t summary_offsets = written_;
  put(offsets);

  // The checksum of the summary covers the footer up to itself.
  constexpr std::uint64_t kFooterBytes = 2 * sizeof(std::uint64_t) + sizeof(std::uint32_t);
  std::string footer;
  footer += static_cast<char>(Op::footer);
  append_fixed(footer, kFooterBytes);
  append_fixed(footer, summary);
  append_fixed(footer, summary_offsets);
  append_fixed(footer, crc_of(footer, crc_));
  put(footer);
}

void McapWriter::finish() {
  end_chunk();
  std::string crc, record;
  append_fixed(crc, crc_);
  append_record(record, Op::data_end, crc);
  put(record);
  put_summary();
  put(kMcapMagic);
}

}  // namespace headpin::apps
