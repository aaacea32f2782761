#include "apps/gltf_trial.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/eyes.h"
#include "scene/looks/glimpse.h"
#include "scene/looks/looks.h"

namespace headpin::apps {

namespace {

constexpr std::size_t kLongestSpan = 240;  // ticks between kept keys: bounds the time of thinning

nlohmann::json numbers(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

nlohmann::json numbers(const Quat& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

nlohmann::json placed(const std::string& name, const Pose& X_WN) {
  return {{"name", name}, {"translation", numbers(X_WN.p)}, {"rotation", numbers(X_WN.q)}};
}

/// One of the two signs of each quaternion, so that neighbours are near.
void make_continuous(std::vector<Pose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].q.normalize();
    if (i > 0 && poses[i].q.dot(poses[i - 1].q) < 0.0) poses[i].q.coeffs() *= -1.0;
  }
}

double share_of(std::size_t a, std::size_t b, std::size_t i) {
  return static_cast<double>(i - a) / static_cast<double>(b - a);
}

}  // namespace

std::vector<std::size_t> kept_keys(
    std::size_t count, double tolerance,
    const std::function<double(std::size_t a, std::size_t b, std::size_t i)>& error) {
  std::vector<std::size_t> kept = {0};
  for (std::size_t next = 1; next < count; ++next) {
    const std::size_t a = kept.back(), b = next;
    bool fits = b - a <= kLongestSpan;
    for (std::size_t i = a + 1; fits && i < b; ++i) fits = error(a, b, i) <= tolerance;
    if (!fits) kept.push_back(next - 1);
  }
  if (count > 1) kept.push_back(count - 1);
  return kept;
}

GltfTrial::GltfTrial(const scene::Session& session, const Pose& X_WD_first,
                     const scene::TrialSummary& trial, double tolerance)
    : tolerance_(tolerance), X_WD_(X_WD_first), outside_(trial.events) {
  // glTF has y up.
  const double half = std::sqrt(0.5);
  glb_.add("nodes", placed("world", {Quat(half, -half, 0.0, 0.0), Vec3::Zero()}));
  const nlohmann::json matt = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}};
  glb_.add("materials", {{"name", "lit"}, {"pbrMetallicRoughness", matt}});
  glb_.add("materials", {{"name", "with its light"},
                         {"pbrMetallicRoughness", matt},
                         {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}});
  glb_.json["extensionsUsed"] = nlohmann::json::array({"KHR_materials_unlit"});
  add_looks(*session.stage);
  add_cameras(session.scenario().hmd.optics);
}

void GltfTrial::add_looks(const scene::Stage& stage) {
  std::vector<render::Mesh> meshes;
  const scene::Looks looks(scene::MeshKeeper{[&](const render::Mesh& mesh) {
                             meshes.push_back(mesh);
                             return static_cast<int>(meshes.size()) - 1;
                           }},
                           stage);
  const auto add_mesh = [&](int mesh, const std::string& name) {
    return glb_.add_mesh(meshes[static_cast<std::size_t>(mesh)], name);
  };
  int part = 0;
  for (const render::DrawItem& item : looks.room.items) {
    const std::string name = fmt::format("room {}", ++part);
    nlohmann::json node = placed(name, item.X_WG);
    node["mesh"] = add_mesh(item.mesh, name);
    add_node(node);
  }
  const auto mesh_of = [&](const scene::BodyMeshes& of) {
    return meshes[static_cast<std::size_t>(of.mesh)];
  };
  true_skittle_ = mesh_of(looks.true_skittle);
  ellipsoid_skittle_ = mesh_of(looks.ellipsoid_skittle);
  ball_mesh_ = add_mesh(looks.ball.mesh, "ball");
  drawn_ = looks.centres;
  skittles_ = stage.skittles.size();
  hand_.name = "virtual hand";  // "hand" is the body that collides
  for (const int hand : looks.hands) {
    hand_meshes_.push_back(add_mesh(hand, "hand"));
    hand_.reach = std::max(hand_.reach, render::reach_of(meshes[static_cast<std::size_t>(hand)]));
  }
  const std::vector<std::string> names = scene::body_names(stage);
  const auto add_body = [&](engine::BodyId body, double reach) {
    bodies_.push_back({names[body], reach, {}});
  };
  const double height = stage.scenario.skittle.height;
  const double raised = std::abs(0.5 * height - stage.skittle_centre);  // at most, by a version
  const double skittle = raised + std::max({height, render::reach_of(true_skittle_),
                                            render::reach_of(ellipsoid_skittle_)});
  for (const engine::BodyId body : stage.skittles) add_body(body, skittle);
  const double ball = render::reach_of(mesh_of(looks.ball));
  for (const engine::BodyId body : stage.balls) add_body(body, ball);
}

void GltfTrial::add_cameras(const render::Optics& optics) {
  for (const render::View& view : render::eyes({}, optics)) {
    const bool left = glb_.json["cameras"].empty();
    const std::string name = left ? "left eye" : "right eye";
    const render::Frustum& f = view.frustum;
    // glTF knows only frusta around the axis: the smallest that shows all that the eye's shows.
    const double up = std::max(f.top, -f.bottom), across = std::max(f.right, -f.left);
    glb_.add("cameras",
             {{"name", name},
              {"type", "perspective"},
              {"perspective",
               {{"yfov", 2.0 * std::atan(up)},
                {"aspectRatio", across / up},
                {"znear", f.near},
                {"zfar", f.far}}},
              {"extras",
               {{"frustum_tangents",
                 {{"left", f.left}, {"right", f.right}, {"bottom", f.bottom}, {"top", f.top}}},
                {"off_centre", f.left != -f.right || f.bottom != -f.top}}}});
    eyes_.push_back({name, 0.1, {}});
  }
}

void GltfTrial::tick(const scene::Session& session) {
  keep(session);
  events_.insert(events_.end(), session.events.begin(), session.events.end());
  add_outside_events(session.now());
}

void GltfTrial::add_outside_events(Time now) {
  while (const scene::Event* event = outside_.next(now)) events_.push_back(*event);
}

void GltfTrial::keep(const scene::Session& session) {
  times_.push_back(static_cast<float>(nearest_seconds(session.now())));
  std::size_t i = 0;
  for (const auto& bodies : {session.stage->skittles, session.stage->balls}) {
    for (const engine::BodyId body : bodies) {
      bodies_[i++].X_WN.push_back(session.world.states[body].X_WB);
    }
  }
  looks_.push_back(scene::skittle_look(*session.stage, drawn_));
  // An absent hand waits where it is first seen.
  if (const auto X_WH = scene::hand_pose(session)) {
    if (hand_.X_WN.empty()) hand_.X_WN.assign(times_.size() - 1, *X_WH);
    hand_.X_WN.push_back(*X_WH);
  } else if (!hand_.X_WN.empty()) {
    hand_.X_WN.push_back(hand_.X_WN.back());
  }
  grips_.push_back(scene::hand_at(scene::glimpse(session, X_WD_).closed, hand_meshes_.size()));
  X_WD_ = scene::head_pose(session).value_or(X_WD_);
  const auto views = render::eyes(X_WD_, session.scenario().hmd.optics);
  for (std::size_t eye = 0; eye < 2; ++eye) eyes_[eye].X_WN.push_back(views[eye].X_WE);
}

void GltfTrial::add_node(nlohmann::json node) {
  const std::size_t number = glb_.add("nodes", std::move(node));
  glb_.json["nodes"][0]["children"].push_back(number);
}

void GltfTrial::add_channel(std::size_t node, const char* path, std::span<const std::size_t> kept,
                            const std::vector<float>& values, const char* between) {
  const std::size_t width = values.size() / times_.size();
  std::vector<float> times, numbers;
  for (const std::size_t key : kept) {
    times.push_back(times_[key]);
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(key * width);
    numbers.insert(numbers.end(), from, from + static_cast<std::ptrdiff_t>(width));
  }
  nlohmann::json& animation = glb_.json["animations"][0];
  const std::size_t sampler = animation["samplers"].size();
  const std::size_t input = glb_.add_floats(times, 1, true);
  const std::size_t output = glb_.add_floats(numbers, width, false);
  animation["samplers"].push_back(
      {{"input", input}, {"output", output}, {"interpolation", between}});
  animation["channels"].push_back(
      {{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
  keys_ += kept.size();
}

void GltfTrial::animate(const Track& track, std::size_t node) {
  std::vector<Pose> poses = track.X_WN;
  make_continuous(poses);
  std::vector<float> places, turns;
  bool moves = false, rotates = false;
  for (const Pose& X : poses) {
    for (const double x : X.p) places.push_back(static_cast<float>(x));
    for (const double x : X.q.coeffs()) turns.push_back(static_cast<float>(x));
    moves = moves || X.p != poses[0].p;
    rotates = rotates || X.q.coeffs() != poses[0].q.coeffs();
  }
  const double tolerance = tolerance_ > 0.0 ? 0.5 * tolerance_ : -1.0;  // of place and turn, each
  const auto off = [&](std::size_t a, std::size_t b, std::size_t i) {
    const double s = share_of(a, b, i);
    return (poses[a].p + s * (poses[b].p - poses[a].p) - poses[i].p).norm();
  };
  const auto turned_off = [&](std::size_t a, std::size_t b, std::size_t i) {
    const Quat between = poses[a].q.slerp(share_of(a, b, i), poses[b].q);
    return track.reach * between.angularDistance(poses[i].q);
  };
  if (moves) add_channel(node, "translation", kept_keys(poses.size(), tolerance, off), places);
  if (rotates) add_channel(node, "rotation", kept_keys(poses.size(), tolerance, turned_off), turns);
}

/// Adds a moving node.
/// @param more  of the node, besides its name and pose
std::size_t GltfTrial::add_track(const Track& track, nlohmann::json more) {
  more.update(placed(track.name, track.X_WN.front()));
  add_node(std::move(more));
  const std::size_t node = glb_.json["nodes"].size() - 1;
  animate(track, node);
  return node;
}

/// Adds one of several shapes of a node.
/// @param seen  whether it is this one, one per tick
void GltfTrial::add_shape(std::size_t parent, nlohmann::json node, const std::vector<bool>& seen) {
  if (std::ranges::find(seen, true) == seen.end()) return;
  std::vector<std::size_t> changes = {0};
  std::vector<float> sizes;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i > 0 && seen[i] != seen[i - 1]) changes.push_back(i);
    sizes.insert(sizes.end(), 3, seen[i] ? 1.0F : 0.0F);
  }
  node["scale"] = {sizes[0], sizes[1], sizes[2]};
  const std::size_t number = glb_.add("nodes", std::move(node));
  glb_.json["nodes"][parent]["children"].push_back(number);
  if (changes.size() > 1) add_channel(number, "scale", changes, sizes, "STEP");
}

/// The mesh in the file, which has those alone that are seen.
std::size_t GltfTrial::skittle_mesh(bool ellipsoid) {
  const auto [found, is_new] = skittle_meshes_.try_emplace(ellipsoid);
  if (is_new) {
    found->second = ellipsoid ? glb_.add_mesh(ellipsoid_skittle_, "ellipsoid skittle")
                              : glb_.add_mesh(true_skittle_, "skittle");
  }
  return found->second;
}

void GltfTrial::add_skittle(std::size_t body) {
  std::vector<scene::SkittleLook> all;
  for (const scene::SkittleLook& look : looks_) {
    if (std::ranges::find(all, look) == all.end()) all.push_back(look);
  }
  if (all == std::vector{scene::SkittleLook{all[0].ellipsoid, 0.0}}) {
    add_track(bodies_[body], {{"mesh", skittle_mesh(all[0].ellipsoid)}});
    return;
  }
  const std::size_t parent = add_track(bodies_[body], nlohmann::json::object());
  for (std::size_t shape = 0; shape < all.size(); ++shape) {
    nlohmann::json node = placed(fmt::format("{} shape {}", bodies_[body].name, shape + 1),
                                 {Quat::Identity(), Vec3(0.0, 0.0, all[shape].raised)});
    node["mesh"] = skittle_mesh(all[shape].ellipsoid);
    std::vector<bool> seen;
    for (const scene::SkittleLook& look : looks_) seen.push_back(look == all[shape]);
    add_shape(parent, std::move(node), seen);
  }
}

void GltfTrial::add_hand() {
  const std::size_t hand = add_track(hand_, nlohmann::json::object());
  for (std::size_t grip = 0; grip < hand_meshes_.size(); ++grip) {
    std::vector<bool> seen;
    for (const std::size_t shown : grips_) seen.push_back(shown == grip);
    add_shape(hand,
              {{"name", fmt::format("hand {} of {}", grip + 1, hand_meshes_.size())},
               {"mesh", hand_meshes_[grip]}},
              seen);
  }
}

void GltfTrial::add_events() {
  std::size_t number = 0;
  for (const scene::Event& event : events_) {
    nlohmann::json node =
        placed(fmt::format("event {} {}", ++number, event.kind), {Quat::Identity(), event.p_W});
    node["extras"] = {{"event", event.kind},
                      {"tick", event.tick},
                      {"t_s", nearest_seconds(event.time)},
                      {"bodies", event.bodies},
                      {"value", event.value}};
    add_node(node);
  }
}

std::string GltfTrial::file(const scene::Session& session, nlohmann::json about) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (i < skittles_)
      add_skittle(i);
    else
      add_track(bodies_[i], {{"mesh", ball_mesh_}});
  }
  if (!hand_.X_WN.empty()) add_hand();
  for (std::size_t eye = 0; eye < 2; ++eye) add_track(eyes_[eye], {{"camera", eye}});
  add_outside_events(Time::max());
  add_events();
  if (glb_.json.contains("animations")) glb_.json["animations"][0]["name"] = "trial";
  glb_.json["scenes"][0] = {{"name", "trial"}, {"nodes", {0}}};
  glb_.json["scene"] = 0;
  about["ticks"] = session.tick;
  about["ticks_per_s"] = session.scenario().rates.physics_hz;
  about["state_hash"] = scene::in_hex(session.state_hash);
  about["tolerance_m"] = tolerance_;
  glb_.json["asset"]["extras"] = std::move(about);
  return glb_.bytes();
}

}  // namespace headpin::apps
