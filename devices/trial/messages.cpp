#include "devices/trial/messages.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <headpin/event_t.hpp>
#include <headpin/frame_t.hpp>
#include <headpin/mouse3d_t.hpp>
#include <headpin/mouse3d_v1_t.hpp>
#include <headpin/snapshot_t.hpp>
#include <headpin/state_change_t.hpp>
#include <headpin/state_t.hpp>
#include <headpin/tracked_device_t.hpp>
#include <headpin/tracked_device_v1_t.hpp>
#include <headpin/trial_t.hpp>

#include "devices/base/bytes.h"
#include "devices/base/version.h"
#include "devices/trial/layout.h"

namespace headpin::devices {
namespace {

std::int32_t count(std::size_t size) {
  if (size > 100'000)
    throw std::invalid_argument("a message has at most 100000 elements of one kind");
  return static_cast<std::int32_t>(size);
}

void put(const Vec3& v, double (&out)[3]) {
  std::copy_n(v.data(), 3, out);
}

void put(const Pose& pose, double (&position)[3], double (&quaternion)[4]) {
  put(pose.p, position);
  quaternion[0] = pose.q.w();
  quaternion[1] = pose.q.x();
  quaternion[2] = pose.q.y();
  quaternion[3] = pose.q.z();
}

Vec3 vec3(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

Pose pose(const double (&position)[3], const double (&quaternion)[4]) {
  return {Quat(quaternion[0], quaternion[1], quaternion[2], quaternion[3]), vec3(position)};
}

template <typename Lcm>
void encode_as(const Lcm& message, Buffer& out) {
  const int size = message.getEncodedSize();
  out.resize(static_cast<std::size_t>(size));
  const int written = message.encode(out.data(), 0, size);
  if (written < 0) throw std::invalid_argument("cannot encode a message for LCM");
  out.resize(static_cast<std::size_t>(written));
}

template <typename Lcm>
std::optional<Lcm> decode_as(std::span<const std::uint8_t> bytes) {
  static const Layouts layouts(schema_text());
  static const std::string type = Lcm::getTypeName();
  constexpr std::ptrdiff_t kFingerprint = 8;
  const auto size = static_cast<std::ptrdiff_t>(bytes.size());
  if (size < kFingerprint || size > std::numeric_limits<int>::max()) return std::nullopt;
  if (layouts.end_of(type, bytes, kFingerprint) != size) return std::nullopt;
  Lcm message;
  const int length = static_cast<int>(size);
  if (message.decode(bytes.data(), 0, length) != length) return std::nullopt;
  return message;
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

/// The fields that both versions of the type have.
template <typename Lcm>
TrackerSample tracker_sample(const Lcm& m) {
  TrackerSample sample;
  sample.device_time = Time{m.device_utime};
  sample.host_time = Time{m.host_utime};
  sample.sequence = m.sequence;
  sample.station = m.station;
  sample.X_TS = pose(m.position, m.quaternion);
  sample.status = static_cast<char>(m.status);
  sample.buttons = static_cast<std::uint8_t>(m.buttons);
  sample.frame = m.frame;
  return sample;
}

std::optional<Message> decode_tracker(std::span<const std::uint8_t> bytes) {
  if (const auto m = decode_as<tracked_device_t>(bytes)) {
    TrackerSample sample = tracker_sample(*m);
    sample.session_time = Time{m->session_utime};
    return sample;
  }
  const auto v1 = decode_as<tracked_device_v1_t>(bytes);
  if (!v1) return std::nullopt;
  return tracker_sample(*v1);
}

template <typename Lcm>
MouseSample mouse_sample(const Lcm& m) {
  MouseSample sample;
  sample.device_time = Time{m.device_utime};
  sample.host_time = Time{m.host_utime};
  sample.left_thumb = m.left_thumb != 0;
  sample.right_thumb = m.right_thumb != 0;
  sample.trigger = m.trigger != 0;
  return sample;
}

std::optional<Message> decode_mouse(std::span<const std::uint8_t> bytes) {
  if (const auto m = decode_as<mouse3d_t>(bytes)) {
    MouseSample sample = mouse_sample(*m);
    sample.session_time = Time{m->session_utime};
    return sample;
  }
  const auto v1 = decode_as<mouse3d_v1_t>(bytes);
  if (!v1) return std::nullopt;
  return mouse_sample(*v1);
}

std::optional<Message> decode_event(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<event_t>(bytes);
  if (!m) return std::nullopt;
  return Event{Time{m->utime}, m->tick,          m->kind,  m->bodies,
               vec3(m->point), vec3(m->impulse), m->value, m->detail};
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
std::optional<BodyChange> take_body(Bytes& bytes, std::int32_t first) {
  constexpr std::uint64_t kMostBodies = 100'000;
  const std::optional<std::uint64_t> body = take_varint(bytes);
  if (!body || *body / 2 >= kMostBodies || static_cast<std::int32_t>(*body / 2) < first) {
    return std::nullopt;
  }
  BodyChange change{static_cast<std::int32_t>(*body / 2), *body % 2 == 1, {}};
  for (std::uint64_t& beyond : change.beyond) {
    const std::optional<std::uint64_t> number = take_varint(bytes);
    if (!number) return std::nullopt;
    beyond = static_cast<std::uint64_t>(unzigzag(*number));
  }
  return change;
}

std::optional<Message> decode_change(std::span<const std::uint8_t> bytes) {
  const auto m = decode_as<state_change_t>(bytes);
  if (!m) return std::nullopt;
  StateChange change{
      Time{m->utime}, m->tick, static_cast<std::uint64_t>(m->hash), m->num_contacts, {}};
  Bytes left = m->changes;
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

bool plausible_time(Time time) {
  constexpr Time kLimit{4'000'000'000'000'000};  // as a stamp since 1970, the year 2096
  return -kLimit < time && time < kLimit;
}

bool plausible_times(const auto& sample) {
  return plausible_time(sample.device_time) && plausible_time(sample.host_time) &&
         plausible_time(sample.session_time);
}

bool plausible_pose(const Pose& pose) {
  return pose.p.allFinite() && std::abs(pose.q.norm() - 1.0) < 1e-3;
}

struct Plausible {
  bool operator()(const TrialHeader&) const { return true; }
  bool operator()(const TrackerSample& s) const {
    constexpr std::int64_t kMostSamples = 1'000'000'000'000'000;
    constexpr double kReachOfEarth = 1e8;  // from any origin on Earth [m]
    return plausible_times(s) && plausible_pose(s.X_TS) &&
           s.X_TS.p.cwiseAbs().maxCoeff() <= kReachOfEarth && s.sequence >= 0 &&
           s.sequence < kMostSamples;
  }
  bool operator()(const MouseSample& s) const { return plausible_times(s); }
  bool operator()(const Event& e) const {
    return plausible_time(e.time) && e.p_W.allFinite() && e.j_W.allFinite() &&
           std::isfinite(e.value);
  }
  bool operator()(const TickState& s) const {
    return plausible_time(s.time) && std::ranges::all_of(s.bodies, [](const BodyState& body) {
             return plausible_pose(body.X_WB) && body.V_WB.v.allFinite() && body.V_WB.w.allFinite();
           });
  }
  bool operator()(const StateChange& s) const { return plausible_time(s.time); }
  bool operator()(const Snapshot& s) const { return plausible_time(s.time); }
  bool operator()(const FrameRecord& f) const {
    return plausible_time(f.time) && std::ranges::all_of(f.X_WE, plausible_pose);
  }
};

}  // namespace

void encode(const TrialHeader& header, Buffer& out) {
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

void encode(const TrackerSample& sample, Buffer& out) {
  tracked_device_t m;
  m.device_utime = sample.device_time.count();
  m.host_utime = sample.host_time.count();
  m.sequence = sample.sequence;
  m.station = sample.station;
  put(sample.X_TS, m.position, m.quaternion);
  m.status = static_cast<std::int8_t>(sample.status);
  m.buttons = sample.buttons;
  m.frame = sample.frame;
  m.session_utime = sample.session_time.count();
  encode_as(m, out);
}

void encode(const MouseSample& sample, Buffer& out) {
  mouse3d_t m;
  m.device_utime = sample.device_time.count();
  m.host_utime = sample.host_time.count();
  m.left_thumb = sample.left_thumb;
  m.right_thumb = sample.right_thumb;
  m.trigger = sample.trigger;
  m.session_utime = sample.session_time.count();
  encode_as(m, out);
}

void encode(const Event& event, Buffer& out) {
  event_t m;
  m.utime = event.time.count();
  m.tick = event.tick;
  m.kind = event.kind;
  m.num_bodies = count(event.bodies.size());
  m.bodies = event.bodies;
  put(event.p_W, m.point);
  put(event.j_W, m.impulse);
  m.value = event.value;
  m.detail = event.detail;
  encode_as(m, out);
}

void encode(const TickState& state, Buffer& out) {
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

void encode(const StateChange& change, Buffer& out) {
  state_change_t m;
  m.utime = change.time.count();
  m.tick = change.tick;
  m.hash = static_cast<std::int64_t>(change.hash);
  m.num_contacts = change.contacts;
  for (const BodyChange& body : change.bodies) {
    append_varint(2 * static_cast<std::uint64_t>(body.body) + body.asleep, m.changes);
    for (const std::uint64_t beyond : body.beyond) {
      append_varint(zigzag(static_cast<std::int64_t>(beyond)), m.changes);
    }
  }
  m.num_bytes = static_cast<std::int32_t>(m.changes.size());
  encode_as(m, out);
}

void encode(const Snapshot& snapshot, Buffer& out) {
  snapshot_t m;
  m.utime = snapshot.time.count();
  m.tick = snapshot.tick;
  m.num_bytes = static_cast<std::int32_t>(snapshot.saved.size());
  m.saved = snapshot.saved;
  encode_as(m, out);
}

void encode(const FrameRecord& frame, Buffer& out) {
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
  return channel == kTrialChannel || channel == kTrackerChannel || channel == kMouseChannel ||
         channel == kEventChannel || channel == kStateChannel || channel == kStateChangeChannel ||
         channel == kSnapshotChannel || channel == kFrameChannel;
}

std::optional<Message> decode(std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (channel == kTrialChannel) return decode_header(bytes);
  if (channel == kTrackerChannel) return decode_tracker(bytes);
  if (channel == kMouseChannel) return decode_mouse(bytes);
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

}  // namespace headpin::devices
