#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mcap/mcap_writer.h"
#include "apps/mcap/protobuf_writer.h"
#include "devices/log/event_log.h"
#include "scene/looks/looks.h"
#include "scene/play/run.h"
#include "scene/play/session.h"
#include "scene/record/outside.h"
#include "scene/record/trial.h"
#include "scene/watch/eye_frames.h"

namespace headpin::apps {

/// Writes a trial that is simulated again as MCAP: what happens in the messages of Foxglove, and the messages of the
/// trial's log as they are.
///
/// Memory does not grow with the trial, but for the index (McapWriter). A version that begins does not change a shape.
class McapTrial : public scene::Observer, public scene::FrameSink {
 public:
  /// @param trial  summary of the log
  /// @param log    the log; must outlive this
  McapTrial(McapWriter& out, const scene::Session& session, const Pose& X_WD_first,
            const scene::TrialSummary& trial, devices::FileWindow& log);

  void start(const scene::Session& session) override;
  void tick(const scene::Session& session) override;
  void add(const scene::EyeFrame& frame) override;

  /// Writes the rest of the log.
  /// @param facts  more about the trial
  void finish(const scene::Session& session, std::map<std::string, std::string> facts);

 private:
  /// A channel, and how many messages it has.
  struct Topic {
    std::uint16_t channel = 0;
    std::uint32_t messages = 0;
  };
  struct Eye {
    std::string frame, camera;  ///< names of the frames of eye and camera
    Topic pose, calibration, image;
  };
  struct Body {
    engine::BodyId body = 0;
    std::string name;
  };

  Topic topic(const std::string& name, std::string_view schema);
  void add(Topic& topic, Time time, std::string_view data);
  void add_shapes(const scene::Session& session);
  void add_skittles(const scene::Session& session);
  void add_hand(const scene::Session& session, ProtobufWriter& transforms);
  void add_events(const scene::Session& session);
  void add_event(const scene::Event& event);
  void add_log_until(Time now);
  void add_of_log(const devices::LogEvent& event, Time now);
  Topic& topic_of_log(const std::string& channel);

  McapWriter& out_;
  std::map<std::string, std::uint16_t, std::less<>> schemas_;
  Topic transforms_, scene_, head_, hand_, events_;
  std::array<Eye, 2> eyes_;
  std::vector<Body> bodies_;

  render::Mesh true_skittle_, ellipsoid_skittle_;
  scene::DrawnCentres drawn_;
  std::optional<scene::SkittleLook> skittles_;  ///< that was written last
  std::vector<ProtobufWriter> hands_;           ///< shapes of the hand, from open to closed
  std::optional<std::size_t> grip_;             ///< that was written last
  Pose X_WD_;

  double pixel_aspect_;  ///< of the pictures: width of a pixel over its height
  scene::OutsideEvents outside_;

  devices::LogReader reader_;
  std::optional<devices::LogEvent> next_of_log_;
  std::optional<Time> first_of_log_;
  std::string schema_of_log_;
  std::map<std::string, Topic> topics_of_log_;
};

}  // namespace headpin::apps
