#include "scene/page/page_session.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "devices/log/sample_messages.h"
#include "scene/looks/glimpse.h"
#include "scene/page/browser_device.h"
#include "scene/page/page_parts.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {

namespace {

void require_plausible(const devices::Sample& sample) {
  if (devices::plausible(sample)) return;
  throw std::invalid_argument(fmt::format("sample at {:.6f} s: its numbers are impossible",
                                          seconds(devices::device_time(sample))));
}

void append(const Pose& X, std::vector<float>& out) {
  for (const double x : {X.q.w(), X.q.x(), X.q.y(), X.q.z(), X.p.x(), X.p.y(), X.p.z()}) {
    out.push_back(static_cast<float>(x));
  }
}

Session begun(std::string_view scenario, const PageSession::Options& options) {
  const Scenario played = played_with(scenario_of_trial(scenario, "the page's scenario"),
                                      browser_device(options.device), options.left_hand);
  check(played, "the page's scenario");
  return make_session(played);
}

nlohmann::json to_news(const Event& event) {
  const auto numbers = [](const Vec3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  return {{"kind", event.kind},     {"time_us", event.time.count()}, {"tick", event.tick},
          {"bodies", event.bodies}, {"p", numbers(event.p_W)},       {"j", numbers(event.j_W)},
          {"value", event.value},   {"detail", event.detail.text()}};
}

/// The score sheets in words; whether the game is over, which with two versions it is once both have
/// been played; the versions that no game has begun of.
nlohmann::json news_of(const Score& score, const Versions& versions) {
  nlohmann::json sheets = nlohmann::json::array(), unplayed = nlohmann::json::array();
  for (const Sheet& sheet : score.games) sheets.push_back(in_words(sheet));
  for (const char* const version : {"red", "blue"}) {
    if (versions.buttons &&
        std::ranges::find(score.games, version, &Sheet::version) == score.games.end()) {
      unplayed.push_back(version);
    }
  }
  const bool last_over = !score.games.empty() && score.games.back().over;
  const bool over = last_over && unplayed.empty();
  return {{"skittles_down", score.skittles_down},
          {"sheets", std::move(sheets)},
          {"last_over", last_over},
          {"over", over},
          {"unplayed", std::move(unplayed)}};
}

}  // namespace

void GivenSamples::poll(Time, std::vector<devices::Sample>& out) {
  out.insert(out.end(), given_.begin(), given_.end());
  given_.clear();
}

PageSession::PageSession(std::string_view scenario, const Options& options)
    : session_(begun(scenario, options)),
      drawn_(drawn_centres(*session_.stage)),
      samples_({&given_}) {
  TrialHeader header;
  header.participant = options.participant;
  header.condition = options.condition;
  header.seed = options.seed;
  const auto keep = [this](const devices::LogEvent& event) { devices::append(event, log_); };
  const TrialEvents::Options how{.states = States::changes, .epoch = options.epoch};
  if (session_.scenario().sound.on) hearing_.emplace(session_);
  writer_.emplace(std::make_unique<TrialEvents>(header_of(header, session_), how, keep));
}

void PageSession::take(devices::TrackerSample sample) {
  sample.sequence = sequence_[sample.station]++;
  require_plausible(sample);
  given_.give(sample);
}

void PageSession::take(const devices::MouseSample& sample) {
  require_plausible(sample);
  given_.give(sample);
}

void PageSession::note(std::string_view kind, std::string detail, double value) {
  Event event;
  event.time = session_.now();
  event.tick = session_.tick;
  event.kind = kind;
  event.detail = std::move(detail);
  event.value = value;
  writer_->write(event);
}

void PageSession::drew(const FrameRecord& frame) {
  FrameRecord record = frame;
  record.tick = session_.tick;
  writer_->write(record);
}

std::int64_t PageSession::advance(Time until) {
  const std::int64_t before = session_.tick;
  while (session_.next_tick() <= until) {
    scene::advance(session_, samples_);
    writer_->tick(session_);
    totals_.tick(session_);
    if (hearing_) hearing_->tick(session_, heard_);
    news_.insert(news_.end(), session_.events.begin(), session_.events.end());
  }
  return session_.tick - before;
}

void PageSession::see(std::vector<float>& out) const {
  const std::optional<Pose> X_WD = head_pose(session_);
  const Glimpse g = glimpse(session_, X_WD.value_or(Pose{}));
  out.clear();
  for (const double x : {g.ellipsoids ? 1.0 : 0.0, g.closed, g.X_WH ? 1.0 : 0.0, X_WD ? 1.0 : 0.0,
                         session_.player.held ? 1.0 : 0.0}) {
    out.push_back(static_cast<float>(x));
  }
  append(session_.player.walk.X_WP(), out);
  append(g.X_WH.value_or(Pose{}), out);
  append(g.X_WD, out);
  const double raised = skittle_look(g.ellipsoids, g.skittle_centre, drawn_).raised;
  for (const Pose& X_WB : g.X_WB_skittles) {
    append({X_WB.q, X_WB * Vec3(0.0, 0.0, raised)}, out);
  }
  for (const Pose& X_WB : g.X_WB_balls) append(X_WB, out);
}

nlohmann::json PageSession::take_news() {
  const Glimpse g = glimpse(session_, {});
  const bool same = g.X_BG_rings.size() == told_rings_ && g.board == told_board_;
  if (news_.empty() && same) return nullptr;
  told_rings_ = g.X_BG_rings.size();
  told_board_ = g.board;
  nlohmann::json events = nlohmann::json::array();
  for (const Event& event : std::exchange(news_, {})) events.push_back(to_news(event));
  return {{"events", std::move(events)},
          {"score", news_of(totals_.score(), session_.scenario().version)},
          {"board", g.board},
          {"rings", {{"ball", g.ringed}, {"each", of_rings(g, session_.scenario().ball.radius)}}}};
}

std::vector<StereoSample> PageSession::take_sound() {
  return std::exchange(heard_, {});
}

std::vector<std::uint8_t> PageSession::take_log() {
  return std::exchange(log_, {});
}

nlohmann::json PageSession::finish(std::int64_t frames, std::int64_t late_frames) {
  Event pace;
  pace.time = session_.now();
  pace.tick = session_.tick;
  pace.kind = kind::kept_pace;
  pace.detail = KeptPace{.ticks = session_.tick, .frames = frames, .late_frames = late_frames};
  writer_->write(pace);
  writer_->close(session_);
  return {{"game_hash", in_hex(session_.game_hash.value())},
          {"state_hash", fmt::format("{:016x}", session_.state_hash)},
          {"ticks", session_.tick},
          {"skittles_down", totals_.score().skittles_down}};
}

}  // namespace headpin::scene
