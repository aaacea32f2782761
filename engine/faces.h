#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "engine/compound.h"

/// Which faces of a polyhedron a body can touch. Private to the engine.
namespace headpin::engine {

/// Faces of a polyhedron whose planes cross the bounds of a body, or of a part of it.
struct Crossed {
  enum What { nothing, one_face, more } what = more;
  const Polyhedron::Face* face = nullptr;  ///< the one
};

/// The faces of a polyhedron that matter to a body.
///
/// A face with all of the body outside its plane proves that they are apart. A face with all of the body
/// inside its plane does not matter. If one face is left, the body can touch that face alone, as if it
/// were a half-space.
class Faces {
 public:
  Faces(const Polyhedron& p, double margin) : all_(p.faces()), margin_(margin) {}

  /// @param bounds  of the body, in the polyhedron's frame
  Crossed crossed(const Capsule& bounds) {
    const double reach = bounds.radius + margin_;
    double above = 0.0;
    count_ = 0;
    for (const Polyhedron::Face& face : all_) {
      const double a = face.normal.dot(bounds.a) - face.offset;
      const double b = face.normal.dot(bounds.b) - face.offset;
      const double low = std::min(a, b);
      if (low > reach) return {Crossed::nothing};
      if (std::max(a, b) <= -reach) continue;
      if (count_ < kKept) kept_[count_] = &face;
      ++count_;
      above = low;
    }
    // Deep inside, another face may be the shorter way out.
    if (count_ != 1 || above < 0.0) return {Crossed::more};
    return {Crossed::one_face, kept_[0]};
  }

  /// The same of a part of the body for which crossed() has answered `more`, by its ball.
  Crossed crossed(const Vec3& centre, double radius) const {
    if (count_ > kKept) return {Crossed::more};
    const double reach = radius + margin_;
    const Polyhedron::Face* one = nullptr;
    double above = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double height = kept_[k]->normal.dot(centre) - kept_[k]->offset;
      if (height > reach) return {Crossed::nothing};
      if (height <= -reach) continue;
      ++count;
      one = kept_[k];
      above = height;
    }
    if (count != 1 || above < 0.0) return {Crossed::more};
    return {Crossed::one_face, one};
  }

 private:
  static constexpr std::size_t kKept = 8;
  std::span<const Polyhedron::Face> all_;
  double margin_;
  std::array<const Polyhedron::Face*, kKept> kept_{};
  std::size_t count_ = 0;
};

}  // namespace headpin::engine
