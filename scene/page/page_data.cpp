#include "scene/page/page_data.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/response.h"
#include "scene/page/page_film.h"
#include "scene/page/page_parts.h"
#include "scene/page/trouble_json.h"
#include "scene/play/outcome.h"
#include "scene/play/presence.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/record/first_difference.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/totals.h"

namespace headpin::scene {

namespace {

using nlohmann::json;

/// Compares the run with the states of the trial. The run continues after the first difference.
class Comparison : public Observer {
 public:
  Comparison(TrialPlayer& recorded, const Session& session)
      : recorded_(recorded),
        bodies_(shared_bodies(body_names(*session.stage), body_names(*session.stage))) {}

  void tick(const Session& session) override {
    const TickState* state = recorded_.state(session.tick);
    if (!state) return;
    hash_ = state->hash;
    if (first_) return;
    tick_state(session, now_);
    first_ = compare(now_, *state, bodies_);
    if (!first_) ++verified_;
  }

  json result(const Session& session, const TrialSummary& trial) const {
    const std::optional<SaidGameHash> said = said_game_hash(trial);
    return {{"game_replayed", in_hex(session.game_hash.value())},
            {"game_recorded", said ? json(said->hash) : json()},
            {"replayed", fmt::format("{:016x}", engine::state_hash(session.world))},
            {"recorded", hash_ ? json(fmt::format("{:016x}", *hash_)) : json()},
            {"verified_ticks", verified_},
            {"first_difference", first_ ? to_json(*first_) : json()}};
  }

 private:
  TrialPlayer& recorded_;
  SharedBodies bodies_;  // all of them
  TickState now_;
  std::optional<std::uint64_t> hash_;
  std::int64_t verified_ = 0;
  std::optional<FirstDifference> first_;
};

struct Happened : Observer {
  void tick(const Session& session) override {
    events.insert(events.end(), session.events.begin(), session.events.end());
  }
  std::vector<Event> events;
};

json of_trial(const Recorded& recorded) {
  const TrialSummary& t = recorded.file.summary();
  const TrialHeader& h = t.header;
  json out = {{"participant", h.participant},
              {"condition", h.condition},
              {"seed", std::to_string(h.seed)},
              {"version", h.software_version},
              {"commit", h.software_commit},
              {"format_version", h.format_version},
              {"scenario_name", recorded.scenario.name},
              {"scenario", h.scenario},
              {"complete", t.complete},
              {"duration_s", t.first ? seconds(*t.last - *t.first) : 0.0},
              {"states", t.state_count},
              {"frames", t.frame_count},
              {"backwards", t.backwards},
              {"late", t.late},
              {"skipped", skipped_json<json>(t.skipped)},
              {"trouble", trouble_json<json>(t.trouble, [](Time at) { return seconds(at); })}};
  out["devices"] = json::array();
  for (const auto& [device, d] : t.devices) {
    const double lasted = seconds(d.last - d.first);
    out["devices"].push_back(
        {{"device", devices::device_name(device)},
         {"samples", d.samples},
         {"rate_hz", lasted > 0.0 ? static_cast<double>(d.samples - 1) / lasted : 0.0},
         {"longest_gap_s", seconds(d.longest_gap)},
         {"lost", d.lost},
         {"bad", d.bad}});
  }
  return out;
}

/// For a release: how its motion is known, in words. For other events: empty.
std::string known_of(const Event& event) {
  const auto motion = motion_of(event.detail);
  return motion ? in_words(*motion) : "";
}

json of_events(const std::vector<Event>& events) {
  json out = json::array();
  for (const Event& e : events) {
    out.push_back({{"time_s", seconds(e.time)},
                   {"tick", e.tick},
                   {"kind", e.kind},
                   {"bodies", e.bodies},
                   {"p", numbers(e.p_W)},
                   {"j", numbers(e.j_W)},
                   {"value", e.value},
                   {"detail", e.detail.text()},
                   {"known", known_of(e)}});
  }
  return out;
}

/// Numbers of the meshes that the run shows, and of those that another run of the same stage may
/// show: under another collision shape, or with a hand that closes.
std::set<int> meshes_of(const Film& film, const Looks& looks) {
  std::set<int> shown = {looks.true_skittle.mesh, looks.ellipsoid_skittle.mesh, looks.ball.mesh,
                         looks.head};
  shown.insert(looks.hands.begin(), looks.hands.end());
  for (const Show& show : film.shows()) shown.insert(show.mesh);
  for (const render::DrawItem& item : looks.room.items) shown.insert(item.mesh);
  if (looks.oil_ring) shown.insert(*looks.oil_ring);
  if (looks.board) {
    for (const auto& [character, mesh] : looks.board->meshes) shown.insert(mesh);
  }
  shown.erase(-1);
  return shown;
}

void add_film(const Film& film, std::int64_t ticks, json& out) {
  out["drawn"] = {{"every", film.every()},
                  {"rows", film.rows()},
                  {"last_tick", ticks},
                  {"contacts_left_out", film.contacts_left_out()}};
  out["actors"] = json::array();
  for (const Actor& actor : film.actors()) {
    out["actors"].push_back({{"name", actor.name}, {"role", actor.role}});
  }
  out["shows"] = json::array();
  for (const Show& show : film.shows()) {
    out["shows"].push_back({show.row, show.actor, show.mesh});
  }
  out["rings"]["changes"] = json::array();
  for (const RingChange& change : film.ring_changes()) {
    out["rings"]["changes"].push_back({change.row, change.actor, change.kept, change.added});
  }
  if (out["board"].is_null()) return;
  out["board"]["texts"] = json::array();
  for (const BoardChange& change : film.board_changes()) {
    out["board"]["texts"].push_back({change.row, change.text});
  }
}

}  // namespace

PageData page_data(const Recorded& recorded, const PageLooks& page_looks,
                   const Condition& condition, bool meshes) {
  const Looks& looks = page_looks.looks;
  Scenario scenario = recorded.scenario;
  apply(condition, scenario);
  const bool unchanged = condition == Condition{};
  const TrialSummary& trial = recorded.file.summary();
  const std::int64_t ticks = recorded.ticks(scenario.rates.physics_hz);
  Session session = make_session(scenario);

  TrialPlayer source(recorded.file, {.states = unchanged && trial.state_count > 0});
  Comparison comparison(source, session);
  Film film(looks, trial, ticks, unchanged ? &source : nullptr);
  Totals totals;
  Happened happened;
  NoPace pace;
  Observer* const observers[] = {&comparison, &film, &totals, &happened};
  run(session, source, pace, observers, [&](const Session& s) { return s.tick >= ticks; });
  if (const auto path = last_ball_path(session)) happened.events.push_back(*path);

  PageData data;
  json& out = data.json;
  const json hash = comparison.result(session, trial);
  const bool as_recorded =
      unchanged && !hash["first_difference"].is_null() && !trial.events.empty();
  const std::vector<Event>& events = as_recorded ? trial.events : happened.events;
  out["trial"] = of_trial(recorded);
  const Score said = as_recorded ? score(trial) : totals.score_at_end(session);
  out["summary"] = summary(session, said);
  out["hash"] = hash;
  out["scenario_differences"] = to_json(differences(recorded.scenario, scenario));
  out["throw_count"] = thrown(happened.events).size();
  out["throws_without_counterpart"] =
      unchanged && !says_events(trial)
          ? json::array()
          : to_json(without_counterpart(events_of(recorded), happened.events));
  out["rate_hz"] = scenario.rates.physics_hz;
  out["ticks"] = ticks;
  out["events"] = of_events(events);
  out["event_kinds"] = json::object();
  for (const EventKind& kind : kEventKinds) out["event_kinds"][kind.name] = kind.when;
  out["approaches"] = approaches_in_words(events);
  out["why_nothing_fell"] = said.skittles_down == 0 ? why_nothing_fell(events) : "";
  out["bodies"] = body_names(*session.stage);
  out["responses"] = json::array();
  for (const engine::Response& response : engine::responses()) {
    out["responses"].push_back({{"name", response.name}, {"keeps", response.keeps}});
  }
  out["eyes"] = of_eyes(scenario.hmd.optics);
  out["light"] = of_light(looks.room);
  out["missing_meshes"] = page_looks.missing;
  out["room"] = of_room(scenario);
  out["still"] = of_still(looks.room);
  out["board"] = of_board(looks);
  out["rings"] = {{"mesh", of_ring_mesh(looks)}};
  add_film(film, ticks, out);
  std::vector<Table> tables = film.take_tables();
  out["meshes"] = json::array();
  if (meshes) add_meshes(page_looks.meshes, meshes_of(film, looks), out, tables);
  pack(std::move(tables), data);
  return data;
}

}  // namespace headpin::scene
