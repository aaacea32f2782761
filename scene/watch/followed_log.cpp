#include "scene/watch/followed_log.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "devices/base/sample.h"
#include "scene/looks/glimpse.h"
#include "scene/looks/looks.h"
#include "scene/record/events.h"
#include "scene/scenario/text.h"
#include "scene/stage/bodies.h"
#include "scene/stage/stage.h"

namespace headpin::scene {

namespace {

using nlohmann::json;

constexpr std::size_t kMostRest = 8'000'000;  // bytes: no event of ours is so long
constexpr Time kRecently{2'000'000};
constexpr std::size_t kMostFrames = 1000;  // that are counted as recent

json numbers(const Pose& X) {
  return {X.q.w(), X.q.x(), X.q.y(), X.q.z(), X.p.x(), X.p.y(), X.p.z()};
}

json numbers(const std::optional<Pose>& X) {
  return X ? numbers(*X) : json();
}

json sheets_of(const Score& score) {
  json out = json::array();
  for (const Sheet& sheet : score.games) out.push_back(in_words(sheet));
  return out;
}

constexpr std::size_t kNoBody = std::numeric_limits<std::size_t>::max();

/// The first body of an event.
std::size_t first_body(const Event& event, const std::optional<TrialHeader>& header) {
  if (!header || event.bodies.empty()) return kNoBody;
  const std::vector<std::string>& names = header->body_names;
  return static_cast<std::size_t>(std::ranges::find(names, event.bodies.front()) - names.begin());
}

/// Whether a tracked space can be so. Its numbers are finite, but may be so large that no place follows
/// from them.
bool is_usable(const Rig& rig) {
  constexpr double kFarthest = 100.0;  // from what is tracked, or from the foul line [m]
  const auto is_near = [](const Pose& X) { return X.p.norm() < kFarthest; };
  return rig.head_station != rig.hand_station && is_near(rig.X_WT) && is_near(rig.X_SD) &&
         is_near(rig.X_SH);
}

}  // namespace

void FollowedLog::add(std::span<const std::uint8_t> piece) {
  rest_.insert(rest_.end(), piece.begin(), piece.end());
  devices::LogReader reader(rest_);
  while (const auto event = reader.next()) take(*event);
  unusable_ += reader.skipped_bytes();
  const auto cut = static_cast<std::ptrdiff_t>(reader.cut_bytes());
  rest_.erase(rest_.begin(), rest_.end() - cut);
  if (rest_.size() <= kMostRest) return;
  unusable_ += static_cast<std::int64_t>(rest_.size());
  rest_.clear();
}

void FollowedLog::take(const devices::LogEvent& event) {
  if (!is_trial_channel(event.channel)) return;
  const std::optional<Message> message = decode(event.channel, event.data);
  if (!message || !plausible(*message)) {
    ++unusable_;
    return;
  }
  std::visit([this](const auto& one) { take(one); }, *message);
}

void FollowedLog::take(const TrialHeader& header) {
  if (header_) return;
  header_ = header;
  try {
    Scenario its;
    ScenarioText text{.where = "log", .whole = true};
    read_text(its, header.scenario, text);
    if (is_usable(its.rig)) scenario_.rig = its.rig;
  } catch (const std::exception&) {  // the hand is then shown as of another device
  }
  const auto centre = [](const Scenario& s) { return skittle_body(s).centre_height; };
  centres_.fill(centre(scenario_));
  if (const Versions& v = scenario_.version; v.buttons) {
    centres_[1] = centre(under(scenario_, v.red));
    centres_[2] = centre(under(scenario_, v.blue));
  }
}

void FollowedLog::take(const devices::TrackerSample& sample) {
  const bool in_hand =
      sample.station == devices::kHandStation || sample.station == devices::kLeftHandStation;
  if (in_hand ? sample.places_hand() : sample.good()) X_TS_[sample.station] = sample.X_TS;
}

void FollowedLog::take(const Event& event) {
  const auto skittles = static_cast<double>(scenario_.rack.spots.size());
  if (event.detail.get_if<GameKind>() &&
      event.value > skittles) {  // each throw would name them all
    ++unusable_;
    return;
  }
  if (event.kind == kEndEvent) ended_ = true;
  if (event.kind == kind::tracking_lost) {
    ++times_lost_;
    lost_.insert(event.detail.text());
  }
  if (event.kind == kind::tracking_back) lost_.erase(event.detail.text());
  if (event.kind == kind::paused) ++pauses_;
  if (event.kind == kind::played_with) played_with_ = event.detail.text();
  if (event.kind == kind::version && scenario_.version.buttons) {
    const Versions& versions = scenario_.version;
    version_ = event.detail.text() == "red" ? 1 : 2;
    scenario_ = under(scenario_, version_ == 1 ? versions.red : versions.blue);
  }
  if (event.kind == kind::version) holds_ = false;
  if (event.kind == kind::grab || event.kind == kind::release) {
    holds_ = event.kind == kind::grab;
    held_ = first_body(event, header_);
    grip_tick_ = event.tick;
  }
  score_.add(event, scenario_);
}

/// A skittle that is set up anew is taken out of the hand without an event. What is carried is awake.
void FollowedLog::watch_hand() {
  if (!holds_ || held_ >= last_.bodies.size() || !last_.bodies[held_].asleep) return;
  holds_ = false;
  grip_tick_ = last_.tick;
}

void FollowedLog::take(const TickState& state) {
  last_ = state;
  history_.begin(state);
  watch_hand();
}

void FollowedLog::take(const StateChange& change) {
  const TickState* state = history_.go_on(change);
  if (state && plausible(Message(*state))) {
    last_ = *state;
    watch_hand();
  } else {
    history_.forget();  // changes of such a state are of no use either
    ++unusable_;
  }
}

void FollowedLog::take(const FrameRecord& frame) {
  ++frames_;
  frame_ = frame;
  frame_times_.push_back(frame.time);
  while (frame_times_.size() > kMostFrames ||
         (frame_times_.size() > 1 && frame.time - frame_times_.front() > kRecently)) {
    frame_times_.pop_front();
  }
}

double FollowedLog::frame_rate_hz() const {
  if (frame_times_.size() < 2) return 0.0;
  const Time took = frame_times_.back() - frame_times_.front();
  return took > Time{} ? static_cast<double>(frame_times_.size() - 1) / seconds(took) : 0.0;
}

bool FollowedLog::shows_ellipsoids() const {
  return scene::shows_ellipsoids(scenario_);
}

/// How much higher a skittle's mesh is drawn than its body's origin [m].
double FollowedLog::raised() const {
  const DrawnCentres drawn = drawn_centres(scenario_, centres_[0]);
  return skittle_look(shows_ellipsoids(), centres_[version_], drawn).raised;
}

std::optional<Pose> FollowedLog::head() const {
  if (!frame_) return std::nullopt;
  return Pose{frame_->X_WE[0].q, 0.5 * (frame_->X_WE[0].p + frame_->X_WE[1].p)};
}

/// By where the hand's sensor is beside the head's.
std::optional<Pose> FollowedLog::hand() const {
  const std::optional<Pose> X_WD = head();
  const Rig& rig = scenario_.rig;
  const auto its_head = X_TS_.find(static_cast<std::int32_t>(rig.head_station));
  const auto its_hand = X_TS_.find(static_cast<std::int32_t>(rig.hand_station));
  if (!X_WD || its_head == X_TS_.end() || its_hand == X_TS_.end()) return std::nullopt;
  const Vec3 p_WS_head = *X_WD * rig.X_SD.inverse().p;
  const Quat& q_WT = rig.X_WT.q;
  const Pose X_WS{q_WT * its_hand->second.q,
                  p_WS_head + q_WT * (its_hand->second.p - its_head->second.p)};
  return X_WS * rig.X_SH;
}

double FollowedLog::closed() const {
  if (!grip_tick_) return 0.0;
  const double ticks = static_cast<double>(last_.tick) - static_cast<double>(*grip_tick_);
  return how_closed(holds_, ticks / static_cast<double>(scenario_.rates.physics_hz));
}

json FollowedLog::state() const {
  json bodies = json::object();
  if (header_) {
    const std::size_t count = std::min(header_->body_names.size(), last_.bodies.size());
    const double up = raised();
    for (std::size_t i = 0; i < count; ++i) {
      const std::string& name = header_->body_names[i];
      Pose X_WB = last_.bodies[i].X_WB;
      if (up != 0.0 && role_named(name) == Role::skittle) X_WB.p = X_WB * Vec3(0.0, 0.0, up);
      bodies[name] = numbers(X_WB);
    }
  }
  json lost = json::array();
  for (const std::string& what : lost_) lost.push_back(what);
  const json played_with = json::parse(played_with_, nullptr, false);
  return {{"tick", last_.tick},
          {"time_s", seconds(last_.time)},
          {"participant", header_ ? header_->participant : ""},
          {"played_with", played_with.is_discarded() ? json() : played_with},
          {"skittles_down", score_.skittles_down},
          {"throws", score_.throws.size()},
          {"sheets", sheets_of(score_)},
          {"frames", frames_},
          {"frame_rate_hz", frame_rate_hz()},
          {"lost_now", std::move(lost)},
          {"times_lost", times_lost_},
          {"pauses", pauses_},
          {"unusable", unusable_},
          {"ended", ended_},
          {"head", numbers(head())},
          {"hand", numbers(hand())},
          {"left_hand", scenario_.rig.hand_station == devices::kLeftHandStation},
          {"closed", closed()},
          {"ellipsoids", shows_ellipsoids()},
          {"bodies", std::move(bodies)}};
}

}  // namespace headpin::scene
