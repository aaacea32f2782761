#include "scene/page/play_page.h"

#include <utility>

#include "devices/base/sample.h"
#include "scene/page/browser_device.h"
#include "scene/stage/stage.h"

namespace headpin::scene {

namespace {

using nlohmann::json;

json of_actors(const Looks& looks, const Stage& stage) {
  json out = json::array();
  const auto add = [&](const std::string& name, const char* role, const std::vector<int>& meshes) {
    out.push_back({{"name", name}, {"role", role}, {"meshes", meshes}});
  };
  for (const engine::BodyId body : stage.skittles) {
    add(stage.world.bodies[body].name, "skittle",
        {looks.true_skittle.mesh, looks.ellipsoid_skittle.mesh});
  }
  for (const engine::BodyId body : stage.balls) {
    add(stage.world.bodies[body].name, "ball", {looks.ball.mesh});
  }
  add("hand", "hand", looks.hands);
  add("head", "head", {looks.head});
  return out;
}

/// The scenario as a right hand plays it: the page mirrors hand and ball for a left one.
Scenario right_handed(Scenario scenario) {
  scenario.rig.hand_station = devices::kHandStation;
  return scenario;
}

json of_buttons(const Versions& versions) {
  json out = json::array();
  if (!versions.buttons) return out;
  out.push_back(
      {{"colour", "red"}, {"p", numbers(versions.red.button)}, {"radius", versions.radius}});
  out.push_back(
      {{"colour", "blue"}, {"p", numbers(versions.blue.button)}, {"radius", versions.radius}});
  return out;
}

json of_ball(const Scenario& scenario, const Stage& stage) {
  json homes = json::array();
  for (const engine::BodyId ball : stage.balls) {
    homes.push_back(numbers(stage.world.states[ball].X_WB.p));
  }
  return {{"radius", scenario.ball.radius}, {"homes", std::move(homes)}};
}

std::set<int> meshes_in(const json& out) {
  std::set<int> all;
  for (const json& actor : out["actors"]) {
    for (const int mesh : actor["meshes"]) all.insert(mesh);
  }
  for (const json& still : out["still"]) all.insert(still["mesh"].get<int>());
  if (const json& ring = out["rings"]["mesh"]; !ring.is_null()) all.insert(ring.get<int>());
  if (out["board"].is_null()) return all;
  for (const json& mesh : out["board"]["characters"]) all.insert(mesh.get<int>());
  return all;
}

}  // namespace

PageData play_page(const Scenario& scenario) {
  const Stage stage = make_stage(scenario);
  const PageLooks page_looks(right_handed(scenario));
  const Looks& looks = page_looks.looks;
  const Scenario right = played_with(scenario, browser_devices().front(), false);
  const Scenario left = played_with(scenario, browser_devices().front(), true);

  PageData data;
  json& out = data.json;
  out["scenario"] = {{"name", scenario.name}, {"text", to_toml(scenario)}};
  out["not_stored"] = name_of(scenario.game.not_stored);
  out["rate_hz"] = scenario.rates.physics_hz;
  out["frame_hz"] = scenario.rates.frame_hz;
  out["sound"] = scenario.sound.on;
  out["X_WT"] = numbers(right.rig.X_WT);
  out["hand"] = {{"grip", numbers(right.hand.grip)}, {"reach", right.hand.reach}};
  const bool mirrors = scenario.collision.rules >= 10;  // as Looks does
  out["left_handed"] = {{"X_WT", numbers(left.rig.X_WT)},
                        {"grip", numbers(left.hand.grip)},
                        {"mirrors_hand", mirrors && scenario.hand.mesh.file.empty()},
                        {"mirrors_ball", mirrors && scenario.ball.mesh.file.empty()}};
  out["ball"] = of_ball(scenario, stage);
  out["buttons"] = of_buttons(scenario.version);
  out["room"] = of_room(scenario);
  out["light"] = of_light(looks.room);
  out["eyes"] = of_eyes(scenario.hmd.optics);
  out["missing_meshes"] = page_looks.missing;
  out["still"] = of_still(looks.room);
  out["actors"] = of_actors(looks, stage);
  out["board"] = of_board(looks);
  out["rings"] = {{"mesh", of_ring_mesh(looks)}};
  out["meshes"] = json::array();
  std::vector<Table> tables;
  add_meshes(page_looks.meshes, meshes_in(out), out, tables);
  pack(std::move(tables), data);
  return data;
}

}  // namespace headpin::scene
