#pragma once

#include <string>
#include <string_view>

#include "apps/mcap/protobuf_writer.h"
#include "base/math.h"
#include "render/camera.h"
#include "render/data/mesh.h"

/// The messages of foxglove.proto that a trial needs, as bytes.
namespace headpin::apps::foxglove {

/// All messages as a FileDescriptorSet: the schema of each.
std::string_view descriptors();

/// Where frame `child` stands in frame `parent`; a part of FrameTransforms.
void add_transform(ProtobufWriter& transforms, Time time, std::string_view parent,
                   std::string_view child, const Pose& X);

/// PoseInFrame.
std::string pose_in_frame(Time time, std::string_view frame, const Pose& X);

/// Log.
std::string log(Time time, std::string_view name, std::string_view message);

/// CameraCalibration, of a camera without a lens.
std::string camera_calibration(Time time, std::string_view frame, const render::View& view);

/// CompressedImage.
std::string compressed_image(Time time, std::string_view frame, std::string_view format,
                             std::string_view data);

/// Triangles with colours; a part of SceneEntity.
void add_triangles(ProtobufWriter& entity, const render::Mesh& mesh, const Pose& X);

/// A SceneEntity that moves with its frame and has the frame's name.
/// @param shapes  what add_triangles() wrote
std::string scene_update(Time time, std::string_view frame, std::string_view id,
                         const ProtobufWriter& shapes);

}  // namespace headpin::apps::foxglove
