#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace headpin::apps {

/// Writes an MCAP file (https://mcap.dev/spec): chunks compressed by zstd, with their indexes, a summary and checksums.
///
/// In memory are the messages of one chunk, and for each chunk that was written its entry of the index.
class McapWriter {
 public:
  /// @param put  takes the bytes of the file, in their order
  explicit McapWriter(std::function<void(std::string_view)> put);

  /// @return  number of the schema
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);

  /// @param schema  0: none
  /// @return        number of the channel
  /// @throws std::runtime_error  when there are too many
  std::uint16_t add_channel(const std::string& topic, std::string_view encoding,
                            std::uint16_t schema);

  struct Message {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_ns = 0, publish_ns = 0;
    std::string_view data;
  };
  void add(const Message& message);

  /// Facts about the whole file, by their names.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& facts);

  /// Writes the last chunk, the summary and the end of the file.
  void finish();

  struct Topic {
    std::string name;
    std::uint64_t messages = 0;
  };
  const std::vector<Topic>& topics() const { return topics_; }

 private:
  struct Span {
    std::uint64_t first = ~std::uint64_t{0}, last = 0;  ///< [ns]
    void add(std::uint64_t time);
    std::pair<std::uint64_t, std::uint64_t> bounds() const;
  };
  void put(std::string_view bytes);
  void end_chunk();
  void put_summary();
  std::string statistics() const;

  std::function<void(std::string_view)> put_;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;  ///< since the begin of the file, later of the summary

  std::string chunk_;  ///< records that are not written yet
  Span chunk_span_, span_;
  /// Time and place in the chunk of each message, by channel.
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;

  std::uint16_t schema_count_ = 0;
  std::uint32_t chunk_count_ = 0, metadata_count_ = 0;
  std::vector<Topic> topics_;                                      ///< of channel 1, 2, ...
  std::string schemas_, channels_, chunk_index_, metadata_index_;  ///< records of the summary
};

}  // namespace headpin::apps
