#include "devices/lcm/viewer_messages.h"

#include <headpin/image_array_t.hpp>
#include <headpin/viewer_draw_t.hpp>
#include <headpin/viewer_load_robot_t.hpp>

namespace headpin::devices {

namespace {

template <typename Message>
void write(const Message& message, std::vector<std::uint8_t>& out) {
  out.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
}

void copy(const Pose& X, float* position, float* quaternion) {
  for (int i = 0; i < 3; ++i) position[i] = static_cast<float>(X.p[i]);
  quaternion[0] = static_cast<float>(X.q.w());
  for (int i = 0; i < 3; ++i) quaternion[i + 1] = static_cast<float>(X.q.vec()[i]);
}

viewer_geometry_data_t message_of(const ViewerGeometry& geometry) {
  viewer_geometry_data_t m;
  m.type = geometry.type;
  copy(geometry.X_BG, m.position, m.quaternion);
  for (int i = 0; i < 3; ++i) m.color[i] = static_cast<float>(geometry.colour[i]);
  m.color[3] = 1.0F;
  m.num_float_data = static_cast<std::int32_t>(geometry.measures.size());
  m.float_data = geometry.measures;
  return m;
}

image_t message_of(const EyePictures& eyes, const char* frame,
                   std::span<const std::uint8_t> bytes) {
  image_t m;
  m.header = {eyes.sequence, eyes.time.count(), frame};
  m.width = eyes.width;
  m.height = eyes.height;
  m.row_stride = 3 * eyes.width;
  m.size = static_cast<std::int32_t>(bytes.size());
  m.data.assign(bytes.begin(), bytes.end());
  m.bigendian = 0;
  m.pixel_format = image_t::PIXEL_FORMAT_RGB;
  m.channel_type = image_t::CHANNEL_TYPE_UINT8;
  m.compression_method =
      eyes.png ? image_t::COMPRESSION_METHOD_PNG : image_t::COMPRESSION_METHOD_NOT_COMPRESSED;
  return m;
}

}  // namespace

void encode(std::span<const ViewerLink> links, std::vector<std::uint8_t>& out) {
  viewer_load_robot_t message;
  message.num_links = static_cast<std::int32_t>(links.size());
  for (const ViewerLink& link : links) {
    viewer_link_data_t m;
    m.name = link.name;
    m.robot_num = 0;
    m.num_geom = static_cast<std::int32_t>(link.geometries.size());
    for (const ViewerGeometry& geometry : link.geometries) m.geom.push_back(message_of(geometry));
    message.link.push_back(std::move(m));
  }
  write(message, out);
}

void encode(Time time, std::span<const ViewerPose> poses, std::vector<std::uint8_t>& out) {
  viewer_draw_t message;
  message.timestamp = time.count() / 1000;
  message.num_links = static_cast<std::int32_t>(poses.size());
  for (const ViewerPose& pose : poses) {
    message.link_name.push_back(pose.name);
    message.robot_num.push_back(0);
    std::vector<float> position(3), quaternion(4);
    copy(pose.X_WB, position.data(), quaternion.data());
    message.position.push_back(std::move(position));
    message.quaternion.push_back(std::move(quaternion));
  }
  write(message, out);
}

void encode(const EyePictures& eyes, std::vector<std::uint8_t>& out) {
  image_array_t message;
  message.header = {eyes.sequence, eyes.time.count(), "head display"};
  message.num_images = 2;
  message.images = {message_of(eyes, "left eye", eyes.left),
                    message_of(eyes, "right eye", eyes.right)};
  write(message, out);
}

}  // namespace headpin::devices
