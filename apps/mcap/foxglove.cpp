#include "apps/mcap/foxglove.h"

#include <algorithm>
#include <array>
#include <vector>

namespace headpin::apps::foxglove {

namespace {

using Doubles = std::span<const double>;

/// google.protobuf.Timestamp; the times of a trial are not negative here.
ProtobufWriter timestamp(Time time) {
  constexpr std::int64_t kMicroseconds = 1'000'000;
  ProtobufWriter out;
  out.varint(1, static_cast<std::uint64_t>(time.count() / kMicroseconds));
  out.varint(2, static_cast<std::uint64_t>(time.count() % kMicroseconds * 1000));
  return out;
}

/// Vector3 and Point3.
ProtobufWriter vector_of(const Vec3& v) {
  ProtobufWriter out;
  out.number(1, v.x());
  out.number(2, v.y());
  out.number(3, v.z());
  return out;
}

ProtobufWriter quaternion(const Quat& q) {
  ProtobufWriter out;
  out.number(1, q.x());
  out.number(2, q.y());
  out.number(3, q.z());
  out.number(4, q.w());
  return out;
}

ProtobufWriter pose(const Pose& X) {
  ProtobufWriter out;
  out.message(1, vector_of(X.p));
  out.message(2, quaternion(X.q));
  return out;
}

/// Color: sRGB, opaque.
ProtobufWriter colour(const Eigen::Vector3f& light) {
  const Vec3 code = render::srgb_of(light.cast<double>().cwiseMin(1.0));
  ProtobufWriter out;
  out.number(1, code.x());
  out.number(2, code.y());
  out.number(3, code.z());
  out.number(4, 1.0);
  return out;
}

}  // namespace

void add_transform(ProtobufWriter& transforms, Time time, std::string_view parent,
                   std::string_view child, const Pose& X) {
  ProtobufWriter out;
  out.message(1, timestamp(time));
  out.text(2, parent);
  out.text(3, child);
  out.message(4, vector_of(X.p));
  out.message(5, quaternion(X.q));
  transforms.message(1, out);
}

std::string pose_in_frame(Time time, std::string_view frame, const Pose& X) {
  ProtobufWriter out;
  out.message(1, timestamp(time));
  out.text(2, frame);
  out.message(3, pose(X));
  return out.bytes();
}

std::string log(Time time, std::string_view name, std::string_view message) {
  constexpr std::uint64_t kInfo = 2;
  ProtobufWriter out;
  out.message(1, timestamp(time));
  out.varint(2, kInfo);
  out.text(3, message);
  out.text(4, name);
  return out.bytes();
}

std::string camera_calibration(Time time, std::string_view frame, const render::View& view) {
  const render::Camera camera(view);
  const std::array K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  const std::array R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  const std::array P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy,
                        camera.cy, 0.0, 0.0,       0.0, 1.0, 0.0};
  ProtobufWriter out;
  out.message(1, timestamp(time));
  out.fixed32(2, static_cast<std::uint32_t>(view.width));
  out.fixed32(3, static_cast<std::uint32_t>(view.height));
  out.list(6, Doubles(K));
  out.list(7, Doubles(R));
  out.list(8, Doubles(P));
  out.text(9, frame);
  return out.bytes();
}

std::string compressed_image(Time time, std::string_view frame, std::string_view format,
                             std::string_view data) {
  ProtobufWriter out;
  out.message(1, timestamp(time));
  out.text(2, data);
  out.text(3, format);
  out.text(4, frame);
  return out.bytes();
}

void add_triangles(ProtobufWriter& entity, const render::Mesh& mesh, const Pose& X) {
  ProtobufWriter out;
  out.message(1, pose(X));
  for (const render::Vertex& vertex : mesh.vertices) {
    out.message(2, vector_of(vertex.p.cast<double>()));
  }
  const bool one_colour = std::ranges::all_of(mesh.vertices, [&](const render::Vertex& vertex) {
    return vertex.colour == mesh.vertices.front().colour;
  });
  if (one_colour && !mesh.vertices.empty()) {
    out.message(3, colour(mesh.vertices.front().colour));
  } else {
    for (const render::Vertex& vertex : mesh.vertices) out.message(4, colour(vertex.colour));
  }
  out.list(5, std::span<const std::uint32_t>(mesh.indices));
  entity.message(12, out);
}

std::string scene_update(Time time, std::string_view frame, std::string_view id,
                         const ProtobufWriter& shapes) {
  ProtobufWriter head;
  head.message(1, timestamp(time));
  head.text(2, frame);
  head.text(3, id);
  head.varint(5, true);  // moves with its frame
  ProtobufWriter out;
  out.text(2, head.bytes() + shapes.bytes());
  return out.bytes();
}

}  // namespace headpin::apps::foxglove
