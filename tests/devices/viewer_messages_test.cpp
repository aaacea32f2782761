// What others look at, read back as they read it.

#include "devices/lcm/viewer_messages.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <headpin/image_array_t.hpp>
#include <headpin/viewer_draw_t.hpp>
#include <headpin/viewer_load_robot_t.hpp>

#include "devices/lcm/link.h"
#include "devices/log/event_log.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

template <typename Message>
Message read_back(const std::vector<std::uint8_t>& bytes) {
  Message message;
  EXPECT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  return message;
}

TEST(ViewerMessages, TheEyesPicturesHaveTheirRowsOneAfterTheOther) {
  const std::array<std::uint8_t, 12> left{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const std::array<std::uint8_t, 12> right{12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
  for (const bool png : {false, true}) {
    std::vector<std::uint8_t> bytes;
    encode(EyePictures{.sequence = 7,
                       .time = Time{1'500'000},
                       .width = 2,
                       .height = 2,
                       .png = png,
                       .left = left,
                       .right = right},
           bytes);
    const auto message = read_back<image_array_t>(bytes);
    EXPECT_EQ(message.header.seq, 7);
    EXPECT_EQ(message.header.utime, 1'500'000);
    ASSERT_EQ(message.num_images, 2);
    EXPECT_EQ(message.images[0].header.frame_name, "left eye");
    EXPECT_EQ(message.images[1].header.frame_name, "right eye");
    for (const image_t& image : message.images) {
      EXPECT_EQ(image.width, 2);
      EXPECT_EQ(image.height, 2);
      EXPECT_EQ(image.row_stride, 6);  // three bytes a pixel
      EXPECT_EQ(image.size, 12);
      EXPECT_EQ(image.pixel_format, image_t::PIXEL_FORMAT_RGB);
      EXPECT_EQ(image.compression_method,
                png ? image_t::COMPRESSION_METHOD_PNG : image_t::COMPRESSION_METHOD_NOT_COMPRESSED);
    }
    EXPECT_EQ(message.images[0].data, std::vector<std::uint8_t>(left.begin(), left.end()));
    EXPECT_EQ(message.images[1].data, std::vector<std::uint8_t>(right.begin(), right.end()));
  }
}

TEST(ViewerMessages, ALinkHasItsShapesAndItsPoseTheScalarFirst) {
  const Quat q(0.5, 0.5, -0.5, 0.5);
  std::vector<std::uint8_t> bytes;
  const std::array links{ViewerLink{
      "ball", {{ViewerGeometry::sphere, {q, Vec3(1.0, 2.0, 3.0)}, {0.11F}, Vec3(1.0, 0.5, 0.0)}}}};
  encode(links, bytes);
  const auto loaded = read_back<viewer_load_robot_t>(bytes);
  ASSERT_EQ(loaded.num_links, 1);
  EXPECT_EQ(loaded.link[0].name, "ball");
  ASSERT_EQ(loaded.link[0].num_geom, 1);
  const viewer_geometry_data_t& shape = loaded.link[0].geom[0];
  EXPECT_EQ(shape.type, ViewerGeometry::sphere);
  EXPECT_EQ(shape.float_data, std::vector<float>{0.11F});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(shape.position[i], static_cast<float>(i + 1));
  EXPECT_EQ(std::vector<float>(shape.quaternion, shape.quaternion + 4),
            (std::vector<float>{0.5F, 0.5F, -0.5F, 0.5F}));
  EXPECT_EQ(std::vector<float>(shape.color, shape.color + 4),
            (std::vector<float>{1.0F, 0.5F, 0.0F, 1.0F}));
  const std::array poses{ViewerPose{"ball", {q, Vec3(4.0, 5.0, 6.0)}}};
  encode(Time{2'500'999}, poses, bytes);
  const auto drawn = read_back<viewer_draw_t>(bytes);
  EXPECT_EQ(drawn.timestamp, 2'500) << "milliseconds";
  ASSERT_EQ(drawn.num_links, 1);
  EXPECT_EQ(drawn.link_name[0], "ball");
  EXPECT_EQ(drawn.position[0], (std::vector<float>{4.0F, 5.0F, 6.0F}));
  EXPECT_EQ(drawn.quaternion[0], (std::vector<float>{0.5F, 0.5F, -0.5F, 0.5F}));
}

// Other programs know these channels: they have no prefix.
TEST(ViewerMessages, EachIsPublishedOnItsOwnChannel) {
  const std::string path = fresh_folder("viewer") / "viewer.lcmlog";
  const std::array links{ViewerLink{"ball", {}}};
  const std::array poses{ViewerPose{"ball", {Quat::Identity(), Vec3(4.0, 5.0, 6.0)}}};
  const std::array<std::uint8_t, 3> pixel{1, 2, 3};
  const EyePictures eyes{.sequence = 7, .width = 1, .height = 1, .left = pixel, .right = pixel};
  {
    LcmLink link("file://" + path + "?mode=w", "TRIAL_");
    link.publish(eyes);
    link.publish(links);
    link.publish(Time{2'500'000}, poses);
  }
  std::vector<std::uint8_t> eyes_bytes, links_bytes, poses_bytes;
  encode(eyes, eyes_bytes);
  encode(links, links_bytes);
  encode(Time{2'500'000}, poses, poses_bytes);
  FileWindow file(path);
  LogReader reader(file);
  for (const auto& [channel, bytes] :
       {std::pair("HEADPIN_EYES", eyes_bytes), std::pair("DRAKE_VIEWER_LOAD_ROBOT", links_bytes),
        std::pair("DRAKE_VIEWER_DRAW", poses_bytes)}) {
    const auto event = reader.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->channel, channel);
    EXPECT_EQ(std::vector<std::uint8_t>(event->data.begin(), event->data.end()), bytes);
  }
}

}  // namespace
}  // namespace headpin::devices
