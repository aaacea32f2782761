#include <algorithm>
#include <charconv>
#include <utility>

#include "devices/fastrak/emulator.h"

// Input from the line: bytes, control characters, immediate commands and line commands.
namespace headpin::devices {
namespace {

constexpr std::size_t kLongestLine = 254;  // bytes
constexpr std::size_t kHeldLimit = 1024;   // bytes of commands waiting for ^K
constexpr std::string_view kImmediate = "PCcSFfUuDdW";

}  // namespace

void FastrakEmulator::hear_all(Bytes bytes, Time now) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (silent(now)) return;
    if (now < saved_at_) {
      const std::size_t room = kHeldLimit - std::min(kHeldLimit, held_.size());
      const Bytes rest = bytes.subspan(i, std::min(room, bytes.size() - i));
      held_.insert(held_.end(), rest.begin(), rest.end());
      return;
    }
    hear(memory_.port.bits == 7 ? bytes[i] & 0x7F : bytes[i], now);
  }
}

void FastrakEmulator::hear(std::uint8_t byte, Time now) {
  if (control(byte, now)) return;
  const Swallow swallow = std::exchange(swallow_, Swallow::nothing);
  const char c = static_cast<char>(byte);
  if (c == '\r' || c == '\n') {
    const bool cr = c == '\r';
    if (!line_.empty()) {
      run_line(now);
      line_.clear();
    } else if (swallow == (cr ? Swallow::carriage_return : Swallow::line_feed)) {
      return;  // the second half of CR LF or LF CR
    } else if (cr && swallow != Swallow::any_end) {
      refuse("", FastrakRefusal::unknown_command, 0, 0, 1, now);
    }
    swallow_ = cr ? Swallow::line_feed : Swallow::carriage_return;
  } else if (!line_.empty()) {
    if (line_.size() <= kLongestLine) line_ += c;  // one more than allowed marks it as too long
  } else if (kImmediate.find(c) != std::string_view::npos) {
    immediate(c, now);
    swallow_ = Swallow::any_end;
  } else if (is_fastrak_line_command(c)) {
    line_ = c;
  } else if (c != ' ') {
    refuse(std::string_view(&c, 1), FastrakRefusal::unknown_command, 0, 0, 1, now);
    swallow_ = Swallow::any_end;
  }
}

/// Control bytes act at once, also in the middle of a line, which continues after them.
bool FastrakEmulator::control(std::uint8_t byte, Time now) {
  switch (byte) {
    case 0x0B:  // ^K
      eeprom_ = memory_.setup;
      for (FastrakStationSetup& station : eeprom_.stations) {
        station.q_boresight.reset();
      }
      for (std::size_t s = 0; s < kFastrakStations; ++s) {
        eeprom_.stations[s].p_SN = factory_setup(now).stations[s].p_SN;
      }
      if (eeprom_.sync == 1) eeprom_.sync = 0;
      saved_at_ = now + options_.save_time;
      break;
    case kFastrakResume:
      if (suspended_) line_free_ns_ = std::max<std::int64_t>(line_free_ns_, now.count() * 1000);
      suspended_ = false;
      break;
    case kFastrakSuspend:
      suspended_ = true;
      break;
    case kFastrakReinitialise:
      start_up(now);
      break;
    default:
      return false;
  }
  if (line_.empty()) swallow_ = Swallow::any_end;
  ++statistics_.commands;
  return true;
}

void FastrakEmulator::immediate(char command, Time now) {
  ++statistics_.commands;
  switch (command) {
    case 'P':
      send_point(now);
      break;
    case 'C':
      ++statistics_.streams;
      if (!memory_.setup.continuous) expected_.reset();
      memory_.setup.continuous = true;
      switched_off_ = false;
      if (const auto station = expected_ ? expected_ : next_active(kFastrakStations - 1)) {
        stream_zero_ = *next_measured(static_cast<int>(*station) + 1, Time{});
      }
      break;
    case 'c':
      memory_.setup.continuous = false;
      switched_off_ = false;
      std::erase_if(queue_, [](const Message& m) { return m.stream && m.sent == 0; });
      break;
    case 'S': {
      if (++status_requests_ <= options_.faults.deaf) break;
      FastrakStatus status;
      status.binary = memory_.setup.binary;
      status.centimetres = memory_.setup.centimetres;
      status.compensation = memory_.setup.compensation;
      status.continuous = memory_.setup.continuous;
      status.error = memory_.error;
      status.firmware = options_.firmware;
      status.identification = memory_.setup.identification;
      if (options_.tag_2012) {
        // The coding of the sensor map is not known. Our choice: one hex digit, bit 0 for station
        // 1.
        int map = 0;
        for (std::size_t s = 0; s < kFastrakStations; ++s) map |= plugged(s, now) ? 1 << s : 0;
        status.tag = std::string("F3") + "0123456789ABCDEF"[map];
      }
      reply(encode_status(status), now);
      break;
    }
    case 'F':
      memory_.setup.binary = false;
      break;
    case 'f':
      memory_.setup.binary = true;
      break;
    case 'U':
      memory_.setup.centimetres = false;
      break;
    case 'u':
      memory_.setup.centimetres = true;
      break;
    case 'D':
      memory_.setup.compensation = true;
      break;
    case 'd':
      memory_.setup.compensation = false;
      break;
    case 'W':
      memory_.setup = factory_setup(now);
      std::erase_if(queue_, [](const Message& m) { return m.stream && m.sent == 0; });
      break;
    default:
      break;
  }
}

void FastrakEmulator::refuse(std::string_view command, FastrakRefusal why, std::size_t position,
                             std::size_t field, int station, Time now) {
  ++statistics_.refused;
  if (!memory_.setup.binary) reply(encode_refusal(command, why, position, field, station), now);
}

void FastrakEmulator::run_line(Time now) {
  if (line_.size() > kLongestLine) {
    refuse(line_, FastrakRefusal::buffer_limit, kLongestLine, 0, 1, now);
    return;
  }
  commanded_ = now;
  try {
    const std::string answer = carry_out(line_, memory_);
    if (!answer.empty()) reply(answer, now);
    ++statistics_.commands;
  } catch (const FastrakRefused& refused) {
    refuse(line_, refused.why, refused.position, refused.field, refused.station, now);
  }
  for (std::size_t s = 0; s < kFastrakStations; ++s) {
    if (!active(s)) solutions_[s].valid = false;
  }
}

void FastrakEmulator::point_of_alignment(Time now) {
  if (!solutions_[0].valid) measure(0, now);
  memory_.guided->push_back(solutions_[0].X_TS * memory_.setup.stations[0].p_SN);
  if (memory_.guided->size() < 3) return;
  const std::array<Vec3, 3> points = {(*memory_.guided)[0], (*memory_.guided)[1],
                                      (*memory_.guided)[2]};
  memory_.guided.reset();
  for (FastrakStationSetup& station : memory_.setup.stations) {
    if (!align(station, points)) {
      refuse("A0", FastrakRefusal::out_of_range, 1, 0, 1, now);
      return;
    }
  }
  reply(alignment_answer(memory_, 0), now);  // shows the new frame
}

}  // namespace headpin::devices
