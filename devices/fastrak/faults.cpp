#include "devices/fastrak/faults.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "devices/base/text.h"

namespace headpin::devices {
namespace {

[[noreturn]] void refuse(std::string_view entry, const std::string& expected) {
  throw std::invalid_argument("fault '" + std::string(entry) + "': expected " + expected);
}

double number(std::string_view entry, std::string_view text, double low, double high,
              const std::string& expected) {
  double value = 0.0;
  const auto end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc{} || read.ptr != end || !(value >= low && value <= high)) {
    refuse(entry, expected);
  }
  return value;
}

constexpr double kLongest = 1e6;  // s: eleven days

Time at(std::string_view entry, std::string_view text, const std::string& expected) {
  return microseconds(number(entry, text, 0.0, kLongest, expected));
}

StationFault station_fault(std::string_view entry, std::string_view value) {
  const std::string expected = "STATION@FROM[-TO], station 1 to 4, seconds";
  const std::size_t mark = value.find('@');
  if (mark == std::string_view::npos) refuse(entry, expected);
  StationFault fault;
  const double station = number(entry, value.substr(0, mark), 1, 4, expected);
  if (station != std::floor(station)) refuse(entry, expected);
  fault.station = static_cast<int>(station);
  const std::string_view when = value.substr(mark + 1);
  const std::size_t dash = when.find('-');
  fault.when.from = at(entry, when.substr(0, dash), expected);
  if (dash != std::string_view::npos) {
    fault.when.to = at(entry, when.substr(dash + 1), expected);
    if (fault.when.to <= fault.when.from) {
      throw std::invalid_argument(
          "fault '" + std::string(entry) + "': it ends " +
          (fault.when.to < fault.when.from ? "before" : "when") +
          " it begins; expected STATION@FROM-TO with TO later than FROM, seconds");
    }
  }
  return fault;
}

FaultWindow silence(std::string_view entry, std::string_view value) {
  const std::string expected = "SECONDS@FROM";
  const std::size_t mark = value.find('@');
  if (mark == std::string_view::npos) refuse(entry, expected);
  const Time from = at(entry, value.substr(mark + 1), expected);
  return {from, from + at(entry, value.substr(0, mark), expected)};
}

}  // namespace

FastrakFaults parse_faults(const std::string& spec) {
  FastrakFaults faults;
  std::set<std::string_view> given;
  std::string_view rest = spec;
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view entry = without_spaces(rest.substr(0, comma));
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    const std::size_t equals = entry.find('=');
    const std::string_view name = entry.substr(0, equals);
    if (equals == std::string_view::npos) refuse(entry, "NAME=VALUE");
    const std::string_view value = entry.substr(equals + 1);
    const auto whole = [&](double low, double high, const std::string& expected) {
      const double v = number(entry, value, low, high, expected);
      if (v != std::floor(v)) refuse(entry, expected);
      return static_cast<int>(v);
    };
    const bool may_repeat = name == "stuck" || name == "unplug" || name == "silence";
    if (!may_repeat && !given.insert(name).second) refuse(entry, fmt::format("{} once", name));
    if (name == "noise") {
      faults.noise = number(entry, value, 0.0, 1e6, "a factor from 0 to 1000000");
    } else if (name == "dropout") {
      faults.dropout = number(entry, value, 0.0, 1.0, "a chance from 0 to 1");
    } else if (name == "garbage") {
      faults.garbage = number(entry, value, 0.0, 1.0, "a chance from 0 to 1");
    } else if (name == "damage") {
      faults.damage = number(entry, value, 0.0, 1.0, "a chance from 0 to 1");
    } else if (name == "metal") {
      faults.metal = number(entry, value, 0.0, 1.0, "metres at 1 m, from 0 to 1");
    } else if (name == "slow") {
      faults.slow_baud = whole(110, 115200, "a baud rate from 110 to 115200");
    } else if (name == "deaf") {
      faults.deaf =
          whole(0, std::numeric_limits<int>::max(), "a whole number from 0 to 2147483647");
    } else if (name == "stuck") {
      faults.stuck.push_back(station_fault(entry, value));
    } else if (name == "unplug") {
      faults.unplugged.push_back(station_fault(entry, value));
    } else if (name == "silence") {
      faults.silence.push_back(silence(entry, value));
    } else {
      refuse(entry,
             "one of noise, dropout, garbage, damage, metal, slow, deaf, stuck, unplug, silence");
    }
  }
  return faults;
}

void check_stations(const FastrakFaults& faults, int receivers) {
  for (const auto* list : {&faults.stuck, &faults.unplugged}) {
    for (const StationFault& fault : *list) {
      if (fault.station <= receivers) continue;
      throw std::invalid_argument(fmt::format("fault '{}={}@...': expected a station from 1 to {}",
                                              list == &faults.stuck ? "stuck" : "unplug",
                                              fault.station, receivers));
    }
  }
}

std::string faults_help() {
  return "noise=F        noise, F times that of a real unit; 0: exact poses\n"
         "dropout=P      probability that a whole record is lost\n"
         "garbage=P      probability of 1 to 8 random bytes before a record\n"
         "damage=P       probability that one bit of a record is flipped\n"
         "metal=M        distortion by metal nearby: poses are wrong by M metres at 1 m\n"
         "slow=BAUD      the line is not faster than this baud rate\n"
         "deaf=N         the unit does not answer the first N status requests, nor those after\n"
         "               a power cycle\n"
         "stuck=S@A-B    station S repeats one pose from second A to B (or for good)\n"
         "unplug=S@A-B   receiver S is unplugged from second A to B (or for good)\n"
         "silence=T@A    the unit neither receives nor sends for T seconds from second A\n";
}

Pose distort(const Pose& X_TS, double metal) {
  if (metal == 0.0) return X_TS;
  const double range = X_TS.p.norm();
  if (range < 1e-9) return X_TS;
  const Vec3 direction = X_TS.p / range;
  const double amount = metal * range * range;
  // The error is sideways: the direction with its components rotated, which is smooth everywhere.
  const Vec3 sideways(direction.y(), direction.z(), direction.x());
  return {rotation(amount * sideways) * X_TS.q, X_TS.p + amount * sideways};
}

}  // namespace headpin::devices
