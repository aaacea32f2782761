#pragma once

#include <memory>
#include <vector>

#include "render/data/mesh.h"

/// A bowling room drawn by MuJoCo with OSMesa: our skittle, ball and hand, one lamp that casts shadows.
namespace headpin::bench {

class MujocoPictures {
 public:
  struct Scene {
    render::Mesh skittle, hand;
    std::vector<Pose> X_WB_skittles;
    Pose X_WB_ball, X_WH;
    double ball_radius = 0.1085;
    Pose X_WD;  ///< the eyes are 64 mm apart
  };

  /// @param samples  a pixel, 0 or 4: those are the ones there are
  /// @throws std::runtime_error  where MuJoCo or OSMesa do not do it
  MujocoPictures(const Scene& scene, int samples);
  ~MujocoPictures();
  MujocoPictures(const MujocoPictures&) = delete;
  MujocoPictures& operator=(const MujocoPictures&) = delete;

  /// Both eyes of 360 x 240 pixels, read back, so many times.
  /// @return  something of the pictures
  double draw(std::size_t times);
  /// The left eye's, rows from the bottom, three bytes a pixel.
  const std::vector<unsigned char>& left() const { return left_; }

 private:
  void draw_here();
  struct Inside;
  std::unique_ptr<Inside> inside_;
  std::vector<unsigned char> left_, right_;
};

}  // namespace headpin::bench
