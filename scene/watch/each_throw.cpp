#include "scene/watch/each_throw.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "scene/play/events.h"

namespace headpin::scene {

namespace {

/// Gives a session the samples that another one took in.
class Handed : public devices::Source {
 public:
  explicit Handed(const std::vector<devices::Sample>& samples) : samples_(samples) {}
  void poll(Time, std::vector<devices::Sample>& out) override {
    out.insert(out.end(), samples_.begin(), samples_.end());
  }
  bool exhausted() const override { return true; }

 private:
  const std::vector<devices::Sample>& samples_;
};

bool lets_go_of_ball(const devices::Event& event) {
  return event.kind == kind::release && !event.bodies.empty() &&
         event.bodies.front().starts_with("ball");
}

/// The world of another stage with all bodies where they are in this one.
engine::World moved_into(const engine::World& from, const Stage& before, const Stage& stage) {
  engine::World world = stage.world;
  engine::take_over(world, from);
  // A skittle of another shape may have its centre of mass elsewhere; its base stays.
  const Vec3 higher(0.0, 0.0, stage.skittle_centre - before.skittle_centre);
  for (const engine::BodyId skittle : stage.skittles) {
    Pose& X_WB = world.states[skittle].X_WB;
    X_WB.p += X_WB.q * higher;
  }
  return world;
}

/// A session that goes on alone: no button begins another version.
Session on_its_own(Session session, const std::shared_ptr<const Stage>& stage) {
  if (!differences(session.stage->scenario, stage->scenario).empty()) {
    session.world = moved_into(session.world, *session.stage, *stage);
  }
  session.stage = stage;
  session.versions = {};
  return session;
}

/// The trigger takes nothing more.
void open_hand(std::vector<devices::MouseSample>& buttons) {
  for (devices::MouseSample& button : buttons) button.trigger = false;
}

nlohmann::json optional_number(const auto& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

/// A session under way that follows one ball.
struct EachThrow::Alone {
  Session session;
  Time let_go{};
  ThrowResult result;
  bool over = false;

  /// @param samples  that the session at hand took in for this tick
  void advance(std::vector<devices::Sample> samples) {
    if (over) return;
    for (devices::Sample& sample : samples) {
      if (auto* button = std::get_if<devices::MouseSample>(&sample)) button->trigger = false;
    }
    step(samples);
  }

  /// As they are: so the tick is made that lets go.
  void step(const std::vector<devices::Sample>& samples) {
    Handed source(samples);
    scene::advance(session, source);
    for (const devices::Event& event : session.events) {
      result.skittles_down += event.kind == kind::skittle_down;
      if (lets_go_of_ball(event) && !result.release_speed) result.release_speed = event.value;
      if (event.kind == kind::first_contact && !result.impact_speed) {
        result.impact_speed = event.value;
      }
      if (event.kind == kind::delivery && !result.felled) {
        result.felled = static_cast<int>(event.value);
      }
    }
    constexpr Time kCounting{1'000'000};  // the rules count a little after the last moment
    const bool counts = session.game.begun && !session.game.over;
    const Time longest =
        microseconds(session.scenario().game.ball_back_s) + (counts ? kCounting : Time{});
    over = result.felled || session.now() - let_go > longest;
  }
};

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

EachThrow::~EachThrow() = default;

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

void EachThrow::begin(const Session& session, const devices::Event& release) {
  std::array<std::unique_ptr<Alone>, 2>& both = alone_.emplace_back();
  const std::array<std::shared_ptr<const Stage>, 2> stages = {before_->stage,
                                                              other_stage(before_->version)};
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i] = std::make_unique<Alone>();
    both[i]->session = on_its_own(*before_, stages[i]);
    both[i]->let_go = release.time;
    both[i]->step(session.samples);
    open_hand(both[i]->session.player.buttons);
  }
}

void EachThrow::tick(const Session& session) {
  for (auto& both : alone_) {
    for (const std::unique_ptr<Alone>& one : both) one->advance(session.samples);
  }
  for (const devices::Event& event : session.events) {
    if (lets_go_of_ball(event) && before_) begin(session, event);
    if (event.kind == kind::version || event.kind == kind::release ||
        event.kind == kind::delivery) {
      events_.push_back(event);
    }
  }
  before_.reset();
  if (session.player.held) before_ = session;
}

void EachThrow::finish() {
  for (auto& both : alone_) {
    for (const std::unique_ptr<Alone>& one : both) {
      while (!one->over) one->advance({});
    }
  }
}

std::vector<ThrowAlone> EachThrow::throws() const {
  std::vector<ThrowAlone> all;
  const std::vector<ThrownBall> of_session = thrown(events_);
  for (std::size_t i = 0; i < std::min(of_session.size(), alone_.size()); ++i) {
    all.push_back({of_session[i], alone_[i][0]->result, alone_[i][1]->result});
  }
  return all;
}

nlohmann::json to_json(const std::vector<ThrowAlone>& throws) {
  const auto result = [](const ThrowResult& one) -> nlohmann::json {
    return {{"felled", optional_number(one.felled)},
            {"skittles_down", one.skittles_down},
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
