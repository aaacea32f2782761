#include "scene/watch/trial_writer.h"

#include "scene/play/save.h"
#include "scene/record/events.h"
#include "scene/watch/totals.h"

namespace headpin::scene {

namespace {

constexpr std::int64_t kSnapshotSeconds = 10;  // between two

}  // namespace

TrialHeader header_of(TrialHeader header, const Session& session) {
  header.scenario = to_toml(session.trial_scenario());
  header.body_names = body_names(*session.stage);
  return header;
}

void TrialWriter::tick(const Session& session) {
  for (const devices::Sample& sample : session.samples) sink_->write(sample);
  for (const Event& event : session.events) sink_->write(event);
  tick_state(session, state_);
  sink_->write(state_);
  const std::int64_t each = kSnapshotSeconds * session.scenario().rates.physics_hz;
  if (session.hashes && session.tick > 0 && session.tick % each == 0) {
    sink_->write(Snapshot{session.now(), session.tick, save(session)});
  }
}

void TrialWriter::close(const Session& session) {
  if (const auto path = last_ball_path(session)) sink_->write(*path);
  Event last;
  last.time = session.now();
  last.tick = session.tick;
  last.kind = kind::ledger;
  last.detail = energies_of(session.world.ledger);
  sink_->write(last);
  last.kind = kind::game_hash;
  last.detail = in_hex(session.game_hash.value());
  sink_->write(last);
  sink_->close();
}

}  // namespace headpin::scene
