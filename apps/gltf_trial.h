#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/glb.h"
#include "scene/play/run.h"
#include "scene/play/session.h"

namespace headpin::apps {

/// Poses of one node, one per tick.
struct Track {
  std::string name;
  double radius = 0.0;     ///< of the body: turns a rotation error into a distance [m]
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
/// The fingers do not move, and a version that begins does not change a shape.
class GltfTrial : public scene::Observer {
 public:
  /// @param tolerance  of the thinned keys [m]; 0 keeps the key of every tick
  GltfTrial(const scene::Session& session, const Pose& X_WD_first, double tolerance);

  void start(const scene::Session& session) override { keep(session); }
  void tick(const scene::Session& session) override;

  std::size_t ticks() const { return times_.size(); }
  std::size_t keys() const { return keys_; }  ///< of all channels, once the file is made

  /// @param about  goes into asset.extras
  std::string file(const scene::Session& session, nlohmann::json about);

 private:
  void keep(const scene::Session& session);
  void add_looks(const scene::Stage& stage);
  void add_cameras(const render::Optics& optics);
  void add_node(nlohmann::json node);
  void animate(const Track& track, std::size_t node);
  void add_channel(std::size_t node, const char* path, std::span<const std::size_t> kept,
                   const std::vector<float>& values);
  void add_events();

  Glb glb_;
  double tolerance_;
  std::vector<float> times_;
  std::vector<Track> bodies_, eyes_;
  Track hand_;
  std::vector<std::size_t> meshes_;  ///< of bodies_
  std::size_t hand_mesh_ = 0;
  Pose X_WD_;
  std::vector<devices::Event> events_;
  std::size_t keys_ = 0;
};

}  // namespace headpin::apps
