#include "study/bids_read.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scene/record/end_time.h"
#include "study/csv.h"

namespace headpin::study {

namespace {

/// A table with tabs between cells, with or without column names.
class TabRows {
 public:
  TabRows(const std::string& name, const std::string& text) : name_(name), text_(text) {}

  /// The next row's cells; false at the end.
  bool next(std::vector<std::string_view>& cells) {
    if (at_ >= text_.size()) return false;
    ++line_;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view row(text_.data() + at_, end - at_);
    at_ = end + 1;
    if (row.ends_with('\r')) row.remove_suffix(1);
    cells.clear();
    for (std::size_t begin = 0; begin <= row.size();) {
      const std::size_t tab = std::min(row.find('\t', begin), row.size());
      cells.push_back(row.substr(begin, tab - begin));
      begin = tab + 1;
    }
    return true;
  }

  [[noreturn]] void refuse(const std::string& expected, std::string_view found) const {
    throw std::invalid_argument(
        fmt::format("{}:{}: expected {}, found '{}'", name_, line_, expected, shown(found)));
  }

  template <typename T>
  T number(std::string_view cell) const {
    T value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size()) refuse("a number", cell);
    return value;
  }

  /// Reads decimal seconds, to the microsecond.
  Time time(std::string_view cell) const {
    const double value = number<double>(cell);
    if (!(std::abs(value) < 4e9)) refuse("seconds", cell);
    return microseconds(value);
  }

 private:
  const std::string& name_;
  const std::string& text_;
  std::size_t at_ = 0;
  int line_ = 0;
};

using Indexed = std::vector<std::pair<std::int64_t, devices::Sample>>;

void read_tracker(const std::string& name, const std::string& text, std::int32_t station,
                  Indexed& samples) {
  constexpr std::size_t kColumns = 17, kColumnsOnce = 14;
  TabRows rows(name, text);
  std::vector<std::string_view> cells;
  while (rows.next(cells)) {
    if (cells.size() != kColumns && cells.size() != kColumnsOnce) {
      rows.refuse(fmt::format("{} cells", kColumns), fmt::format("{}", cells.size()));
    }
    const auto number = [&](std::size_t i) { return rows.number<double>(cells[i]); };
    devices::TrackerSample s;
    s.station = station;
    s.device_time = rows.time(cells[0]);
    s.X_TS.p = Vec3(number(1), number(2), number(3));
    s.X_TS.q = Quat(number(4), number(5), number(6), number(7));
    s.sequence = rows.number<std::int64_t>(cells[8]);
    s.status = static_cast<char>(rows.number<int>(cells[9]));
    s.buttons = rows.number<std::uint8_t>(cells[10]);
    s.host_time = rows.time(cells[11]);
    s.session_time = rows.time(cells[12]);
    if (cells.size() == kColumns) {
      s.sent_time = rows.time(cells[14]);
      s.position_estimated = cells[15] == "1";
      s.orientation_estimated = cells[16] == "1";
    }
    samples.emplace_back(rows.number<std::int64_t>(cells[13]), s);
  }
}

void read_buttons(const std::string& name, const std::string& text, Indexed& samples) {
  constexpr std::size_t kColumns = 15;
  TabRows rows(name, text);
  std::vector<std::string_view> cells;
  rows.next(cells);  // names
  while (rows.next(cells)) {
    if (cells.size() != kColumns) {
      rows.refuse(fmt::format("{} cells", kColumns), fmt::format("{}", cells.size()));
    }
    if (cells[2] != "button") continue;
    devices::MouseSample s;
    s.device_time = rows.time(cells[0]);
    s.left_thumb = cells[9] == "1";
    s.right_thumb = cells[10] == "1";
    s.trigger = cells[11] == "1";
    s.host_time = rows.time(cells[12]);
    s.session_time = rows.time(cells[13]);
    samples.emplace_back(rows.number<std::int64_t>(cells[14]), s);
  }
}

/// The trial in the events' sidecar.
nlohmann::json trial_in(const std::string& name, const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_object() && json.contains("HeadpinTrial") && json["HeadpinTrial"].is_object()) {
    return json["HeadpinTrial"];
  }
  throw std::invalid_argument(name +
                              ": expected HeadpinTrial, found none: no session that headpin "
                              "wrote");
}

bool is_tracker_table(const std::string& name) {
  return name.ends_with("_motion.tsv") && name.find("_tracksys-simulated_") == std::string::npos;
}

/// The tracking system that a table is of, from its name.
std::string system_in(const std::string& name) {
  const std::size_t begin = name.find("_tracksys-") + 10;
  return name.substr(begin, name.find('_', begin) - begin);
}

/// The station of a tracking system, from the name of its table.
/// @param stations  by system, of the trial; of an older version it has none
std::int32_t station_in(const std::string& name, const nlohmann::json& stations) {
  const std::string system = system_in(name);
  if (stations.is_object() && stations.contains(system)) {
    const nlohmann::json& station = stations[system];
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    if (station.is_number_unsigned() && station >= 1 && station <= kMost) {
      return station.get<std::int32_t>();
    }
    throw std::invalid_argument(fmt::format(
        "{}: expected a station from 1 for {} in HeadpinTrial of the events, found {}", name,
        system, shown(station.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))));
  }
  if (system == "head") return devices::kHeadStation;
  if (system == "hand") return devices::kHandStation;
  if (system == "lefthand") return devices::kLeftHandStation;
  const auto station = system.starts_with("station") ? whole_in(system.substr(7)) : std::nullopt;
  if (station) return *station;
  throw std::invalid_argument(fmt::format(
      "{}: expected a tracking system called head, hand, lefthand or station and a number", name));
}

scene::TrialHeader header_of(const nlohmann::json& trial) {
  const auto text = [&](const char* key) {
    return trial.contains(key) && trial[key].is_string() ? trial[key].get<std::string>()
                                                         : std::string();
  };
  scene::TrialHeader header;
  header.participant = text("participant");
  header.condition = text("condition");
  header.scenario = text("scenario");
  const std::string seed = text("seed");
  std::from_chars(seed.data(), seed.data() + seed.size(), header.seed);
  return header;
}

Time end_of(const nlohmann::json& trial, const std::string& name) {
  const auto end = trial.find("end_s");
  if (end == trial.end() || !end->is_number()) return Time{};  // an older one
  return scene::end_time(end->get<double>(), name);
}

/// The number of samples of the session, of trackers and buttons; nothing for an older one.
std::optional<std::int64_t> count_in(const nlohmann::json& trial, const std::string& name) {
  const auto samples = trial.find("samples");
  if (samples == trial.end()) return std::nullopt;
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  if (samples->is_number_unsigned() && samples->get<std::uint64_t>() <= kMost) {
    return samples->get<std::int64_t>();
  }
  throw std::invalid_argument(
      fmt::format("{}: samples: expected their number, found {}", name,
                  shown(samples->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))));
}

/// Throws unless there is a table for each tracking system of the trial.
/// @param stations  by system
void require_tables(const std::string& where, const nlohmann::json& stations,
                    const std::map<std::string, std::string>& texts) {
  if (!stations.is_object()) return;
  std::set<std::string> systems;
  for (const auto& [name, text] : texts) {
    if (is_tracker_table(name)) systems.insert(system_in(name));
  }
  for (const auto& one : stations.items()) {
    if (systems.contains(one.key())) continue;
    throw std::invalid_argument(fmt::format(
        "{}: expected a table of tracksys-{}, found none: a session is read with all of its tables",
        where, shown(one.key())));
  }
}

/// Throws unless the samples have all places of the log, each once.
/// @param samples  by place
/// @param count    as many as the session has; nothing if unknown
void require_whole(const std::string& where, const Indexed& samples,
                   std::optional<std::int64_t> count) {
  constexpr std::size_t kShown = 3;
  std::vector<std::int64_t> missing;
  std::int64_t next = 0;
  const auto miss_until = [&](std::int64_t place) {
    for (; next < place && missing.size() <= kShown; ++next) missing.push_back(next);
  };
  for (const auto& [index, sample] : samples) {
    if (index < next) {
      throw std::invalid_argument(
          fmt::format("{}: expected every log_index from 0 on once, found {}{}", where, index,
                      index < 0 ? "" : " twice"));
    }
    if (count && index >= *count) {
      throw std::invalid_argument(
          fmt::format("{}: expected {} samples, found one of log_index {}", where, *count, index));
    }
    miss_until(index);
    if (missing.size() > kShown) break;
    next = index + 1;
  }
  if (count) miss_until(*count);
  if (missing.empty()) return;
  const bool more = missing.size() > kShown;
  if (more) missing.pop_back();
  throw std::invalid_argument(
      fmt::format("{}: samples {}{} missing: a session is read with every row of all of its tables",
                  where, fmt::join(missing, ", "), more ? ", ..." : ""));
}

}  // namespace

BidsTrial session_of(const std::map<std::string, std::string>& texts) {
  BidsTrial trial;
  nlohmann::json stations;
  std::optional<std::int64_t> count;
  for (const auto& [name, text] : texts) {
    if (!name.ends_with("_events.json")) continue;
    const nlohmann::json its = trial_in(name, text);
    trial.header = header_of(its);
    trial.end = end_of(its, name);
    count = count_in(its, name);
    if (its.contains("stations")) stations = its["stations"];
    require_tables(name, stations, texts);
  }
  Indexed samples;
  for (const auto& [name, text] : texts) {
    if (name.ends_with("_events.tsv")) read_buttons(name, text, samples);
    if (is_tracker_table(name)) read_tracker(name, text, station_in(name, stations), samples);
  }
  if (samples.empty()) throw std::invalid_argument("no samples of a tracker");
  std::ranges::stable_sort(samples, {}, &std::pair<std::int64_t, devices::Sample>::first);
  require_whole(texts.begin()->first, samples, count);
  for (auto& [index, sample] : samples) trial.samples.push_back(std::move(sample));
  return trial;
}

}  // namespace headpin::study
