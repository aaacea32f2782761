#pragma once

#include <string_view>
#include <utility>

/// What old trials ran under.
namespace headpin::scene {

/// Keys that trials of before these keys were there lack, with what such a trial ran under. What is
/// written here never changes, whatever becomes of the defaults.
inline constexpr std::pair<std::string_view, std::string_view> kKeysSince[] = {
    {"hand.release_window_most_s", "0.12"},
    {"hand.release_accuracy", "0.3"},
    {"hand.falls_at_once", "false"},
    {"collision.warm", "true"},
    {"collision.friction_tau_s", "0.016666666666666666"},
    {"look.samples", "2"},
    {"look.contact", "true"},
    {"look.shadow", "true"},
    {"look.mirror", "true"},
    {"look.light", "'pixel'"},
    {"rig.head_station", "1"},
    {"rig.hand_station", "2"},
    {"skittle.seen", "'collider'"},
    {"game.rules", "'one-throw'"},
    {"game.frames", "5"},
    {"game.balls", "2"},
    {"game.ball_back_s", "8.0"},
    {"game.off_spot", "0.2"},
    {"version.buttons", "false"},
    {"version.radius", "0.06"},
    {"version.red.button", "[-0.55, 0.0, 1.1]"},
    {"version.red.elasticity", "0.7"},
    {"version.red.friction", "0.7"},
    {"version.red.shape", "'true'"},
    {"version.blue.button", "[-0.85, 0.0, 1.1]"},
    {"version.blue.elasticity", "0.7"},
    {"version.blue.friction", "0.7"},
    {"version.blue.shape", "'true'"},
    {"hand.takes_skittles", "false"},
    {"hand.solid", "false"},
    {"hand.elasticity", "0.0"},
    {"hand.friction", "0.7"},
    {"walk.speed", "0.0"},  // thumbs moved nobody
    {"walk.acceleration", "3.0"},
    {"walk.clearance", "0.3"},
    {"room.solid_ceiling", "false"},
    {"lane.masking_panel", "true"},
    {"lane.kick_backs", "true"},
    {"lane.gutter_width", "0.235"},
    {"lane.gutter_depth", "0.0"},
    {"skittle.weighed", "'parts'"},
    {"hmd.outer_deg", "0.0"},
    {"hmd.inner_deg", "0.0"},
    {"hmd.up_deg", "0.0"},
    {"hmd.down_deg", "0.0"},
    {"hmd.relay_width", "0"},
    {"hmd.relay_height", "0"},
    {"hmd.lens_k1", "0.0"},
    {"hmd.lens_k2", "0.0"},
    {"room.mesh.file", "''"},
    {"room.mesh.unit", "1.0"},
    {"room.mesh.axes", "'RAS'"},
    {"room.mesh.sha256", "''"},
    {"skittle.mesh.file", "''"},
    {"skittle.mesh.unit", "1.0"},
    {"skittle.mesh.axes", "'RAS'"},
    {"skittle.mesh.sha256", "''"},
    {"ball.mesh.file", "''"},
    {"ball.mesh.unit", "1.0"},
    {"ball.mesh.axes", "'RAS'"},
    {"ball.mesh.sha256", "''"},
    {"hand.mesh.file", "''"},
    {"hand.mesh.unit", "1.0"},
    {"hand.mesh.axes", "'RAS'"},
    {"hand.mesh.sha256", "''"},
};

}  // namespace headpin::scene
