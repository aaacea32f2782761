#include "scene/watch/each_throw.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "scene/record/events.h"

namespace headpin::scene {

namespace {

/// Removes trigger presses, so that the hand grabs nothing more.
void open_hand(std::vector<devices::MouseSample>& buttons) {
  for (devices::MouseSample& button : buttons) button.trigger = false;
}

nlohmann::json optional_number(const auto& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

EachThrow::EachThrow(const Session& session, const Scenario& other) : other_(other) {
  if (session.scenario().rates.physics_hz != other.rates.physics_hz) {
    throw std::invalid_argument(
        "rates.physics_hz: separate throws need the tick rate of the trial");
  }
  if (body_names(*session.stage) != body_names(*other_stage(0))) {
    throw std::invalid_argument(
        "separate throws need the bodies of the trial; this condition has other bodies");
  }
}

std::shared_ptr<const Stage> EachThrow::other_stage(std::uint64_t version) {
  std::shared_ptr<const Stage>& stage = stages_.at(version);
  if (stage) return stage;
  const Versions& versions = other_.version;
  Scenario scenario = other_;
  if (versions.buttons && version == 1) scenario = under(scenario, versions.red);
  if (versions.buttons && version == 2) scenario = under(scenario, versions.blue);
  stage = std::make_shared<const Stage>(make_stage(scenario));
  return stage;
}

void EachThrow::begin(const Session& session, const Event& release) {
  std::array<Alone, 2>& both = alone_.emplace_back();
  const std::array<std::shared_ptr<const Stage>, 2> stages = {before_->stage,
                                                              other_stage(before_->version)};
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i].session = on_its_own(*before_, stages[i]);
    both[i].let_go = release.time;
    both[i].step(session.samples);
    open_hand(both[i].session.player.buttons);
  }
}

void EachThrow::tick(const Session& session) {
  for (auto& both : alone_) {
    for (Alone& one : both) one.advance(session.samples);
  }
  for (const Event& event : session.events) {
    if (is_release_of_ball(event) && before_) begin(session, event);
    if (event.kind == kind::version || event.kind == kind::release ||
        event.kind == kind::delivery) {
      events_.push_back(event);
    }
  }
  before_ = session;  // a ball may be taken and let go within the next tick
}

void EachThrow::finish() {
  for (auto& both : alone_) {
    for (Alone& one : both) {
      while (!one.over) one.advance({});
    }
  }
}

std::vector<ThrowAlone> EachThrow::throws() const {
  std::vector<ThrowAlone> all;
  const std::vector<ThrownBall> of_session = thrown(events_);
  for (std::size_t i = 0; i < std::min(of_session.size(), alone_.size()); ++i) {
    all.push_back({of_session[i], alone_[i][0].result, alone_[i][1].result});
  }
  return all;
}

nlohmann::json to_json(const std::vector<ThrowAlone>& throws) {
  const auto result = [](const ThrowResult& one) -> nlohmann::json {
    return {{"felled", optional_number(one.felled)},
            {"skittles_down", one.felled.value_or(one.skittles_down)},
            {"release_speed_mps", optional_number(one.release_speed)},
            {"impact_speed_mps", optional_number(one.impact_speed)}};
  };
  nlohmann::json all = nlohmann::json::array();
  for (const ThrowAlone& one : throws) {
    all.push_back({{"throw", one.thrown.number},
                   {"name", one.thrown.version},
                   {"time_s", seconds(one.thrown.time)},
                   {"felled", optional_number(one.thrown.felled)},
                   {"as_it_was", result(one.as_it_was)},
                   {"other_condition", result(one.other)}});
  }
  return all;
}

}  // namespace headpin::scene
