#include "scene/record/messages.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <headpin/event_t.hpp>
#include <headpin/frame_t.hpp>
#include <headpin/snapshot_t.hpp>
#include <headpin/state_change_t.hpp>
#include <headpin/state_t.hpp>
#include <headpin/trial_t.hpp>

#include "devices/base/bytes.h"
#include "devices/log/lcm_message.h"
#include "devices/log/sample_messages.h"

namespace headpin::scene {
namespace {

using devices::decode_as;
using devices::encode_as;
using devices::plausible;
using devices::pose;
using devices::put;
using devices::vec3;

std::int32_t count(std::size_t size) {
  if (size > 100'000)
    throw std::invalid_argument("a message has at most 100000 elements of one kind");
  return static_cast<std::int32_t>(size);
}

std::optional<Message> decode_header(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<trial_t>(bytes);
  if (!m) return std::nullopt;
  TrialHeader header;
  header.participant = m->participant;
  header.condition = m->condition;
  header.seed = static_cast<std::uint64_t>(m->seed);
  header.scenario = m->scenario;
  header.body_names = m->body_names;
  header.format_version = m->format_version;
  header.software_version = m->software_version;
  header.software_commit = m->software_commit;
  header.schema = m->schema;
  return header;
}

std::optional<Message> decode_event(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<event_t>(bytes);
  if (!m) return std::nullopt;
  return Event{Time{m->utime}, m->tick,          m->kind,  m->bodies,
               vec3(m->point), vec3(m->impulse), m->value, Detail::read(m->kind, m->detail)};
}

std::optional<Message> decode_state(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<state_t>(bytes);
  if (!m) return std::nullopt;
  TickState state{
      Time{m->utime}, m->tick, static_cast<std::uint64_t>(m->hash), m->num_contacts, {}};
  state.bodies.reserve(m->bodies.size());
  for (const body_state_t& b : m->bodies) {
    state.bodies.push_back({pose(b.position, b.quaternion),
                            {vec3(b.velocity), vec3(b.angular_velocity)},
                            b.asleep != 0});
  }
  return state;
}

/// Takes the body at the front of `bytes`; its number is at least `first`.
std::optional<BodyChange> take_body(devices::Bytes& bytes, std::int32_t first) {
  constexpr std::uint64_t kMostBodies = 100'000;
  const std::optional<std::uint64_t> body = devices::take_varint(bytes);
  if (!body || *body / 2 >= kMostBodies || static_cast<std::int32_t>(*body / 2) < first) {
    return std::nullopt;
  }
  BodyChange change{static_cast<std::int32_t>(*body / 2), *body % 2 == 1, {}};
  for (std::uint64_t& beyond : change.beyond) {
    const std::optional<std::uint64_t> number = devices::take_varint(bytes);
    if (!number) return std::nullopt;
    beyond = static_cast<std::uint64_t>(devices::unzigzag(*number));
  }
  return change;
}

std::optional<Message> decode_change(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<state_change_t>(bytes);
  if (!m) return std::nullopt;
  StateChange change{
      Time{m->utime}, m->tick, static_cast<std::uint64_t>(m->hash), m->num_contacts, {}};
  devices::Bytes left = m->changes;
  for (std::int32_t first = 0; !left.empty(); first = change.bodies.back().body + 1) {
    const std::optional<BodyChange> body = take_body(left, first);
    if (!body) return std::nullopt;
    change.bodies.push_back(*body);
  }
  return change;
}

std::optional<Message> decode_snapshot(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<snapshot_t>(bytes);
  return m ? std::optional<Message>(Snapshot{Time{m->utime}, m->tick, m->saved}) : std::nullopt;
}

std::optional<Message> decode_frame(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<frame_t>(bytes);
  if (!m) return std::nullopt;
  return FrameRecord{
      Time{m->utime},
      m->frame,
      m->tick,
      {pose(m->left_position, m->left_quaternion), pose(m->right_position, m->right_quaternion)},
      {static_cast<std::uint64_t>(m->left_hash), static_cast<std::uint64_t>(m->right_hash)}};
}

struct Plausible {
  bool operator()(const TrialHeader&) const { return true; }
  bool operator()(const devices::TrackerSample& s) const { return plausible(devices::Sample(s)); }
  bool operator()(const devices::MouseSample& s) const { return plausible(devices::Sample(s)); }
  bool operator()(const Event& e) const {
    return plausible(e.time) && e.p_W.allFinite() && e.j_W.allFinite() && std::isfinite(e.value);
  }
  bool operator()(const TickState& s) const {
    return plausible(s.time) && std::ranges::all_of(s.bodies, [](const BodyState& body) {
             return plausible(body.X_WB) && body.V_WB.v.allFinite() && body.V_WB.w.allFinite();
           });
  }
  bool operator()(const StateChange& s) const { return plausible(s.time); }
  bool operator()(const Snapshot& s) const { return plausible(s.time); }
  bool operator()(const FrameRecord& f) const {
    return plausible(f.time) &&
           std::ranges::all_of(f.X_WE, [](const Pose& X_WE) { return plausible(X_WE); });
  }
};

}  // namespace

void encode(const TrialHeader& header, devices::Buffer& out) {
  trial_t m;
  m.format_version = header.format_version;
  m.software_version = header.software_version;
  m.software_commit = header.software_commit;
  m.participant = header.participant;
  m.condition = header.condition;
  m.seed = static_cast<std::int64_t>(header.seed);
  m.scenario = header.scenario;
  m.schema = header.schema;
  m.num_bodies = count(header.body_names.size());
  m.body_names = header.body_names;
  encode_as(m, out);
}

void encode(const Event& event, devices::Buffer& out) {
  event_t m;
  m.utime = event.time.count();
  m.tick = event.tick;
  m.kind = event.kind;
  m.num_bodies = count(event.bodies.size());
  m.bodies = event.bodies;
  put(event.p_W, m.point);
  put(event.j_W, m.impulse);
  m.value = event.value;
  m.detail = event.detail.text();
  encode_as(m, out);
}

void encode(const TickState& state, devices::Buffer& out) {
  state_t m;
  m.utime = state.time.count();
  m.tick = state.tick;
  m.hash = static_cast<std::int64_t>(state.hash);
  m.num_contacts = state.contacts;
  m.num_bodies = count(state.bodies.size());
  m.bodies.resize(state.bodies.size());
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const BodyState& from = state.bodies[i];
    body_state_t& to = m.bodies[i];
    put(from.X_WB, to.position, to.quaternion);
    put(from.V_WB.v, to.velocity);
    put(from.V_WB.w, to.angular_velocity);
    to.asleep = from.asleep;
  }
  encode_as(m, out);
}

void encode(const StateChange& change, devices::Buffer& out) {
  state_change_t m;
  m.utime = change.time.count();
  m.tick = change.tick;
  m.hash = static_cast<std::int64_t>(change.hash);
  m.num_contacts = change.contacts;
  for (const BodyChange& body : change.bodies) {
    devices::append_varint(2 * static_cast<std::uint64_t>(body.body) + body.asleep, m.changes);
    for (const std::uint64_t beyond : body.beyond) {
      devices::append_varint(devices::zigzag(static_cast<std::int64_t>(beyond)), m.changes);
    }
  }
  m.num_bytes = static_cast<std::int32_t>(m.changes.size());
  encode_as(m, out);
}

void encode(const Snapshot& snapshot, devices::Buffer& out) {
  snapshot_t m;
  m.utime = snapshot.time.count();
  m.tick = snapshot.tick;
  m.num_bytes = static_cast<std::int32_t>(snapshot.saved.size());
  m.saved = snapshot.saved;
  encode_as(m, out);
}

void encode(const FrameRecord& frame, devices::Buffer& out) {
  frame_t m;
  m.utime = frame.time.count();
  m.frame = frame.frame;
  m.tick = frame.tick;
  put(frame.X_WE[0], m.left_position, m.left_quaternion);
  put(frame.X_WE[1], m.right_position, m.right_quaternion);
  m.left_hash = static_cast<std::int64_t>(frame.hash[0]);
  m.right_hash = static_cast<std::int64_t>(frame.hash[1]);
  encode_as(m, out);
}

bool is_trial_channel(std::string_view channel) {
  return channel == kTrialChannel || channel == devices::kTrackerChannel ||
         channel == devices::kMouseChannel || channel == kEventChannel ||
         channel == kStateChannel || channel == kStateChangeChannel ||
         channel == kSnapshotChannel || channel == kFrameChannel;
}

std::optional<Message> decode(std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (channel == kTrialChannel) return decode_header(bytes);
  if (const auto sample = devices::decode_sample(channel, bytes)) {
    return std::visit([](const auto& s) { return std::optional<Message>(s); }, *sample);
  }
  if (channel == kEventChannel) return decode_event(bytes);
  if (channel == kStateChannel) return decode_state(bytes);
  if (channel == kStateChangeChannel) return decode_change(bytes);
  if (channel == kSnapshotChannel) return decode_snapshot(bytes);
  if (channel == kFrameChannel) return decode_frame(bytes);
  return std::nullopt;
}

bool plausible(const Message& message) {
  return std::visit(Plausible{}, message);
}

}  // namespace headpin::scene
