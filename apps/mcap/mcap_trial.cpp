#include "apps/mcap/mcap_trial.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mcap/foxglove.h"
#include "devices/base/version.h"
#include "render/display.h"
#include "render/eyes.h"
#include "render/png.h"
#include "scene/looks/glimpse.h"
#include "scene/looks/looks.h"
#include "scene/record/messages.h"

namespace headpin::apps {

namespace {

constexpr std::string_view kWorldFrame = "world", kHandFrame = "virtual hand", kHeadFrame = "head";

std::uint64_t nanoseconds(Time time) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max() / 1000;
  return static_cast<std::uint64_t>(1000 * std::clamp<std::int64_t>(time.count(), 0, kMost));
}

/// JSON without bytes that are not UTF-8, which protobuf refuses.
std::string utf8_of(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json numbers_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Type of the messages on a channel of a trial; empty for channels of others.
std::string type_on(std::string_view channel) {
  using namespace devices;
  using namespace scene;
  static const std::map<std::string_view, std::string> types = {
      {kTrialChannel, "headpin.trial_t"},       {kTrackerChannel, "headpin.tracked_device_t"},
      {kMouseChannel, "headpin.mouse3d_t"},     {kEventChannel, "headpin.event_t"},
      {kStateChannel, "headpin.state_t"},       {kStateChangeChannel, "headpin.state_change_t"},
      {kSnapshotChannel, "headpin.snapshot_t"}, {kFrameChannel, "headpin.frame_t"}};
  if (channel.starts_with(kSessionPrefix)) channel.remove_prefix(kSessionPrefix.size());
  const auto found = types.find(channel);
  return found == types.end() ? "" : found->second;
}

}  // namespace

McapTrial::McapTrial(McapWriter& out, const scene::Session& session, const Pose& X_WD_first,
                     const scene::TrialSummary& trial, devices::FileWindow& log)
    : out_(out),
      X_WD_(X_WD_first),
      pixel_aspect_(session.scenario().hmd.optics.pixel_aspect()),
      outside_(trial.events),
      reader_(log),
      schema_of_log_(trial.header.schema) {
  transforms_ = topic("/tf", "FrameTransforms");
  scene_ = topic("/scene", "SceneUpdate");
  head_ = topic("/head", "PoseInFrame");
  hand_ = topic("/hand", "PoseInFrame");
  events_ = topic("/events", "Log");
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::string side = eye == 0 ? "left" : "right";
    eyes_[eye] = {.frame = side + " eye",
                  .camera = side + " camera",
                  .pose = topic("/" + side + "_eye", "PoseInFrame"),
                  .calibration = topic("/" + side + "_eye/calibration", "CameraCalibration"),
                  .image = topic("/" + side + "_eye/image", "CompressedImage")};
  }
  const std::vector<std::string> names = scene::body_names(*session.stage);
  for (const auto& bodies : {session.stage->skittles, session.stage->balls}) {
    for (const engine::BodyId body : bodies) bodies_.push_back({body, names[body]});
  }
  if (schema_of_log_.empty()) schema_of_log_ = devices::schema_text();
  next_of_log_ = reader_.next();
}

McapTrial::Topic McapTrial::topic(const std::string& name, std::string_view schema) {
  auto found = schemas_.find(schema);
  if (found == schemas_.end()) {
    const std::uint16_t number =
        out_.add_schema("foxglove." + std::string(schema), "protobuf", foxglove::descriptors());
    found = schemas_.emplace(schema, number).first;
  }
  return {out_.add_channel(name, "protobuf", found->second)};
}

void McapTrial::add(Topic& topic, Time time, std::string_view data) {
  out_.add({topic.channel, topic.messages++, nanoseconds(time), nanoseconds(time), data});
}

void McapTrial::start(const scene::Session& session) {
  add_shapes(session);
  const render::Optics& optics = session.scenario().hmd.optics;
  if (!render::has_lens(optics)) {
    const auto views = render::eyes(X_WD_, optics);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      add(eyes_[eye].calibration, session.now(),
          foxglove::camera_calibration(session.now(), eyes_[eye].camera, views[eye]));
    }
  }
  tick(session);
}

void McapTrial::add_shapes(const scene::Session& session) {
  const scene::Stage& stage = *session.stage;
  std::vector<render::Mesh> meshes;
  const scene::Looks looks(scene::MeshKeeper{[&](const render::Mesh& mesh) {
                             meshes.push_back(mesh);
                             return static_cast<int>(meshes.size()) - 1;
                           }},
                           stage);
  const auto shape_of = [&](int mesh) {
    ProtobufWriter shape;
    foxglove::add_triangles(shape, meshes[static_cast<std::size_t>(mesh)], {});
    return shape;
  };
  const auto add_scene = [&](std::string_view frame, std::string_view id,
                             const ProtobufWriter& shapes) {
    add(scene_, session.now(), foxglove::scene_update(session.now(), frame, id, shapes));
  };
  ProtobufWriter room;
  for (const render::DrawItem& item : looks.room.items) {
    foxglove::add_triangles(room, meshes[static_cast<std::size_t>(item.mesh)], item.X_WG);
  }
  add_scene(kWorldFrame, "room", room);
  const ProtobufWriter ball = shape_of(looks.ball.mesh);
  for (std::size_t i = stage.skittles.size(); i < bodies_.size(); ++i) {
    add_scene(bodies_[i].name, bodies_[i].name, ball);
  }
  const auto mesh_of = [&](const scene::BodyMeshes& of) {
    return meshes[static_cast<std::size_t>(of.mesh)];
  };
  true_skittle_ = mesh_of(looks.true_skittle);
  ellipsoid_skittle_ = mesh_of(looks.ellipsoid_skittle);
  drawn_ = looks.centres;
  for (const int hand : looks.hands) hands_.push_back(shape_of(hand));
}

/// The skittles' shape when that is another one: a version may have its own.
void McapTrial::add_skittles(const scene::Session& session) {
  const scene::SkittleLook look = scene::skittle_look(*session.stage, drawn_);
  if (look == skittles_) return;
  skittles_ = look;
  ProtobufWriter shape;
  foxglove::add_triangles(shape, look.ellipsoid ? ellipsoid_skittle_ : true_skittle_,
                          {Quat::Identity(), Vec3(0.0, 0.0, look.raised)});
  for (std::size_t i = 0; i < session.stage->skittles.size(); ++i) {
    const std::string& name = bodies_[i].name;
    add(scene_, session.now(), foxglove::scene_update(session.now(), name, name, shape));
  }
}

void McapTrial::tick(const scene::Session& session) {
  const Time now = session.now();
  add_log_until(now);
  ProtobufWriter transforms;
  const auto place = [&](std::string_view frame, const Pose& X) {
    foxglove::add_transform(transforms, now, kWorldFrame, frame, X);
  };
  for (const Body& body : bodies_) place(body.name, session.world.states[body.body].X_WB);
  X_WD_ = scene::head_pose(session).value_or(X_WD_);
  place(kHeadFrame, X_WD_);
  add(head_, now, foxglove::pose_in_frame(now, kWorldFrame, X_WD_));
  const auto views = render::eyes(X_WD_, session.scenario().hmd.optics);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    place(eyes_[eye].frame, views[eye].X_WE);
    place(eyes_[eye].camera, render::Camera(views[eye]).X_CW.inverse());
    add(eyes_[eye].pose, now, foxglove::pose_in_frame(now, kWorldFrame, views[eye].X_WE));
  }
  add_skittles(session);
  add_hand(session, transforms);
  add(transforms_, now, transforms.bytes());
  add_events(session);
}

/// The hand's pose, and its shape when that is another one.
void McapTrial::add_hand(const scene::Session& session, ProtobufWriter& transforms) {
  const std::optional<Pose> X_WH = scene::hand_pose(session);
  if (!X_WH) return;
  const Time now = session.now();
  foxglove::add_transform(transforms, now, kWorldFrame, kHandFrame, *X_WH);
  add(hand_, now, foxglove::pose_in_frame(now, kWorldFrame, *X_WH));
  const std::size_t grip = scene::hand_at(scene::glimpse(session, X_WD_).closed, hands_.size());
  if (grip == grip_) return;
  grip_ = grip;
  add(scene_, now, foxglove::scene_update(now, kHandFrame, kHandFrame, hands_[grip]));
}

void McapTrial::add_events(const scene::Session& session) {
  for (const scene::Event& event : session.events) add_event(event);
  while (const scene::Event* event = outside_.next(session.now())) add_event(*event);
}

void McapTrial::add_event(const scene::Event& event) {
  const nlohmann::ordered_json message = {{"event", event.kind},
                                          {"tick", event.tick},
                                          {"bodies", event.bodies},
                                          {"point", numbers_of(event.p_W)},
                                          {"impulse", numbers_of(event.j_W)},
                                          {"value", event.value},
                                          {"detail", event.detail.text()}};
  const std::string kind = nlohmann::ordered_json::parse(utf8_of(event.kind)).get<std::string>();
  const Time time = std::max(event.time, Time{});
  add(events_, time, foxglove::log(time, kind, utf8_of(message)));
}

void McapTrial::add(const scene::EyeFrame& frame) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::vector<std::uint8_t> png = render::encode_png(frame.images[eye], pixel_aspect_);
    add(eyes_[eye].image, frame.time,
        foxglove::compressed_image(frame.time, eyes_[eye].camera, "png",
                                   {reinterpret_cast<const char*>(png.data()), png.size()}));
  }
}

McapTrial::Topic& McapTrial::topic_of_log(const std::string& channel) {
  const auto [found, is_new] = topics_of_log_.try_emplace(channel);
  if (!is_new) return found->second;
  const std::string type = type_on(channel);
  std::uint16_t schema = 0;
  if (!type.empty()) {
    const auto [known, is_new_schema] = schemas_.try_emplace(type);
    if (is_new_schema) known->second = out_.add_schema(type, "lcm", schema_of_log_);
    schema = known->second;
  }
  const std::string name = nlohmann::ordered_json::parse(utf8_of(channel)).get<std::string>();
  found->second.channel = out_.add_channel("lcm/" + name, "lcm", schema);
  return found->second;
}

/// Writes an event of the log at its time since the first one, but not after `now`.
void McapTrial::add_of_log(const devices::LogEvent& event, Time now) {
  Topic& topic = topic_of_log(std::string(event.channel));
  const Time since_first = std::min(event.time - *first_of_log_, now);
  ++topic.messages;
  out_.add({topic.channel,
            static_cast<std::uint32_t>(event.number),
            nanoseconds(since_first),
            nanoseconds(event.time),
            {reinterpret_cast<const char*>(event.data.data()), event.data.size()}});
}

void McapTrial::add_log_until(Time now) {
  for (; next_of_log_; next_of_log_ = reader_.next()) {
    if (!first_of_log_) first_of_log_ = next_of_log_->time;
    if (next_of_log_->time - *first_of_log_ > now) return;
    add_of_log(*next_of_log_, now);
  }
}

void McapTrial::finish(const scene::Session& session, std::map<std::string, std::string> facts) {
  while (const scene::Event* event = outside_.next(Time::max())) add_event(*event);
  for (; next_of_log_; next_of_log_ = reader_.next()) {
    if (!first_of_log_) first_of_log_ = next_of_log_->time;
    add_of_log(*next_of_log_, session.now());
  }
  facts["ticks"] = std::to_string(session.tick);
  facts["ticks_per_s"] = std::to_string(session.scenario().rates.physics_hz);
  facts["state_hash"] = scene::in_hex(session.state_hash);
  for (auto& [name, value] : facts) {
    value = nlohmann::ordered_json::parse(utf8_of(value)).get<std::string>();
  }
  out_.add_metadata("headpin", facts);
  out_.finish();
}

}  // namespace headpin::apps
