#include "study/trial_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "devices/base/sources.h"
#include "scene/record/end_time.h"
#include "scene/record/outside.h"
#include "scene/record/tables.h"
#include "study/csv.h"

namespace headpin::study {

namespace {

constexpr std::array kRequired = {
    "device_time_s", "station", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};

/// The rows of a table, one at a time, by the names of the columns.
class TableCells {
 public:
  explicit TableCells(const CsvTable& table) : table_(table) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) places_[table.columns[i]] = i;
  }

  void go_to(const CsvRow& row) { row_ = &row; }

  /// A cell; nothing if there is no such column or it is empty.
  const std::string* find(const char* column) const {
    const auto place = places_.find(column);
    if (place == places_.end() || row_->cells[place->second].empty()) return nullptr;
    return &row_->cells[place->second];
  }
  const std::string& text(const char* column) const {
    if (const std::string* cell = find(column)) return *cell;
    table_.require(column);
    fail(column, "a value");
  }
  double number(const char* column) const {
    const auto value = number_in(table_, text(column));
    if (!value || !std::isfinite(*value)) fail(column, "a number");
    return *value;
  }
  double number(const char* column, double otherwise) const {
    return find(column) ? number(column) : otherwise;
  }
  std::int64_t whole(const char* column) const {
    const double value = number(column);
    if (std::abs(value) > 9e15 || value != std::round(value)) fail(column, "a whole number");
    return static_cast<std::int64_t>(value);
  }
  std::int64_t whole(const char* column, std::int64_t otherwise) const {
    return find(column) ? whole(column) : otherwise;
  }
  /// Decimal seconds, to the microsecond.
  Time time(const char* column) const {
    const double value = number(column);
    if (!(std::abs(value) < 4e9)) fail(column, "seconds");
    return microseconds(value);
  }
  Time time(const char* column, Time otherwise) const {
    return find(column) ? time(column) : otherwise;
  }
  /// 1 or 0; programs also write True and False.
  bool yes(const char* column) const {
    const std::string* cell = find(column);
    if (!cell || *cell == "False" || *cell == "FALSE") return false;
    if (*cell == "True" || *cell == "TRUE") return true;
    const auto value = number_in(table_, *cell);
    if (value && (*value == 0.0 || *value == 1.0)) return *value == 1.0;
    fail(column, "1 or 0");
  }

  [[noreturn]] void fail(const char* column, const std::string& expected) const {
    refuse_cell(table_, *row_, column, expected);
  }

 private:
  const CsvTable& table_;
  std::map<std::string, std::size_t, std::less<>> places_;
  const CsvRow* row_ = nullptr;
};

/// A rotation. What programs have averaged or rounded becomes a unit quaternion again; else its bits stay.
Quat rotation_at(const TableCells& row, std::int64_t& lengthened) {
  constexpr double kRounded = 1e-3, kAveraged = 0.3;
  Quat q(row.number("qw"), row.number("qx"), row.number("qy"), row.number("qz"));
  const double off = std::abs(q.norm() - 1.0);
  if (off <= kRounded) return q;
  if (off > kAveraged) row.fail("qw", fmt::format("a unit quaternion (found {} long)", q.norm()));
  ++lengthened;
  return q.normalized();
}

void take_trackers(const CsvTable& table, TablesTrial& trial) {
  TableCells row(table);
  std::map<std::int32_t, std::int64_t> next_sequence;
  std::int64_t lengthened = 0;
  for (const CsvRow& cells : table.rows) {
    row.go_to(cells);
    devices::TrackerSample s;
    const std::int64_t station = row.whole("station");
    if (!std::in_range<std::int32_t>(station)) row.fail("station", "a whole number of 32 bits");
    s.station = static_cast<std::int32_t>(station);
    s.device_time = row.time("device_time_s");
    s.host_time = row.time("host_time_s", Time{});
    s.sequence = row.whole("sequence", next_sequence[s.station]);
    next_sequence[s.station] = s.sequence + 1;
    // R and spreadsheets write T as TRUE, and nothing as NA.
    if (const std::string* frame = row.find("frame");
        frame && *frame != "T" && *frame != "TRUE" && *frame != "True" && *frame != "NA") {
      row.fail("frame", "T, the transmitter's");
    }
    s.X_TS = {rotation_at(row, lengthened),
              {row.number("x_m"), row.number("y_m"), row.number("z_m")}};
    if (const std::string* status = row.find("status"); status && *status != "NA") {
      if (status->size() != 1) row.fail("status", "one letter, or nothing");
      s.status = status->front();
    }
    s.buttons = row.yes("stylus") ? 1 : 0;
    s.sent_time = row.time("sent_time_s", Time{});
    s.position_estimated = row.yes("position_estimated");
    s.orientation_estimated = row.yes("orientation_estimated");
    s.session_time = row.time("session_time_s", Time{});
    trial.samples.emplace_back(s);
  }
  if (lengthened > 0) {
    trial.notes.push_back(
        fmt::format("{} rotations were no unit quaternions, and are made so", lengthened));
  }
}

void take_buttons(const CsvTable& table, TablesTrial& trial) {
  TableCells row(table);
  for (const CsvRow& cells : table.rows) {
    row.go_to(cells);
    devices::MouseSample s;
    s.device_time = row.time("device_time_s");
    s.host_time = row.time("host_time_s", Time{});
    s.left_thumb = row.yes("left_thumb");
    s.right_thumb = row.yes("right_thumb");
    s.trigger = row.yes("trigger");
    s.session_time = row.time("session_time_s", Time{});
    trial.samples.emplace_back(s);
  }
}

void take_events(const CsvTable& table, TablesTrial& trial) {
  TableCells row(table);
  for (const CsvRow& cells : table.rows) {
    row.go_to(cells);
    const auto text = [&](const char* column) {
      const std::string* cell = row.find(column);
      return cell ? *cell : std::string();
    };
    if (!scene::is_outside(row.whole("tick", -1), text("kind"))) continue;
    scene::Event event;
    event.time = row.time("time_s");
    event.kind = row.text("kind");
    event.bodies = scene::bodies_in(text("bodies"));
    event.p_W = {row.number("x_m", 0.0), row.number("y_m", 0.0), row.number("z_m", 0.0)};
    event.j_W = {row.number("impulse_x_ns", 0.0), row.number("impulse_y_ns", 0.0),
                 row.number("impulse_z_ns", 0.0)};
    event.value = row.number("value", 0.0);
    event.detail = scene::Detail::read(event.kind, text("detail"));
    trial.events.push_back(std::move(event));
  }
}

/// Takes what trial.json says; what it does not say stays as it is.
void take_header(const std::string& text, const std::string& where, TablesTrial& trial) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw std::invalid_argument(where + ": expected a JSON object");
  }
  const auto word = [&](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  trial.header.participant = word("participant");
  trial.header.condition = word("condition");
  const auto seed = json.find("seed");
  if (seed != json.end() && seed->is_number_unsigned()) {
    trial.header.seed = seed->get<std::uint64_t>();
  }
  const auto complete = json.find("complete");
  trial.complete = complete == json.end() || !complete->is_boolean() || complete->get<bool>();
  const auto end = json.find("end_s");
  if (end == json.end() || !end->is_number()) return;
  trial.end = scene::end_time(end->get<double>(), where);
}

}  // namespace

bool is_trackers_table(const std::string& first_line) {
  try {
    const CsvTable table = parse_csv(first_line, "");
    return std::ranges::all_of(kRequired,
                               [&](const char* column) { return table.find(column).has_value(); });
  } catch (const std::invalid_argument&) {
    return false;
  }
}

TablesTrial trial_of_tables(const TrialTexts& texts, const std::string& folder) {
  const auto in_folder = [&](const char* name) { return folder + "/" + name; };
  TablesTrial trial;
  if (texts.header) take_header(*texts.header, in_folder("trial.json"), trial);
  if (!texts.scenario) {
    throw std::invalid_argument(in_folder("scenario.toml") +
                                ": expected the scenario of the trial, found no file");
  }
  trial.header.scenario = *texts.scenario;
  take_trackers(parse_csv(texts.trackers, in_folder("trackers.csv")), trial);
  if (trial.samples.empty()) {
    throw std::invalid_argument(in_folder("trackers.csv") + ": expected samples, found none");
  }
  if (texts.buttons) take_buttons(parse_csv(*texts.buttons, in_folder("buttons.csv")), trial);
  if (texts.events) take_events(parse_csv(*texts.events, in_folder("events.csv")), trial);
  std::ranges::stable_sort(trial.samples, {}, devices::available);
  return trial;
}

}  // namespace headpin::study
