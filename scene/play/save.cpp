#include "scene/play/save.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "engine/save.h"
#include "engine/saved_bytes.h"

namespace headpin::scene {

namespace {

constexpr std::string_view kSavedSession = "HPSESSION";
constexpr std::uint8_t kSavedVersion = 5;
constexpr std::uint8_t kNoButton = 2;  // in place of a touched button's number

template <typename S, typename T>
concept Like = std::same_as<std::remove_const_t<S>, T>;

// The members of each type, in their order: one list for saving and restoring. `f` is a Saving or a
// Restoring.

template <typename F, Like<Pose> S>
void each_member(F& f, S& s) {
  f(s.p);
  f(s.q);
}

template <typename F, Like<Stamped<Pose>> S>
void each_member(F& f, S& s) {
  f(s.time);
  f(s.value);
}

template <typename F, Like<devices::MouseSample> S>
void each_member(F& f, S& s) {
  f(s.device_time);
  f(s.host_time);
  f(s.left_thumb);
  f(s.right_thumb);
  f(s.trigger);
  f(s.session_time);
}

template <typename F, Like<Walk> S>
void each_member(F& f, S& s) {
  f(s.p_WP);
  f(s.v_WP);
}

template <typename F, Like<Held> S>
void each_member(F& f, S& s) {
  f(s.body);
  f(s.q_HB);
}

template <typename F, Like<Tracking::Receiver> S>
void each_member(F& f, S& s) {
  f(s.last);
  f(s.lost);
}

template <typename F, Like<Passing> S>
void each_member(F& f, S& s) {
  f(s.time_s);
  f(s.distance);
  f(s.at_hand);
}

template <typename F, Like<Approach> S>
void each_member(F& f, S& s) {
  f(s.body);
  f(s.noticed);
  f(s.foreseen);
  f(s.along_W);
  f(s.closest);
  f(s.head_away);
  f(s.hand_away);
  f(s.passed);
}

template <typename F, Like<Own> S>
void each_member(F& f, S& s) {
  f(s.body);
  f(s.along_W);
}

template <typename F, Like<Presence> S>
void each_member(F& f, S& s) {
  f(s.approaches);
  f(s.own);
}

template <typename F, Like<engine::State> S>
void each_member(F& f, S& s) {
  f(s.X_WB);
  f(s.v_WB);
  f(s.w_WB);
}

template <typename F, Like<Delivered> S>
void each_member(F& f, S& s) {
  f(s.board);
  f(s.angle_deg);
  f(s.speed);
  f(s.revs_per_min);
  f(s.rotation_deg);
  f(s.tilt_deg);
}

template <typename F, Like<LanePlace> S>
void each_member(F& f, S& s) {
  f(s.board);
  f(s.distance);
}

template <typename F, Like<OilRing> S>
void each_member(F& f, S& s) {
  f(s.n_B);
  f(s.height);
}

template <typename F, Like<WatchedBall> S>
void each_member(F& f, S& s) {
  f(s.body);
  auto& path = s.watch.path;
  f(path.release);
  f(path.loft_end);
  f(path.skid_end);
  f(path.hook_end);
  f(path.breakpoint);
  f(path.entry);
  f(path.exit_board);
  f(path.gutter);
  f(path.flare_mm);
  f(s.watch.last);
  f(s.watch.landed_deg);
  f(s.watch.over);
  f(s.touched);
  auto& rings = s.rings;
  f(rings.begin_B);
  f(rings.last_B);
  f(rings.area_B);
  f(rings.sum_B);
  f(rings.places);
  f(rings.turned);
  f(rings.first);
  f(rings.flare);
  f(rings.newest);
}

template <typename F, Like<RingedBall> S>
void each_member(F& f, S& s) {
  f(s.body);
  f(s.rings);
}

/// A cell of the lane whose friction is not that of the fresh lane.
struct WornCell {
  std::uint32_t cell = 0;
  double friction = 0.0;
};

template <typename F, Like<WornCell> S>
void each_member(F& f, S& s) {
  f(s.cell);
  f(s.friction);
}

template <typename F, Like<Game> S>
void each_member(F& f, S& s) {
  f(s.down);
  f(s.moved_by);
  f(s.struck);
  f(s.stray);
  f(s.velocities);
  f(s.swept);
  f(s.frames);
  f(s.fouls);
  f(s.thrown);
  f(s.quiet);
  f(s.foul);
  f(s.beyond);
  f(s.begun);
  f(s.over);
  f(s.watched);
  f(s.ringed);
}

/// The player without its tracks and the change of its releases.
template <typename F, Like<Player> S>
void each_member(F& f, S& s) {
  f(s.walk);
  f(s.head_arrival);
  f(s.buttons);
  f(s.left_thumb);
  f(s.right_thumb);
  f(s.trigger);
  f(s.held);
  f(s.grip_changed);
  f(s.leaving);
}

template <typename F, Like<engine::Statistics> S>
void each_member(F& f, S& s) {
  for (auto* count : {&s.steps, &s.pairs, &s.contacts, &s.queries.queries, &s.queries.iterations,
                      &s.queries.capped, &s.impacts, &s.unfinished_impacts, &s.pulls, &s.islands,
                      &s.solver_iterations, &s.unsolved, &s.awake}) {
    f(*count);
  }
  f(s.residual);
  f(s.deepest_overlap);
}

/// A session without world, version, touched button, tracks and game hash.
template <typename F, Like<Session> S>
void each_member(F& f, S& s) {
  f(s.tick);
  f(s.version_begun);
  f(s.player);
  f(s.game);
  f(s.tracking.head);
  f(s.tracking.hand);
  f(s.presence);
  f(s.statistics);
}

template <typename T>
concept Number = std::is_arithmetic_v<T> || std::same_as<T, Vec3> || std::same_as<T, Quat> ||
    std::same_as<T, Time>;

struct Saving {
  engine::SavedWriter& out;

  template <typename T>
  void operator()(const T& x) {
    if constexpr (std::is_enum_v<T>) {
      out.add(static_cast<std::uint8_t>(x));
    } else if constexpr (Number<T>) {
      out.add(x);
    } else {
      each_member(*this, x);
    }
  }
  template <typename T>
  void operator()(const std::optional<T>& x) {
    out.add(x.has_value());
    if (x) (*this)(*x);
  }
  template <typename T>
  void operator()(const std::vector<T>& list) {
    out.add(static_cast<std::uint32_t>(list.size()));
    for (const T& x : list) (*this)(x);
  }
};

struct Restoring {
  engine::SavedReader& in;

  void operator()(By& x) {
    std::uint8_t by = 0;
    in.get(by);
    if (by > static_cast<std::uint8_t>(By::stray_ball))
      in.refuse("what moved a skittle is unknown");
    x = static_cast<By>(by);
  }
  template <typename T>
  void operator()(T& x) {
    if constexpr (Number<T>) {
      in.get(x);
    } else {
      each_member(*this, x);
    }
  }
  template <typename T>
  void operator()(std::optional<T>& x) {
    bool there = false;
    in.get(there);
    x.reset();
    if (there) (*this)(x.emplace());
  }
  template <typename T>
  void operator()(std::vector<T>& list) {
    list.assign(in.count(1), T{});
    for (T& x : list) (*this)(x);
  }
};

void restore_track(Restoring& in, devices::PoseTrack& track) {
  std::vector<Stamped<Pose>> samples;
  in(samples);
  track = {};
  for (const Stamped<Pose>& sample : samples) {
    if (std::abs(sample.value.q.norm() - 1.0) > 1e-3) {
      in.in.refuse("norm of a sample's quaternion is not 1");
    }
    if (!track.push(sample.time, sample.value)) in.in.refuse("samples are in no order");
  }
}

std::vector<WornCell> worn_cells(const Session& s) {
  std::vector<WornCell> cells;
  if (!s.stage->fresh_lane) return cells;
  const std::vector<double>& fresh = s.stage->fresh_lane->friction;
  const std::vector<double>& now = lane_of(s.world, *s.stage).friction;
  for (std::uint32_t cell = 0; cell < now.size(); ++cell) {
    if (now[cell] != fresh[cell]) cells.push_back({cell, now[cell]});
  }
  return cells;
}

void restore_worn_cells(Restoring& in, Session& s) {
  std::vector<WornCell> cells;
  in(cells);
  if (cells.empty()) return;
  if (!s.stage->fresh_lane) in.in.refuse("is of a lane with wear");
  auto lane = std::make_shared<engine::FrictionTable>(*s.stage->fresh_lane);
  for (const WornCell& worn : cells) {
    if (worn.cell >= lane->friction.size())
      in.in.refuse("has a part of the lane that there is not");
    lane->friction[worn.cell] = worn.friction;
  }
  engine::set_friction(s.world, s.stage->lane, std::move(lane));
}

/// What the rest of the program relies on: numbers of bodies that are there, as many entries as bodies.
bool is_consistent(const Session& s) {
  const std::size_t bodies = s.world.bodies.size();
  const auto there = [&](const auto& body) { return body < bodies; };
  const auto of_all = [&](const auto& list) { return list.size() == bodies; };
  const Game& game = s.game;
  const Player& player = s.player;
  const bool lists = of_all(game.down) && of_all(game.moved_by) && of_all(game.swept) &&
                     of_all(game.stray) && (of_all(game.velocities) || game.velocities.empty());
  const std::size_t cells = s.stage->fresh_lane ? s.stage->fresh_lane->friction.size() : 0;
  const bool watched =
      !game.watched || (there(game.watched->body) &&
                        std::ranges::all_of(game.watched->touched,
                                            [&](std::uint32_t cell) { return cell < cells; }));
  const bool ringed = !game.ringed || there(game.ringed->body);
  const bool frames = std::ranges::all_of(game.frames, [](const Frame& frame) {
    return std::ranges::all_of(frame, [](int down) { return down >= 0 && down <= 1000; });
  });
  std::size_t balls = 0;
  for (const Frame& frame : game.frames) balls += frame.size();
  const bool in_hand = (!player.held || (there(player.held->body) &&
                                         std::abs(player.held->q_HB.norm() - 1.0) < 1e-3)) &&
                       (!player.leaving || there(*player.leaving));
  const bool flying = std::ranges::all_of(s.presence.approaches, there, &Approach::body) &&
                      std::ranges::all_of(s.presence.own, there, &Own::body);
  constexpr std::int64_t kMostTicks = 1'000'000'000'000;  // their time has no overflow
  const bool ticks = s.tick == s.world.tick && s.tick <= kMostTicks;
  return lists && watched && ringed && frames && balls == game.fouls.size() && in_hand && flying &&
         ticks;
}

}  // namespace

std::vector<std::uint8_t> save(const Session& session) {
  if (!session.hashes) throw std::logic_error("a session without hashes is not saved");
  engine::SavedWriter out(kSavedSession, kSavedVersion);
  Saving f{out};
  f(session.version);
  f(engine::save(session.world));
  f(worn_cells(session));
  f(static_cast<std::uint8_t>(session.touched.value_or(kNoButton)));
  each_member(f, session);
  f(session.player.head.samples());
  f(session.player.hand.samples());
  f(session.game_hash.value());
  return out.sealed();
}

Session restore(Session s, std::span<const std::uint8_t> bytes) {
  engine::SavedReader in(bytes, kSavedSession, kSavedVersion, "saved session");
  Restoring f{in};
  f(s.version);
  if (s.version > s.versions.size()) in.refuse("has a version of the game that there is not");
  if (s.version > 0) s.stage = s.versions[s.version - 1];
  if (!s.stage) in.refuse("is of a game with two versions");
  s.world = engine::restore(s.stage->world, in.bytes(in.count(1)));
  restore_worn_cells(f, s);
  std::uint8_t touched = 0;
  f(touched);
  if (touched > kNoButton) in.refuse("has a button that there is not");
  s.touched = touched < kNoButton ? std::optional<std::size_t>(touched) : std::nullopt;
  each_member(f, s);
  restore_track(f, s.player.head);
  restore_track(f, s.player.hand);
  std::uint64_t game_hash = 0;
  f(game_hash);
  if (!in.empty()) in.refuse("goes on behind its end");
  if (!is_consistent(s)) in.refuse("its parts do not fit each other");
  s.game_hash = GameHash(game_hash);
  s.state_hash = engine::state_hash(s.world);
  s.samples.clear();
  s.events.clear();
  return s;
}

}  // namespace headpin::scene
