#include "devices/fastrak/driver.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "devices/fastrak/geometry.h"

namespace headpin::devices {
namespace {

/// Longest pause within a record on a busy machine; the kernel's terminal took 0.8 s.
constexpr Time kHeldUp{1'000'000};
constexpr std::size_t kBufferLimit = 1 << 16;  // bytes; a unit sends 1 % of that in a second

}  // namespace

FastrakDriver::FastrakDriver(std::unique_ptr<ByteStream> stream, Clocks& clocks,
                             FastrakOptions options)
    : stream_(std::move(stream)),
      options_(std::move(options)),
      baud_(options_.baud),
      clocks_(clocks),
      cycles_(clocks.add()) {
  check_items(options_.items);
  formats_.fill({options_.items, options_.binary, options_.centimetres});
}

std::string FastrakDriver::activity() const {
  if (const std::string trouble = stream_->trouble(); !trouble.empty()) return trouble;
  if (lost_) return "about to start it again";
  const std::string rate = stream_->has_baud() ? ", " + std::to_string(baud_) + " baud" : "";
  const std::string attempt = " (attempt " + std::to_string(attempt_ + 1) + rate + ")";
  switch (phase_) {
    case Phase::stopping:
      return "stopping what it was doing" + attempt;
    case Phase::starting_up:
      return "waiting for it to start up" + attempt;
    case Phase::status:
      return "asking for its status" + attempt;
    case Phase::setting_up:
      return "setting it up";
    case Phase::active:
    case Phase::checking:
      return "checking its set-up";
    case Phase::streaming:
      return "streaming";
  }
  return "";
}

void FastrakDriver::poll(Time asked, std::vector<Sample>& out) {
  // A late session asks for a time in the past. The time of the line shows how long the unit has
  // been silent.
  const Time now = hear(asked);
  const bool lost = !stream_->trouble().empty();
  if (!begun_ || (lost_ && !lost)) start_over(now);
  begun_ = true;
  lost_ = lost;
  if (lost) return;
  while (step(now)) {
  }
  if (phase_ == Phase::streaming) {
    read_records(now);
    hand_out(now, out);
  }
  speak(now);
}

// --- The line --------------------------------------------------------------------------------

/// Reads what has arrived. @return  the time of the line
Time FastrakDriver::hear(Time asked) {
  std::array<std::uint8_t, 4096> bytes{};
  const std::size_t before = buffer_.size();
  Time now = asked;
  while (buffer_.size() < kBufferLimit) {
    const ByteStream::Piece piece = stream_->read_at(asked, bytes);
    now = piece.arrived;
    if (piece.size == 0) break;
    arrivals_.push_back({position_ + buffer_.size(), piece.arrived});
    buffer_.insert(buffer_.end(), bytes.begin(),
                   bytes.begin() + static_cast<std::ptrdiff_t>(piece.size));
  }
  if (buffer_.size() > before) heard_ = now;
  return now;
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
  to_say_.clear();
  may_speak_ = now;
  // Rounds of eight attempts: stop the unit, end a half-typed line, re-initialise it, then repeat
  // with longer waits. From the second round on, use the other rates in turn, two attempts each.
  const int place = attempt_ % 8;
  if (options_.search_baud && stream_->has_baud() && attempt_ >= 8) {
    // Downwards from the unit's own rate, repeatedly.
    const auto own = std::find(kFastrakBauds.rbegin(), kFastrakBauds.rend(), options_.baud) -
                     kFastrakBauds.rbegin();
    const auto rate = static_cast<std::size_t>(own + attempt_ / 2 - 4) % kFastrakBauds.size();
    baud_ = kFastrakBauds.rbegin()[static_cast<std::ptrdiff_t>(rate)];
  } else {
    baud_ = options_.baud;
  }
  stream_->set_baud(baud_);
  if (place == 2 && baud_ == options_.baud) {
    to_say_.push_back({'\r', kFastrakReinitialise});
    enter(Phase::starting_up, now);
    return;
  }
  to_say_.push_back(place % 2 == 1 ? std::string{kFastrakResume, '\r', 'c'}
                                   : std::string{kFastrakResume, 'c'});
  enter(Phase::stopping, now);
}

void FastrakDriver::say(std::vector<std::string> commands) {
  std::ranges::move(commands, std::back_inserter(to_say_));
}

/// Sends the next check, or starts the stream after the last one.
void FastrakDriver::ask_next(Time now) {
  drain();
  to_say_.clear();
  if (checks_.empty()) {
    start_stream(now);
  } else {
    say({question(checks_.front())});
    enter(Phase::checking, now);
  }
}

void FastrakDriver::start_stream(Time now) {
  say(stream_commands(options_));
  const auto stations = static_cast<int>(std::count(active_.begin(), active_.end(), true));
  sequence_before_ = next_sequence_;
  clock_.emplace(stations, byte_time(), fastrak_record_length(formats_[0]), clocks_, cycles_);
  in_step_ = true;
  records_.clear();  // of the stream before, whose clock is gone
  last_record_ = now;
  enter(Phase::streaming, now);
}

/// Waits until the unit is silent, then asks for its status.
bool FastrakDriver::stop(Time now) {
  drain();
  if (!said_all(now)) return false;
  if (now - std::max(heard_, may_speak_) >= options_.quiet) {
    say({"S"});
    enter(Phase::status, now);
    return false;
  }
  // A unit that continues to send has not understood the command.
  const bool talks_on = now - phase_began_ > answer_time() + 8 * options_.quiet;
  if (talks_on) try_again(now);
  return talks_on;
}

/// Examines the answer to the current check.
/// @return  as step(); nothing if the set-up is not what the records need
std::optional<bool> FastrakDriver::check(Time now) {
  const FastrakCheck& check = checks_.front();
  const FastrakVerdict verdict = judge(check, options_, buffer_);
  const bool silent = verdict == FastrakVerdict::no_answer;
  if (silent && now - phase_began_ < answer_time()) return false;
  if (verdict != FastrakVerdict::as_said) {
    if (check.must) return std::nullopt;
    unconfirmed_.push_back(question(check).substr(0, 2) +
                           (silent ? ": no answer" : ": set, and reads otherwise"));
  }
  checks_.pop_front();
  ask_next(now);
  return true;
}

/// Sets the unit up after it has sent its status. @return whether it has sent it
bool FastrakDriver::set_up(Time now) {
  // A unit left at seven bits sends parity in the eighth.
  std::vector<std::uint8_t> seven_bits = buffer_;
  for (std::uint8_t& byte : seven_bits) byte &= 0x7F;
  unit_ = find_answer(seven_bits, kFastrakStatusLength, decode_status);
  if (!unit_) return false;
  say(setup_commands(options_));
  if (baud_ != options_.baud) {
    say({std::string("o").append(std::to_string(options_.baud / 100)).append(",N,8,0\r")});
  }
  enter(Phase::setting_up, now);
  return true;
}

/// Begins to read the settings back after the unit has reported its active stations. @return
/// whether it has reported them
bool FastrakDriver::begin_checks(Time now) {
  const auto on = find_answer(buffer_, 9, decode_active);
  if (!on) return false;
  active_ = *on;
  checks_ = {{}};  // settings of the unit itself
  unconfirmed_.clear();
  for (int station = kFastrakStations; station >= 1; --station) {
    if (!active_[static_cast<std::size_t>(station - 1)]) continue;
    const std::vector<FastrakCheck> own = setup_checks(options_, station);
    checks_.insert(checks_.begin(), own.begin(), own.end());
  }
  ask_next(now);
  return true;
}

/// One step of the bring-up, if it is due. @return whether the next one may be due as well
bool FastrakDriver::step(Time now) {
  const Time waited = now - phase_began_;
  switch (phase_) {
    case Phase::starting_up:
      drain();
      if (waited < options_.start_up) return false;
      try_again(now);
      return true;

    case Phase::stopping:
      return stop(now);

    case Phase::status:
      if (set_up(now)) return true;
      break;

    case Phase::setting_up:
      if (!said_all(now)) return false;
      if (baud_ != options_.baud) {
        baud_ = options_.baud;
        stream_->set_baud(baud_);
      }
      drain();
      say({"l1\r"});
      enter(Phase::active, now);
      return false;

    case Phase::active:
      if (begin_checks(now)) return true;
      break;

    case Phase::checking:
      if (const auto more = check(now)) return *more;
      break;

    case Phase::streaming:
      if (now - last_record_ > options_.watchdog) read_records(now);  // a late poll: some may wait
      if (now - last_record_ <= options_.watchdog) return false;
      ++statistics_.restarts;
      start_over(now);
      return true;
  }
  // The answer is still missing, or it was a different one.
  if (waited < answer_time() && phase_ != Phase::checking) return false;
  try_again(now);
  return true;
}

// --- Streaming -------------------------------------------------------------------------------

void FastrakDriver::read_records(Time now) {
  // A record may still arrive for the time of its length. After that and a pause, no more bytes
  // come.
  const auto length = static_cast<int>(fastrak_record_length(formats_[0]));
  const bool no_more = now - heard_ > kHeldUp + length * byte_time();
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
      records_.push_back({found.record, arrival_of(position_ + done)});
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
  std::vector<Time> arrivals;
  std::ranges::transform(records_, std::back_inserter(arrivals), &Heard::arrived);
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    const FastrakRecord& record = records_.front().record;
    const auto turn = std::count(active_.begin(), active_.begin() + record.station - 1, true);
    const std::int64_t before = clock_->started() ? clock_->record() + 1 : turn;
    const std::optional<Time> measured =
        clock_->measured(static_cast<int>(turn), std::span(arrivals).subspan(i), now);
    if (!measured) return;
    TrackerSample sample;
    sample.device_time = *measured;
    sample.host_time = arrivals[i];
    sample.sequence = sequence_before_ + clock_->record() / stations;
    next_sequence_ = sample.sequence + 1;
    sample.station = record.station;
    sample.X_TS = pose_of(record, formats_[0]);
    sample.status = record.error;
    sample.buttons = record.pressed ? 1 : 0;
    statistics_.missed += clock_->record() - before;
    ++statistics_.records;
    if (!sample.good()) ++statistics_.flagged;
    out.push_back(std::move(sample));
    records_.pop_front();
  }
}

}  // namespace headpin::devices
