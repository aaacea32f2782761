#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"

/// What others can look at: shapes and their poses for Drake's viewer, the eyes' pictures.
///
/// The messages are byte for byte Drake's lcmt_viewer_load_robot, lcmt_viewer_draw and
/// lcmt_image_array.
namespace headpin::devices {

constexpr const char* kViewerLoadChannel = "DRAKE_VIEWER_LOAD_ROBOT";
constexpr const char* kViewerDrawChannel = "DRAKE_VIEWER_DRAW";
constexpr const char* kEyesChannel = "HEADPIN_EYES";

/// A shape on a link. Measures as Drake has them: a box its three sides, a sphere its radius, a
/// cylinder its radius and length, an ellipsoid its three semi-axes [m].
struct ViewerGeometry {
  enum Type : std::int8_t { box = 1, sphere = 2, cylinder = 3, ellipsoid = 6 };
  Type type = box;
  Pose X_BG;
  std::vector<float> measures;
  Vec3 colour = Vec3::Constant(0.8);  ///< RGB, 0..1
};

struct ViewerLink {
  std::string name;
  std::vector<ViewerGeometry> geometries;
};

struct ViewerPose {
  std::string name;  ///< of the link
  Pose X_WB;
};

/// Both eyes, left first; each either raw RGB rows from the top or a PNG file.
struct EyePictures {
  std::int32_t sequence = 0;
  Time time{};
  std::int32_t width = 0, height = 0;  ///< pixels of an eye
  bool png = false;
  std::span<const std::uint8_t> left, right;
};

/// Each writes its message into `out`, which is resized.
void encode(std::span<const ViewerLink> links, std::vector<std::uint8_t>& out);
void encode(Time time, std::span<const ViewerPose> poses, std::vector<std::uint8_t>& out);
void encode(const EyePictures& eyes, std::vector<std::uint8_t>& out);

}  // namespace headpin::devices
