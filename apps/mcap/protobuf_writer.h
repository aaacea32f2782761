#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace headpin::apps {

/// Makes one message in the wire format of Protocol Buffers.
///
/// https://protobuf.dev/programming-guides/encoding: a field is its key (number * 8 + kind) and its value. What is
/// written is known here, and reading is not needed, so the generated classes and their library are not either.
class ProtobufWriter {
 public:
  /// Types int64, int32, bool and enumerations; not negative.
  void varint(std::uint32_t field, std::uint64_t value) {
    put_key(field, kVarint);
    put_varint(value);
  }
  /// Type double.
  void number(std::uint32_t field, double value) {
    put_key(field, kFixed64);
    put_fixed(value);
  }
  /// Type fixed32.
  void fixed32(std::uint32_t field, std::uint32_t value) {
    put_key(field, kFixed32);
    put_fixed(value);
  }
  /// Types string and bytes.
  void text(std::uint32_t field, std::string_view value) {
    put_key(field, kLengthFirst);
    put_varint(value.size());
    bytes_ += value;
  }
  void message(std::uint32_t field, const ProtobufWriter& value) { text(field, value.bytes_); }
  /// Types repeated double and repeated fixed32.
  template <typename T>
  void list(std::uint32_t field, std::span<const T> values) {
    put_key(field, kLengthFirst);
    put_varint(values.size_bytes());
    for (const T value : values) put_fixed(value);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  static_assert(std::endian::native == std::endian::little, "fixed numbers are little-endian");
  static constexpr std::uint32_t kVarint = 0, kFixed64 = 1, kLengthFirst = 2, kFixed32 = 5;

  void put_key(std::uint32_t field, std::uint32_t kind) { put_varint(field * 8 + kind); }
  void put_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>(value | 0x80);
    bytes_ += static_cast<char>(value);
  }
  template <typename T>
  void put_fixed(T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes_.append(raw, sizeof value);
  }

  std::string bytes_;
};

}  // namespace headpin::apps
