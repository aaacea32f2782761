#pragma once

#include <cstdint>

#include "base/math.h"

/// The expanding polytope algorithm, EPA (van den Bergen 2001), with a given depth to beat. Private
/// to the engine.
namespace headpin::engine {

/// Points of A - B and the triangles between them, with the origin inside. The solid that they
/// bound lies within A - B, so no way out is shorter than the distance to the nearest triangle.
class Polytope {
 public:
  /// Point of A - B furthest along a direction of any length.
  using Furthest = Vec3 (*)(void* pair, const Vec3& n);

  /// @param n, s  unit direction of a way out, and the point of A - B where it ends
  Polytope(Furthest furthest, void* pair, const Vec3& n, const Vec3& s);

  /// Finds a direction in which the way out is below `depth`. Returns false if there is none, or if
  /// there is no room for more points. The next call, with a smaller depth, continues from there.
  bool find_shorter(double depth, Vec3& n);

  /// Whether it returned false for lack of room, or because rounding broke the polytope. Then
  /// nothing is proven, and n is the normal of the nearest triangle.
  bool gave_up() const { return gave_up_; }

 private:
  static constexpr int kPoints = 500, kFaces = 2 * kPoints;
  struct Face {
    std::uint16_t corner[3];
    Vec3 normal;    // unit, outward
    double offset;  // normal . x on it; infinite: a sliver without a plane, or part of the surface
  };

  struct Edge {  // of the visible faces; not a std::pair, which would be set to zero
    std::uint16_t from, to;
    bool operator==(const Edge&) const = default;
  };

  bool holds_ball(double radius) const;
  void start();
  void add_face(int i, int j, int k);
  bool insert(int point);

  Furthest furthest_;
  void* pair_;
  Vec3 n_;
  Vec3 points_[kPoints];
  int count_ = 0;
  Face faces_[kFaces];
  int face_count_ = 0;
  bool made_anew_ = false, gave_up_ = false;
  double rounding_ = 0.0;  // distance from a plane that is only rounding [m]
};

}  // namespace headpin::engine
