#include "scene/page/page_film.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "scene/looks/glimpse.h"

namespace headpin::scene {

using nlohmann::json;

namespace {

constexpr std::int64_t kMostDrawnRows = 24'000;   // 100 s of every tick
constexpr std::int64_t kMostClockRows = 6'000;    // of a tracker
constexpr std::size_t kMostContacts = 20'000;     // impulses that are kept
constexpr double kLengthQuantum = 1.0 / 32768.0;  // 0.03 mm, far below a tracker's noise [m]
constexpr double kTurnQuantum = 1.0 / 32768.0;    // of a quaternion's numbers
constexpr double kSpeedQuantum = 1.0 / 1024.0;    // [m/s]
constexpr double kEnergyQuantum = 1.0 / 1024.0;   // [J]
constexpr double kImpulseQuantum = 1.0 / 4096.0;  // [N s]
constexpr double kTimeQuantum = 1e-6;             // [s]
constexpr Time kHandSpeedOver{16'667};

std::int64_t stride(std::int64_t all, std::int64_t most) {
  return std::max<std::int64_t>(1, (all + most - 1) / most);
}

std::array<float, 7> in_numbers(const Pose& X, const std::vector<std::array<float, 7>>& before) {
  Quat q = X.q;
  if (!before.empty()) {  // of the two quaternions of a rotation, the one nearer to the last
    const auto& b = before.back();
    const double dot = q.w() * b[0] + q.x() * b[1] + q.y() * b[2] + q.z() * b[3];
    if (dot < 0.0) q.coeffs() = -q.coeffs();
  }
  const auto f = [](double x) { return static_cast<float>(x); };
  return {f(q.w()), f(q.x()), f(q.y()), f(q.z()), f(X.p.x()), f(X.p.y()), f(X.p.z())};
}

const char* role_of(std::uint32_t id) {
  if (id == kHandId) return "hand";
  if (id == kHeadId) return "head";
  return id >= kFirstSkittleId ? "skittle" : "ball";
}

std::string name_of(std::uint32_t id, const Stage& stage) {
  const auto name = [&](const std::vector<engine::BodyId>& bodies, std::size_t i) {
    return i < bodies.size() ? stage.world.bodies[bodies[i]].name : std::string(role_of(id));
  };
  if (id >= kFirstSkittleId) return name(stage.skittles, id - kFirstSkittleId);
  if (id >= kFirstBallId) return name(stage.balls, id - kFirstBallId);
  return role_of(id);
}

/// Whether the recorded state has as many bodies as the session.
bool fits(const TickState* recorded, const Session& session) {
  return recorded && recorded->bodies.size() == session.world.states.size();
}

void put_where_recorded(Glimpse& g, const Stage& stage, const TickState& recorded) {
  for (std::size_t i = 0; i < stage.skittles.size(); ++i) {
    g.X_WB_skittles[i] = recorded.bodies[stage.skittles[i]].X_WB;
  }
  for (std::size_t i = 0; i < stage.balls.size(); ++i) {
    g.X_WB_balls[i] = recorded.bodies[stage.balls[i]].X_WB;
  }
}

double fastest(const std::vector<engine::BodyId>& bodies, const Session& session,
               const TickState* recorded) {
  double speed = 0.0;
  for (const engine::BodyId body : bodies) {
    const Vec3& v = recorded ? recorded->bodies[body].V_WB.v : session.world.states[body].v_WB;
    speed = std::max(speed, v.norm());
  }
  return speed;
}

double impulse_of(const float* row) {
  return std::hypot(row[6], row[7], row[8]);
}

}  // namespace

Film::Film(const Looks& looks, const TrialSummary& trial, std::int64_t ticks, TrialPlayer* recorded)
    : looks_(looks), recorded_(recorded), ticks_(ticks), every_(stride(ticks, kMostDrawnRows)) {
  series_ = {"series",
             {"ball_mps", "skittle_mps", "hand_mps", "contacts", "gravity_j", "hand_j", "impact_j",
              "sustained_j", "correction_j"},
             {kSpeedQuantum, kSpeedQuantum, kSpeedQuantum, 1, kEnergyQuantum, kEnergyQuantum,
              kEnergyQuantum, kEnergyQuantum, kEnergyQuantum},
             {}};
  contacts_ = {"contacts",
               {"tick", "a", "b", "x", "y", "z", "jx", "jy", "jz", "approach_mps"},
               {1, 1, 1, kLengthQuantum, kLengthQuantum, kLengthQuantum, kImpulseQuantum,
                kImpulseQuantum, kImpulseQuantum, kSpeedQuantum},
               {}};
  for (const auto& [device, summary] : trial.devices) {
    if (device == devices::Device::mouse) continue;  // it sends samples only when something changes
    Clock& clock = clocks_[device];
    clock.every = stride(summary.samples, kMostClockRows);
    clock.table = {fmt::format("clock {}", devices::device_name(device)),
                   {"device_s", "host_after_s", "tick_after_s"},
                   {1e-4, kTimeQuantum, kTimeQuantum},
                   {}};
  }
}

void Film::start(const Session& session) {
  draw(session, nullptr);
  measure(session, nullptr);
  ++rows_;
}

void Film::tick(const Session& session) {
  const TickState* recorded = recorded_ ? recorded_->state(session.tick) : nullptr;
  if (!fits(recorded, session)) recorded = nullptr;
  note_contacts(session);
  note_clocks(session);
  if (const auto X_WH = hand_pose(session)) {
    hand_.push_back({session.now(), X_WH->p});
    if (session.now() - hand_.front().time > kHandSpeedOver) hand_.erase(hand_.begin());
  }
  if (session.tick % every_ != 0 && session.tick != ticks_) return;
  draw(session, recorded);
  measure(session, recorded);
  ++rows_;
}

void Film::draw(const Session& session, const TickState* recorded) {
  const std::optional<Pose> X_WD = head_pose(session);
  Glimpse g = glimpse(session, X_WD.value_or(Pose{}));
  if (X_WD) g.X_WC = Pose{};  // so that the head is seen
  const json rings = of_rings(g, looks_.ball_radius);
  g.X_BG_rings.clear();                                              // they are no actors
  const std::vector<std::string> text = std::exchange(g.board, {});  // nor is it
  const bool changed = board_changes_.empty() ? !text.empty() : text != board_changes_.back().text;
  if (changed) board_changes_.push_back({rows_, text});
  if (recorded) put_where_recorded(g, *session.stage, *recorded);
  const render::DrawList list = draw_list(looks_, g);

  std::vector<int> seen_as(actors_.size(), -1);
  std::map<std::uint32_t, int> of_id;
  for (std::size_t i = looks_.room.items.size(); i < list.items.size(); ++i) {
    const render::DrawItem& item = list.items[i];
    const auto [at, is_new] = actor_of_.try_emplace({item.id, of_id[item.id]++}, actors_.size());
    if (is_new) {
      actors_.push_back({name_of(item.id, *session.stage), role_of(item.id), {}});
      seen_as_.push_back(-1);
      seen_as.push_back(-1);
      actors_.back().X_WG.assign(static_cast<std::size_t>(rows_), in_numbers(item.X_WG, {}));
    }
    Actor& actor = actors_[at->second];
    actor.X_WG.push_back(in_numbers(item.X_WG, actor.X_WG));
    seen_as[at->second] = item.mesh;
  }
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    std::vector<std::array<float, 7>>& poses = actors_[i].X_WG;
    if (std::ssize(poses) == rows_) poses.push_back(poses.back());  // where it was last seen
    if (seen_as[i] != seen_as_[i] || (rows_ == 0 && seen_as[i] < 0)) {
      shows_.push_back({rows_, i, seen_as[i]});
    }
  }
  seen_as_ = std::move(seen_as);
  note_rings(rings, g.ringed);
}

/// Rings are added one by one, until the next throw.
void Film::note_rings(const nlohmann::json& rings, std::size_t ball) {
  if (rings == rings_) return;
  const bool more = ball == ringed_ && rings_.size() <= rings.size() &&
                    std::equal(rings_.begin(), rings_.end(), rings.begin());
  const std::size_t kept = more ? rings_.size() : 0;
  json added = json::array();
  for (std::size_t i = kept; i < rings.size(); ++i) added.push_back(rings[i]);
  const std::size_t actor = actor_of_.at({kFirstBallId + static_cast<std::uint32_t>(ball), 0});
  ring_changes_.push_back({rows_, actor, kept, std::move(added)});
  rings_ = rings;
  ringed_ = ball;
}

void Film::measure(const Session& session, const TickState* recorded) {
  const engine::Ledger& ledger = session.world.ledger;
  double hand = 0.0;
  if (hand_.size() > 1) {
    hand = (hand_.back().p_W - hand_.front().p_W).norm() /
           seconds(hand_.back().time - hand_.front().time);
  }
  for (const double value : {fastest(session.stage->balls, session, recorded),
                             fastest(session.stage->skittles, session, recorded), hand,
                             static_cast<double>(session.world.statistics.contacts),
                             ledger.gravity.energy, ledger.hand.energy, ledger.impact.energy,
                             ledger.sustained.energy, ledger.correction.energy}) {
    series_.values.push_back(static_cast<float>(value));
  }
}

void Film::note_contacts(const Session& session) {
  for (const engine::ContactEvent& contact : session.world.events) {
    if (contact.impulse_W.isZero()) continue;
    for (const double value : {static_cast<double>(session.tick), static_cast<double>(contact.a),
                               static_cast<double>(contact.b), contact.p_W.x(), contact.p_W.y(),
                               contact.p_W.z(), contact.impulse_W.x(), contact.impulse_W.y(),
                               contact.impulse_W.z(), contact.approach_speed}) {
      contacts_.values.push_back(static_cast<float>(value));
    }
  }
  if (contacts_.rows() > 2 * kMostContacts) drop_weak_contacts();
}

/// Keeps the strongest contacts, in their order; of those that are as strong as the weakest of them, the
/// first ones.
void Film::drop_weak_contacts() {
  const std::size_t width = contacts_.columns.size();
  std::vector<double> strengths;
  for (std::size_t row = 0; row < contacts_.rows(); ++row) {
    strengths.push_back(impulse_of(&contacts_.values[row * width]));
  }
  const auto least = strengths.end() - static_cast<std::ptrdiff_t>(kMostContacts);
  std::vector<double> sorted = strengths;
  std::ranges::nth_element(sorted, sorted.begin() + (least - strengths.begin()));
  const double weakest = sorted[static_cast<std::size_t>(least - strengths.begin())];
  const auto stronger =
      std::ranges::count_if(strengths, [&](double strength) { return strength > weakest; });
  std::size_t as_weak = kMostContacts - static_cast<std::size_t>(stronger);
  std::vector<float> kept;
  for (std::size_t row = 0; row < strengths.size(); ++row) {
    if (strengths[row] < weakest || (strengths[row] == weakest && as_weak == 0)) continue;
    if (strengths[row] == weakest) --as_weak;
    const float* values = &contacts_.values[row * width];
    kept.insert(kept.end(), values, values + width);
  }
  contacts_left_out_ += static_cast<std::int64_t>(strengths.size() - kept.size() / width);
  contacts_.values = std::move(kept);
}

/// Stores the sample with the longest delay of every few samples, because late ones are of
/// interest.
void Film::note_clocks(const Session& session) {
  for (const devices::Sample& sample : session.samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    const auto at = tracker ? clocks_.find(devices::device_at(tracker->station)) : clocks_.end();
    if (at == clocks_.end()) continue;
    Clock& clock = at->second;
    const bool on_wire = tracker->host_time != Time{};
    const std::array<float, 3> row = {
        static_cast<float>(seconds(tracker->device_time)),
        static_cast<float>(on_wire ? seconds(tracker->host_time - tracker->device_time) : 0.0),
        static_cast<float>(seconds(tracker->session_time - tracker->device_time))};
    if (clock.left == 0 || row[2] > clock.latest[2]) clock.latest = row;
    if (++clock.left == clock.every) end_group(clock);
  }
}

void Film::end_group(Clock& clock) {
  if (clock.left == 0) return;
  clock.left = 0;
  clock.table.values.insert(clock.table.values.end(), clock.latest.begin(), clock.latest.end());
}

std::vector<Table> Film::take_tables() {
  if (contacts_.rows() > kMostContacts) drop_weak_contacts();
  Table poses{"poses", {}, {}, {}};
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    for (const char* column : {"qw", "qx", "qy", "qz", "x", "y", "z"}) {
      poses.columns.push_back(fmt::format("{} {}", actors_[i].name, column));
      poses.quanta.push_back(column[0] == 'q' ? kTurnQuantum : kLengthQuantum);
    }
  }
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows_); ++row) {
    for (const Actor& actor : actors_) {
      poses.values.insert(poses.values.end(), actor.X_WG[row].begin(), actor.X_WG[row].end());
    }
  }
  std::vector<Table> all;
  all.push_back(std::move(poses));
  all.push_back(std::move(series_));
  all.push_back(std::move(contacts_));
  for (auto& [device, clock] : clocks_) {
    end_group(clock);
    all.push_back(std::move(clock.table));
  }
  return all;
}

}  // namespace headpin::scene
