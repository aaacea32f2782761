#include "devices/fastrak.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "devices/fastrak_geometry.h"

namespace headpin::devices {
namespace {

constexpr std::array<int, 7> kBauds = {115200, 57600, 38400, 19200, 9600, 4800, 2400};
constexpr std::size_t kBufferLimit = 1 << 16;  // bytes; a unit sends 1 % of that in a second

bool has_any(const std::vector<int>& items, std::initializer_list<int> wanted) {
  return std::any_of(items.begin(), items.end(), [&](int item) {
    return std::find(wanted.begin(), wanted.end(), item) != wanted.end();
  });
}

bool has_quaternion(const std::vector<int>& items) {
  return has_any(items, {11, 61, 20});
}
bool has_angles(const std::vector<int>& items) {
  return has_any(items, {4, 54, 19});
}
bool has_matrix(const std::vector<int>& items) {
  return has_any(items, {5, 55}) && has_any(items, {6, 56}) && has_any(items, {7, 57});
}

void check(const std::vector<int>& items) {
  for (const int item : items) {
    if (!is_fastrak_item(item, true)) {
      throw std::invalid_argument("output list: item " + std::to_string(item) + " does not exist");
    }
  }
  if (!has_any(items, {2, 52, 18})) {
    throw std::invalid_argument("output list: expected a position (2, 52 or 18)");
  }
  if (!has_quaternion(items) && !has_angles(items) && !has_matrix(items)) {
    throw std::invalid_argument(
        "output list: expected an orientation (quaternion 11, 61, 20; angles 4, 54, 19; or "
        "matrix 5 6 7, 55 56 57)");
  }
  if (!has_any({items.back()}, {0, 1, 50, 51})) {
    throw std::invalid_argument("output list: expected a space (0) or CR LF (1) at its end");
  }
}

std::string list_of(const std::vector<int>& items) {
  std::string text;
  for (const int item : items) text.append(",").append(std::to_string(item));
  return text;
}

/// The first `length` bytes in a row that `decode` makes something of.
template <typename Decode>
auto find_answer(const std::vector<std::uint8_t>& bytes, std::size_t length, Decode decode) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (std::size_t at = 0; at + length <= text.size(); ++at) {
    if (auto answer = decode(text.substr(at, length))) return answer;
  }
  return decltype(decode(text))();
}

/// A number as the manual writes it, signed and with two decimals.
std::string field(double value) {
  const std::array<double, 1> one = {value};
  return std::string(",").append(encode_columns(one, 7, 2));
}

}  // namespace

void read_zenith(std::string_view text, FastrakZeniths& zeniths) {
  const auto refuse = [&] {
    throw std::invalid_argument(std::string("hemisphere '")
                                    .append(text)
                                    .append("': expected X,Y,Z or STATION:X,Y,Z, three finite "
                                            "numbers and a station from 1 to 4"));
  };
  std::string_view rest = text;
  std::optional<std::size_t> station;
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    if (colon != 1 || text[0] < '1' || text[0] >= '1' + kFastrakStations) refuse();
    station = static_cast<std::size_t>(text[0] - '1');
    rest.remove_prefix(2);
  }
  Vec3 zenith;
  for (int i = 0; i < 3; ++i) {
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), zenith[i]);
    if (error != std::errc() || !std::isfinite(zenith[i])) refuse();
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (i == 2) break;
    if (!rest.starts_with(',')) refuse();
    rest.remove_prefix(1);
  }
  if (!rest.empty()) refuse();
  if (station) {
    zeniths[*station] = zenith;
  } else {
    zeniths.fill(zenith);
  }
}

FastrakDriver::FastrakDriver(std::unique_ptr<ByteStream> stream, FastrakOptions options)
    : stream_(std::move(stream)), options_(std::move(options)), baud_(options_.baud) {
  if (options_.items.empty()) throw std::invalid_argument("output list: empty");
  check(options_.items);
  formats_.fill({options_.items, options_.binary, options_.centimetres});
}

std::string FastrakDriver::activity() const {
  const std::string attempt =
      " (attempt " + std::to_string(attempt_ + 1) + ", " + std::to_string(baud_) + " baud)";
  switch (phase_) {
    case Phase::kStopping:
      return "stopping what it was doing" + attempt;
    case Phase::kStartingUp:
      return "waiting for it to start up" + attempt;
    case Phase::kStatus:
      return "asking for its status" + attempt;
    case Phase::kSettingUp:
      return "setting it up";
    case Phase::kActive:
    case Phase::kLists:
      return "checking its set-up";
    case Phase::kStreaming:
      return "streaming";
  }
  return "";
}

void FastrakDriver::poll(Time asked, std::vector<Sample>& out) {
  // A session that is late asks for times gone by; the line knows how long the unit has said
  // nothing.
  const Time now = stream_->time(asked);
  if (!begun_) {
    begun_ = true;
    start_over(now);
  }
  hear(now);
  while (step(now)) {
  }
  if (phase_ == Phase::kStreaming) {
    read_records(now);
    hand_out(now, out);
  }
  speak(now);
}

// --- The line --------------------------------------------------------------------------------

void FastrakDriver::hear(Time now) {
  std::array<std::uint8_t, 4096> bytes{};
  while (buffer_.size() < kBufferLimit) {
    const std::size_t n = stream_->read(bytes);
    if (n == 0) return;
    arrivals_.push_back({position_ + buffer_.size(), stream_->arrived(now)});
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    heard_ = now;
  }
}

void FastrakDriver::speak(Time now) {
  while (!to_say_.empty() && now >= may_speak_) {
    std::string& command = to_say_.front();
    const Bytes bytes(reinterpret_cast<const std::uint8_t*>(command.data()), command.size());
    const std::size_t taken = stream_->write(bytes);
    may_speak_ = now + static_cast<int>(taken) * byte_time();
    command.erase(0, taken);
    if (!command.empty()) return;
    to_say_.pop_front();
    may_speak_ += options_.command_gap;
  }
}

bool FastrakDriver::said_all(Time now) const {
  return to_say_.empty() && now >= may_speak_;
}

void FastrakDriver::consume(std::size_t count) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
  position_ += count;
  while (arrivals_.size() > 1 && arrivals_[1].position <= position_) arrivals_.pop_front();
}

void FastrakDriver::drain() {
  statistics_.drained_bytes += static_cast<std::int64_t>(buffer_.size());
  consume(buffer_.size());
}

Time FastrakDriver::arrival_of(std::uint64_t position) const {
  Time time = arrivals_.front().time;
  for (const Arrival& arrival : arrivals_) {
    if (arrival.position > position) break;
    time = arrival.time;
  }
  return time;
}

// --- Bringing it up --------------------------------------------------------------------------

void FastrakDriver::enter(Phase phase, Time now) {
  phase_ = phase;
  phase_began_ = now;
}

void FastrakDriver::start_over(Time now) {
  attempt_ = -1;
  try_again(now);
}

void FastrakDriver::try_again(Time now) {
  ++attempt_;
  ++statistics_.attempts;
  drain();
  to_say_.clear();
  may_speak_ = now;
  // Rounds of eight: stop it, break a half-typed line, re-initialise it, then patiently again. From
  // the second round on at the other rates in turn, two attempts each.
  const int place = attempt_ % 8;
  if (options_.search_baud && attempt_ >= 8) {
    const auto own = std::find(kBauds.begin(), kBauds.end(), options_.baud) - kBauds.begin();
    const auto rate = static_cast<std::size_t>(own + attempt_ / 2 - 4) % kBauds.size();
    baud_ = kBauds[rate];
  } else {
    baud_ = options_.baud;
  }
  stream_->set_baud(baud_);
  if (place == 2 && baud_ == options_.baud) {
    to_say_.emplace_back("\r\x19");
    enter(Phase::kStartingUp, now);
    return;
  }
  to_say_.emplace_back(place % 2 == 1 ? "\x11\rc"
                                      : "\x11"
                                        "c");
  enter(Phase::kStopping, now);
}

/// Queues a line command for a station.
void FastrakDriver::say(char letter, std::size_t station, std::string_view arguments) {
  std::string command(1, letter);
  command += static_cast<char>('1' + station);
  to_say_.push_back(command.append(arguments).append("\r"));
}

void FastrakDriver::set_up() {
  to_say_.emplace_back(options_.centimetres ? "u" : "U");
  to_say_.emplace_back("F");           // read-backs and refusals in a known format
  to_say_.emplace_back("e1,0\r");      // the stylus switch only reports
  to_say_.emplace_back("v,1\rx,1\r");  // no filters
  to_say_.emplace_back("y0\r");
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    say('l', s, options_.stations[s] ? ",1" : ",0");
    say('R', s, "");
    say('b', s, "");
    say('r', s, ",0,0,0");
    say('N', s, ",0,0,0");  // the pose of the receiver, also where it is a stylus
    say('I', s, ",0");
    // No envelope within the unit's reach: 300 cm, where its factory one marks all beyond 200.
    say('V', s,
        options_.centimetres ? ",300,300,300,-300,-300,-300" : ",118,118,118,-118,-118,-118");
    say('Q', s, ",180,90,180,-180,-90,-180");
    // Tracking starts from the half-space it is in, so that one is set first.
    const Vec3 zenith = options_.zenith[s].stableNormalized();  // H takes two decimals
    if (zenith.isZero()) say('H', s, ",1,0,0");
    say('H', s, field(zenith.x()) + field(zenith.y()) + field(zenith.z()));
    say('O', s, list_of(options_.items));
  }
  if (baud_ != options_.baud) {
    to_say_.push_back("o" + std::to_string(options_.baud / 100).append(",N,8,0\r"));
  }
}

/// Asks for the list of the next active station, or starts the stream behind the last one.
void FastrakDriver::ask_next_list(Time now) {
  drain();
  to_say_.clear();
  while (station_asked_ < kFastrakStations && !active_[station_asked_]) ++station_asked_;
  if (station_asked_ < kFastrakStations) {
    say('O', station_asked_, "");
    enter(Phase::kLists, now);
    return;
  }
  to_say_.emplace_back(options_.binary ? "f" : "F");
  to_say_.emplace_back("C");
  const auto stations = static_cast<int>(std::count(active_.begin(), active_.end(), true));
  if (clock_) sequence_before_ += clock_->cycle() / std::max(1, stations) + 1;
  clock_.emplace(stations, byte_time(), fastrak_record_length(formats_[0]));
  in_step_ = true;
  last_record_ = now;
  enter(Phase::kStreaming, now);
}

/// One step of the bring-up, if it is due. @return whether the next one may be due as well
bool FastrakDriver::step(Time now) {
  const Time waited = now - phase_began_;
  switch (phase_) {
    case Phase::kStartingUp:
      drain();
      if (waited < options_.start_up) return false;
      try_again(now);
      return true;

    case Phase::kStopping: {
      drain();
      if (!said_all(now)) return false;
      const Time since = now - std::max(heard_, may_speak_);
      if (since < options_.quiet) {
        // A unit that talks on has not understood.
        if (waited > answer_time() + 8 * options_.quiet) {
          try_again(now);
          return true;
        }
        return false;
      }
      to_say_.emplace_back("S");
      enter(Phase::kStatus, now);
      return false;
    }

    case Phase::kStatus:
      unit_ = find_answer(buffer_, kFastrakStatusLength, decode_status);
      if (unit_) {
        drain();
        set_up();
        enter(Phase::kSettingUp, now);
        return true;
      }
      break;

    case Phase::kSettingUp:
      if (!said_all(now)) return false;
      if (baud_ != options_.baud) {
        baud_ = options_.baud;
        stream_->set_baud(baud_);
      }
      drain();
      say('l', 0, "");
      enter(Phase::kActive, now);
      return false;

    case Phase::kActive:
      if (const auto on = find_answer(buffer_, 9, decode_active)) {
        active_ = *on;
        station_asked_ = 0;
        ask_next_list(now);
        return true;
      }
      break;

    case Phase::kLists: {
      const auto decode = [&](std::string_view line) {
        return decode_list(line, static_cast<int>(station_asked_) + 1);
      };
      const auto list = find_answer(buffer_, 5 + 2 * options_.items.size(), decode);
      if (list == options_.items) {
        ++station_asked_;
        ask_next_list(now);
        return true;
      }
      break;
    }

    case Phase::kStreaming:
      if (now - last_record_ <= options_.watchdog) return false;
      ++statistics_.restarts;
      start_over(now);
      return true;
  }
  // Waiting for an answer.
  if (waited < answer_time()) return false;
  try_again(now);
  return true;
}

// --- Streaming -------------------------------------------------------------------------------

Pose FastrakDriver::pose_of(const FastrakRecord& record) const {
  Pose X_TS;
  X_TS.p = record.position * formats_[0].metre_per_unit();
  const std::vector<int>& items = options_.items;
  if (has_quaternion(items)) {
    const auto& [w, x, y, z] = record.quaternion;
    X_TS.q = Quat(w, x, y, z);
  } else if (has_matrix(items)) {
    X_TS.q = Quat(record.attitude);
  } else {
    X_TS.q = from_angles_deg(record.angles_deg);
  }
  // A record with an error letter may hold anything.
  const double norm = X_TS.q.norm();
  X_TS.q = norm > 1e-6 ? X_TS.q.normalized() : Quat::Identity();
  return X_TS;
}

void FastrakDriver::read_records(Time now) {
  // A record may be under way for its own length; after that, and three bytes, no more will come.
  const auto length = static_cast<int>(fastrak_record_length(formats_[0]));
  const bool no_more = now - heard_ > Time{100'000} + length * byte_time();
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const FastrakFound found =
        find_record(Bytes(buffer_).subspan(done), formats_, in_step_, no_more);
    statistics_.skipped_bytes += static_cast<std::int64_t>(found.skipped);
    done += found.skipped;
    if (found.length == 0) {
      in_step_ = in_step_ && found.skipped == 0;
      break;
    }
    in_step_ = true;
    if (active_[static_cast<std::size_t>(found.record.station - 1)]) {
      records_.push_back(found.record);
      record_arrivals_.push_back(arrival_of(position_ + done));
      last_record_ = now;
      attempt_ = 0;
    } else {
      statistics_.skipped_bytes += static_cast<std::int64_t>(found.length);
    }
    done += found.length;
  }
  consume(done);
}

void FastrakDriver::hand_out(Time now, std::vector<Sample>& out) {
  const auto stations =
      std::max<std::ptrdiff_t>(1, std::count(active_.begin(), active_.end(), true));
  const std::vector<Time> arrivals(record_arrivals_.begin(), record_arrivals_.end());
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    const FastrakRecord& record = records_.front();
    const auto turn = std::count(active_.begin(), active_.begin() + record.station - 1, true);
    const std::int64_t before = clock_->started() ? clock_->cycle() + 1 : turn;
    const std::optional<Time> measured =
        clock_->measured(static_cast<int>(turn), std::span(arrivals).subspan(i), now);
    if (!measured) return;
    TrackerSample sample;
    sample.device_time = *measured;
    sample.host_time = arrivals[i];
    sample.sequence = sequence_before_ + clock_->cycle() / stations;
    sample.station = record.station;
    sample.X_TS = pose_of(record);
    sample.status = record.error;
    sample.buttons = record.pressed ? 1 : 0;
    statistics_.missed += clock_->cycle() - before;
    ++statistics_.records;
    if (!sample.good()) ++statistics_.flagged;
    out.push_back(std::move(sample));
    records_.pop_front();
    record_arrivals_.pop_front();
  }
}

}  // namespace headpin::devices
