#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "base/math.h"
#include "devices/base/version.h"
#include "devices/log/layout.h"
#include "devices/log/sample_messages.h"

/// What lcm-gen makes of a type <-> bytes, and of poses <-> its fields.
///
/// Decoding checks every length against the available bytes before the code of lcm-gen reads them.
namespace headpin::devices {

inline void put(const Vec3& v, double (&out)[3]) {
  std::copy_n(v.data(), 3, out);
}

inline void put(const Pose& pose, double (&position)[3], double (&quaternion)[4]) {
  put(pose.p, position);
  quaternion[0] = pose.q.w();
  quaternion[1] = pose.q.x();
  quaternion[2] = pose.q.y();
  quaternion[3] = pose.q.z();
}

inline Vec3 vec3(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

inline Pose pose(const double (&position)[3], const double (&quaternion)[4]) {
  return {Quat(quaternion[0], quaternion[1], quaternion[2], quaternion[3]), vec3(position)};
}

/// Less than 126 years from 0.
inline bool plausible(Time time) {
  constexpr Time kLimit{4'000'000'000'000'000};  // as a stamp since 1970, the year 2096
  return -kLimit < time && time < kLimit;
}

/// Finite, and its quaternion is unit to 1e-3.
inline bool plausible(const Pose& pose) {
  return pose.p.allFinite() && std::abs(pose.q.norm() - 1.0) < 1e-3;
}

/// Writes the message into `out`, which is resized; its memory is reused.
template <typename Lcm>
void encode_as(const Lcm& message, Buffer& out) {
  const int size = message.getEncodedSize();
  out.resize(static_cast<std::size_t>(size));
  const int written = message.encode(out.data(), 0, size);
  if (written < 0) throw std::invalid_argument("cannot encode a message for LCM");
  out.resize(static_cast<std::size_t>(written));
}

/// Nothing if its type, its size or a length is wrong.
template <typename Lcm>
std::optional<Lcm> decode_as(std::span<const std::uint8_t> bytes) {
  static const Layouts layouts(schema_text());
  static const std::string type = Lcm::getTypeName();
  constexpr std::ptrdiff_t kFingerprint = 8;
  const auto size = static_cast<std::ptrdiff_t>(bytes.size());
  if (size < kFingerprint || size > std::numeric_limits<int>::max()) return std::nullopt;
  if (layouts.end_of(type, bytes, kFingerprint) != size) return std::nullopt;
  Lcm message;
  const int length = static_cast<int>(size);
  if (message.decode(bytes.data(), 0, length) != length) return std::nullopt;
  return message;
}

}  // namespace headpin::devices
