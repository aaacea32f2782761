#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/math.h"

/// Numbers as bytes, for whoever saves a state and restores it. Little-endian, the same on every
/// machine.
namespace headpin::engine {

inline std::uint64_t fnv(std::span<const std::uint8_t> bytes) {
  Fnv hash;
  for (const std::uint8_t byte : bytes) hash.add(byte);
  return hash.value();
}

/// Writes numbers: a name and a version first, a checksum at the end.
class SavedWriter {
 public:
  SavedWriter() = default;  ///< without name and version
  SavedWriter(std::string_view name, std::uint8_t version) {
    bytes.assign(name.begin(), name.end());
    add(version);
  }

  void add(std::uint8_t x) { bytes.push_back(x); }
  void add(std::uint32_t x) { put(x, 4); }
  void add(std::uint64_t x) { put(x, 8); }
  void add(std::int32_t x) { put(static_cast<std::uint32_t>(x), 4); }
  void add(std::int64_t x) { put(static_cast<std::uint64_t>(x), 8); }
  void add(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    put(bits, 8);
  }
  void add(bool x) { add(static_cast<std::uint8_t>(x ? 1 : 0)); }
  void add(Time x) { add(std::int64_t{x.count()}); }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  void add(const Quat& q) {
    for (int k = 0; k < 4; ++k) add(q.coeffs()[k]);
  }
  void add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
  }

  /// All bytes, with their checksum.
  std::vector<std::uint8_t> sealed() {
    add(fnv(bytes));
    return std::exchange(bytes, {});
  }

  std::vector<std::uint8_t> bytes;

 private:
  void put(std::uint64_t x, int count) {
    for (int k = 0; k < count; ++k, x >>= 8) bytes.push_back(static_cast<std::uint8_t>(x));
  }
};

/// Reads what a SavedWriter wrote.
///
/// Every function throws std::invalid_argument for bytes that cannot be such: too few, a number that
/// is not finite, a flag that is neither 0 nor 1, a time of more than 126 years.
class SavedReader {
 public:
  /// @param what  is read, for errors: "saved world"
  /// @throws std::invalid_argument  for another name, version or checksum
  SavedReader(std::span<const std::uint8_t> bytes, std::string_view name, std::uint8_t version,
              std::string what)
      : what_(std::move(what)) {
    constexpr std::size_t kChecksum = 8;
    const std::size_t head = name.size() + 1;
    if (bytes.size() < head + kChecksum || !std::equal(name.begin(), name.end(), bytes.begin())) {
      refuse("expected the bytes of a " + what_ + ", found others");
    }
    if (const std::uint8_t found = bytes[name.size()]; found != version) {
      refuse("version " + std::to_string(found) + ", expected " + std::to_string(version));
    }
    left_ = bytes.last(kChecksum);
    std::uint64_t checksum = 0;
    get(checksum);
    left_ = bytes.first(bytes.size() - kChecksum);
    if (checksum != fnv(left_)) refuse("cut off or changed: its checksum is another");
    left_ = left_.subspan(head);
  }

  void get(std::uint8_t& x) { x = static_cast<std::uint8_t>(take(1)); }
  void get(std::uint32_t& x) { x = static_cast<std::uint32_t>(take(4)); }
  void get(std::uint64_t& x) { x = take(8); }
  void get(std::int32_t& x) { x = static_cast<std::int32_t>(take(4)); }
  void get(std::int64_t& x) { x = static_cast<std::int64_t>(take(8)); }
  void get(double& x) {
    const std::uint64_t bits = take(8);
    std::memcpy(&x, &bits, sizeof x);
    if (!std::isfinite(x)) refuse("expected finite numbers");
  }
  void get(bool& x) {
    const std::uint64_t byte = take(1);
    if (byte > 1) refuse("expected 0 or 1, found " + std::to_string(byte));
    x = byte == 1;
  }
  void get(Time& x) {
    constexpr std::int64_t kMost = 4'000'000'000'000'000;
    std::int64_t us = 0;
    get(us);
    if (us <= -kMost || us >= kMost) refuse("a time is out of range");
    x = Time{us};
  }
  void get(Vec3& v) {
    for (int k = 0; k < 3; ++k) get(v[k]);
  }
  void get(Quat& q) {
    for (int k = 0; k < 4; ++k) get(q.coeffs()[k]);
  }
  /// Reads the number of items that follow. @param least  minimum number of bytes of an item
  std::size_t count(std::size_t least) {
    std::uint32_t n = 0;
    get(n);
    if (n > left_.size() / least) refuse("ends early");
    return n;
  }
  /// The next bytes.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    if (left_.size() < count) refuse("ends early");
    const std::span<const std::uint8_t> taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  bool empty() const { return left_.empty(); }

  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument(what_ + ": " + why);
  }

 private:
  std::uint64_t take(std::size_t count) {
    const std::span<const std::uint8_t> taken = bytes(count);
    std::uint64_t x = 0;
    for (std::size_t k = count; k-- > 0;) x = x << 8 | taken[k];
    return x;
  }

  std::string what_;
  std::span<const std::uint8_t> left_;
};

}  // namespace headpin::engine
