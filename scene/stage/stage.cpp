#include "scene/stage/stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "scene/stage/oil_table.h"

namespace headpin::scene {

namespace {

engine::BodyId add(Stage& stage, Role role, engine::Body body, const Pose& X_WB) {
  stage.roles.push_back(role);
  return engine::add_body(stage.world, std::move(body), {X_WB, Vec3::Zero(), Vec3::Zero()});
}

/// "ball", "ball 2", "ball 3" ...
std::string numbered(const std::string& name, std::size_t before) {
  return before == 0 ? name : fmt::format("{} {}", name, before + 1);
}

}  // namespace

Pose away_pose(const Stage& stage, engine::BodyId skittle) {
  constexpr double kBehind = 1.0, kApart = 0.3;
  return {Quat::Identity(), Vec3(kApart * static_cast<double>(skittle),
                                 stage.scenario.room.ahead + kBehind, stage.skittle_centre)};
}

bool is_away(const Stage& stage, engine::BodyId body, const Pose& X_WB) {
  if (stage.roles[body] == Role::hand) return X_WB.p == kAway.p;
  return stage.roles[body] == Role::skittle && X_WB.p == away_pose(stage, body).p;
}

Stage make_stage(const Scenario& scenario) {
  Stage stage;
  stage.scenario = scenario;
  stage.room = room_measures(scenario);
  stage.world = engine::make_world(world_parameters(scenario));
  SkittleBody skittle = skittle_body(scenario);
  stage.skittle = std::move(skittle.body);
  stage.skittle_centre = skittle.centre_height;
  for (const SkittlePart& part : scenario.skittle.parts) {
    stage.widest_skittle = std::max(stage.widest_skittle, part.radius);
  }
  for (Fixture& fixture : room_fixtures(scenario)) {
    add(stage, fixture.role, std::move(fixture.body), fixture.X_WB);
  }
  stage.lane =
      static_cast<engine::BodyId>(std::ranges::find(stage.roles, Role::lane) - stage.roles.begin());
  if (scenario.lane.oil.wear > 0.0) {
    stage.fresh_lane = std::make_shared<const engine::FrictionTable>(oil_table(stage.room));
  }
  add_ball(stage, scenario.ball.home);
  add_rack(stage, {0.0, scenario.lane.head_pin});
  if (scenario.hand.solid) stage.hand = add(stage, Role::hand, hand_body(scenario), kAway);
  return stage;
}

engine::BodyId add_ball(Stage& stage, const Vec3& home) {
  engine::Body body = ball_body(stage.scenario);
  body.name = numbered(body.name, stage.balls.size());
  const engine::BodyId ball = add(stage, Role::ball, std::move(body), {Quat::Identity(), home});
  engine::set_kind(stage.world, ball, engine::Kind::driven);  // on its stand until it is grabbed
  stage.balls.push_back(ball);
  return ball;
}

void add_rack(Stage& stage, const Vec2& head_pin) {
  for (const Vec2& spot : stage.scenario.rack.spots) {
    engine::Body body = stage.skittle;
    body.name = name_of_skittle(static_cast<int>(stage.skittles.size()) + 1);
    const Vec2 p = head_pin + spot;
    const engine::BodyId skittle =
        add(stage, Role::skittle, std::move(body),
            {Quat::Identity(), Vec3(p.x(), p.y(), stage.skittle_centre)});
    engine::put_to_sleep(stage.world, skittle);
    stage.skittles.push_back(skittle);
  }
}

std::vector<std::string> body_names(const Stage& stage) {
  std::vector<std::string> names;
  for (const engine::Body& body : stage.world.bodies) names.push_back(body.name);
  return names;
}

std::string name_of_skittle(int number) {
  return fmt::format("{} {}", kSkittleName, number);
}

std::optional<int> skittle_number(std::string_view name) {
  if (role_named(name) != Role::skittle) return std::nullopt;
  const std::size_t space = name.find(' ');
  if (space == std::string_view::npos) return std::nullopt;
  int number = 0;
  for (const char c : name.substr(space + 1)) {
    if (c < '0' || c > '9' || number > 1'000'000) return std::nullopt;
    number = 10 * number + (c - '0');
  }
  return number;
}

std::optional<Role> role_named(std::string_view name) {
  const std::string_view first_word = name.substr(0, name.find(' '));
  if (first_word == kBallName) return Role::ball;
  if (first_word == kSkittleName) return Role::skittle;
  if (first_word == kHandName) return Role::hand;
  return std::nullopt;
}

}  // namespace headpin::scene
