#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "apps/glb.h"
#include "scene/looks/looks.h"
#include "scene/play/run.h"
#include "scene/play/session.h"
#include "scene/record/outside.h"

namespace headpin::apps {

/// Poses of one node, one per tick.
struct Track {
  std::string name;
  double reach = 0.0;      ///< of its surface: turns a rotation error into a distance [m]
  std::vector<Pose> X_WN;  ///< the node in the world
};

/// Positions of the keys that are kept, first and last included.
///
/// @param error  between the values at position `i` and the line from `a` to `b` [m]
std::vector<std::size_t> kept_keys(
    std::size_t count, double tolerance,
    const std::function<double(std::size_t a, std::size_t b, std::size_t i)>& error);

/// Makes a trial into a glTF file: room, bodies, hand and both eyes, with one animation.
///
/// The hand has one node per mesh from open to closed, and a skittle one per shape that versions give it;
/// all but one are scaled to nothing, because the core of glTF has no other way to hide a node.
class GltfTrial : public scene::Observer {
 public:
  /// @param trial      summary of the log
  /// @param tolerance  of the thinned keys [m]; 0 keeps the key of every tick
  GltfTrial(const scene::Session& session, const Pose& X_WD_first, const scene::TrialSummary& trial,
            double tolerance);

  void start(const scene::Session& session) override { keep(session); }
  void tick(const scene::Session& session) override;

  std::size_t ticks() const { return times_.size(); }
  std::size_t keys() const { return keys_; }  ///< of all channels, once the file is made

  /// @param about  goes into asset.extras
  std::string file(const scene::Session& session, nlohmann::json about);

 private:
  void keep(const scene::Session& session);
  void add_outside_events(Time now);
  void add_looks(const scene::Stage& stage);
  void add_cameras(const render::Optics& optics);
  void add_node(nlohmann::json node);
  std::size_t add_track(const Track& track, nlohmann::json more);
  void add_skittle(std::size_t body);
  std::size_t skittle_mesh(bool ellipsoid);
  void add_hand();
  void add_shape(std::size_t parent, nlohmann::json node, const std::vector<bool>& seen);
  void animate(const Track& track, std::size_t node);
  void add_channel(std::size_t node, const char* path, std::span<const std::size_t> kept,
                   const std::vector<float>& values, const char* between = "LINEAR");
  void add_events();

  Glb glb_;
  double tolerance_;
  std::vector<float> times_;
  std::vector<Track> bodies_, eyes_;
  Track hand_;
  std::size_t skittles_ = 0;  ///< of bodies_, the first ones
  std::size_t ball_mesh_ = 0;
  render::Mesh true_skittle_, ellipsoid_skittle_;
  std::map<bool, std::size_t> skittle_meshes_;  ///< whether an ellipsoid: the mesh in the file
  scene::DrawnCentres drawn_;
  std::vector<scene::SkittleLook> looks_;  ///< of the skittles, one per tick
  std::vector<std::size_t> hand_meshes_;   ///< from open to closed
  std::vector<std::size_t> grips_;         ///< which of them is seen, one per tick
  Pose X_WD_;
  std::vector<scene::Event> events_;
  scene::OutsideEvents outside_;
  std::size_t keys_ = 0;
};

}  // namespace headpin::apps
