#include "scene/record/tables.h"

#include <functional>
#include <ostream>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/base/sources.h"
#include "devices/log/sample_messages.h"
#include "scene/record/table_fields.h"

namespace headpin::scene {

namespace {

std::string csv_quoted(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string decimal_seconds(Time time) {
  const std::int64_t us = time.count();
  return fmt::format("{}{}.{:06}", us < 0 ? "-" : "", std::abs(us) / 1'000'000,
                     std::abs(us) % 1'000'000);
}

/// A value as a field of CSV; empty if it is not known.
struct CsvText {
  std::string operator()(std::monostate) const { return {}; }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(std::uint64_t hash) const { return fmt::format("{:016x}", hash); }
  std::string operator()(bool yes) const { return yes ? "1" : "0"; }
  std::string operator()(Time time) const { return decimal_seconds(time); }
  std::string operator()(const std::string& text) const { return csv_quoted(text); }
};

/// A sample, and the place of the tracked space when it was used.
struct TrackerRow {
  const devices::TrackerSample& sample;
  std::optional<Vec3> p_WP;
};

/// One body after one tick.
struct StateRow {
  const TickState& tick;
  const BodyState& body;
  std::string_view name;
};

/// One eye of one frame.
struct EyeRow {
  const FrameRecord& frame;
  std::size_t eye;
};

std::vector<TableField<TrackerRow>> tracker_fields() {
  using Row = TrackerRow;
  return std::vector<TableField<Row>>{
             {"device_time_s", "number", "s",
              "when it was measured, or what time it was predicted for, on the trial's clock",
              [](const Row& r) -> TableValue { return r.sample.device_time; }},
             {"host_time_s", "number", "s",
              "when its first byte arrived; 0 if it never crossed a wire",
              [](const Row& r) -> TableValue { return r.sample.host_time; }},
             {"sequence", "whole", "", "number of the sample, per station; a gap is a lost sample",
              [](const Row& r) -> TableValue { return r.sample.sequence; }},
             {"station", "whole", "",
              "receiver, from 1, of other publishers also 0 and below; without other stations in the rig 1 head, 2 right hand, 3 left hand",
              [](const Row& r) -> TableValue { return r.sample.station; }},
             {"frame", "text", "", "frame of the pose; T is the transmitter's",
              [](const Row& r) -> TableValue { return r.sample.frame; }}} +
         pose_fields<[](const Row& r) -> const Pose& { return r.sample.X_TS; }, Row>(
             "position of the receiver in that frame", "its rotation, a unit quaternion") +
         std::vector<TableField<Row>>{
             {"status", "text", "",
              "empty if the sample is good, else the error letter of the Fastrak, or what another device sent; "
              "x where that cannot be printed",
              [](const Row& r) -> TableValue {
                if (r.sample.good()) return std::string();
                return std::string(1, devices::status_character(r.sample));
              }},
             {"stylus", "yes/no", "", "state of the stylus switch",
              [](const Row& r) -> TableValue { return (r.sample.buttons & 1) != 0; }},
             {"sent_time_s", "number", "s",
              "when a device that predicts told it; 0: at device_time_s",
              [](const Row& r) -> TableValue { return r.sample.sent_time; }},
             {"position_estimated", "yes/no", "",
              "the device did not track the position then; a hand is not moved by it",
              [](const Row& r) -> TableValue { return r.sample.position_estimated; }},
             {"orientation_estimated", "yes/no", "", "the device did not track the rotation then",
              [](const Row& r) -> TableValue { return r.sample.orientation_estimated; }},
             {"session_time_s", "number", "s",
              "when the session used it (session_utime of the message); 0 outside a session",
              [](const Row& r) -> TableValue { return r.sample.session_time; }}} +
         maybe_vector_fields<[](const Row& r) { return r.p_WP; }, Row>(
             "walk_x_m", "walk_y_m", "walk_z_m", "m",
             "p_WP: displacement of the tracked space in the world by walking with the thumb "
             "buttons; X_WS is X_WP X_WT X_TS; empty if the trial's scenario cannot be read");
}

std::vector<TableField<devices::MouseSample>> button_fields() {
  using Row = devices::MouseSample;
  return {
      {"device_time_s", "number", "s", "when it changed, on the trial's clock",
       [](const Row& r) -> TableValue { return r.device_time; }},
      {"host_time_s", "number", "s", "when its first byte arrived; 0 if it never crossed a wire",
       [](const Row& r) -> TableValue { return r.host_time; }},
      {"left_thumb", "yes/no", "", "left thumb button: walk forward",
       [](const Row& r) -> TableValue { return r.left_thumb; }},
      {"right_thumb", "yes/no", "", "right thumb button: walk backward",
       [](const Row& r) -> TableValue { return r.right_thumb; }},
      {"trigger", "yes/no", "", "trigger: grab",
       [](const Row& r) -> TableValue { return r.trigger; }},
      {"session_time_s", "number", "s", "when the session used it; 0 outside a session",
       [](const Row& r) -> TableValue { return r.session_time; }}};
}

std::vector<TableField<Event>> event_fields() {
  using Row = Event;
  return std::vector<TableField<Row>>{
             {"time_s", "number", "s", "time on the trial's clock",
              [](const Row& r) -> TableValue { return r.time; }},
             {"tick", "whole", "", "tick of the simulation; -1 outside it",
              [](const Row& r) -> TableValue { return r.tick; }},
             {"kind", "text", "", "kind of the event; see docs/events.md",
              [](const Row& r) -> TableValue { return r.kind; }},
             {"bodies", "text", "", "bodies of the event, separated by semicolons",
              [](const Row& r) -> TableValue {
                return fmt::format("{}", fmt::join(r.bodies, ";"));
              }}} +
         vector_fields<[](const Row& r) -> const Vec3& { return r.p_W; }, Row>(
             "x_m", "y_m", "z_m", "m", "place in the world; 0 if the kind has none") +
         vector_fields<[](const Row& r) -> const Vec3& { return r.j_W; }, Row>(
             "impulse_x_ns", "impulse_y_ns", "impulse_z_ns", "N s",
             "impulse on the first body, in the world frame") +
         std::vector<TableField<Row>>{{"value", "number", "", "depends on the kind",
                                       [](const Row& r) -> TableValue { return r.value; }},
                                      {"detail", "text", "", "depends on the kind",
                                       [](const Row& r) -> TableValue { return r.detail.text(); }}};
}

std::vector<TableField<StateRow>> state_fields() {
  using Row = StateRow;
  return std::vector<TableField<Row>>{
             {"tick", "whole", "", "tick of the simulation",
              [](const Row& r) -> TableValue { return r.tick.tick; }},
             {"time_s", "number", "s", "time at the end of the tick, on the trial's clock",
              [](const Row& r) -> TableValue { return r.tick.time; }},
             {"hash", "hash", "", "hash of the state after the tick (docs/hash-and-ledger.md)",
              [](const Row& r) -> TableValue { return r.tick.hash; }},
             {"contacts", "whole", "", "number of contact points of all bodies in the tick",
              [](const Row& r) -> TableValue { return r.tick.contacts; }},
             {"body", "text", "",
              "name of the body; `hand` is below the floor, at z = -10 m, while it is not tracked, carries "
              "something or is not clear yet of what it let go; a skittle that was counted stands upright "
              "behind the wall ahead",
              [](const Row& r) -> TableValue { return std::string(r.name); }}} +
         pose_fields<[](const Row& r) -> const Pose& { return r.body.X_WB; }, Row>(
             "position of the centre of mass in the world",
             "rotation of the body, a unit quaternion") +
         vector_fields<[](const Row& r) -> const Vec3& { return r.body.V_WB.v; }, Row>(
             "vx_mps", "vy_mps", "vz_mps", "m/s", "velocity of the centre of mass in the world") +
         vector_fields<[](const Row& r) -> const Vec3& { return r.body.V_WB.w; }, Row>(
             "wx_radps", "wy_radps", "wz_radps", "rad/s", "angular velocity in the world") +
         std::vector<TableField<Row>>{
             {"asleep", "yes/no", "",
              "sleeping: the body is at rest and not simulated until something touches it",
              [](const Row& r) -> TableValue { return r.body.asleep; }}};
}

std::vector<TableField<EyeRow>> frame_fields() {
  using Row = EyeRow;
  return std::vector<TableField<Row>>{
             {"frame", "whole", "", "number of the frame, from 0",
              [](const Row& r) -> TableValue { return r.frame.frame; }},
             {"time_s", "number", "s", "time on the trial's clock",
              [](const Row& r) -> TableValue { return r.frame.time; }},
             {"tick", "whole", "", "last tick that was simulated before it was drawn",
              [](const Row& r) -> TableValue { return r.frame.tick; }},
             {"eye", "text", "", "left or right",
              [](const Row& r) -> TableValue { return r.eye == 0 ? "left" : "right"; }}} +
         pose_fields<[](const Row& r) -> const Pose& { return r.frame.X_WE[r.eye]; }, Row>(
             "position of the eye in the world",
             "rotation of the eye, a unit quaternion: x right, y up, it looks along -z") +
         std::vector<TableField<Row>>{
             {"pixels", "hash", "", "FNV-1a of the picture's RGB bytes",
              [](const Row& r) -> TableValue { return r.frame.hash[r.eye]; }}};
}

template <typename Row>
void list(std::vector<TableColumn>& all, const char* table,
          const std::vector<TableField<Row>>& fields) {
  for (const TableField<Row>& f : fields) all.push_back({table, f.name, f.kind, f.unit, f.meaning});
}

}  // namespace

std::vector<TableColumn> table_columns() {
  std::vector<TableColumn> all;
  list(all, "trackers", tracker_fields());
  list(all, "buttons", button_fields());
  list(all, "events", event_fields());
  list(all, "throws", throw_fields());
  list(all, "states", state_fields());
  list(all, "frames", frame_fields());
  for (std::size_t i = 1; i < all.size(); ++i) {  // y and z, or qx .. qz, have the same meaning
    if (all[i].meaning.empty()) all[i].meaning = all[i - 1].meaning;
  }
  return all;
}

std::vector<std::string> table_names() {
  std::vector<std::string> names;
  for (const TableColumn& column : table_columns()) {
    if (names.empty() || names.back() != column.table) names.push_back(column.table);
  }
  return names;
}

struct TableRows::Table {
  template <typename Row>
  using Fields = std::vector<TableField<Row>>;
  using Any = std::variant<Fields<TrackerRow>, Fields<devices::MouseSample>, Fields<Event>,
                           Fields<ThrowRow>, Fields<StateRow>, Fields<EyeRow>>;

  static Any fields_of(std::string_view table) {
    if (table == "trackers") return tracker_fields();
    if (table == "buttons") return button_fields();
    if (table == "events") return event_fields();
    if (table == "throws") return throw_fields();
    if (table == "states") return state_fields();
    if (table == "frames") return frame_fields();
    throw std::invalid_argument(
        fmt::format("no table '{}'; expected one of {}", table, fmt::join(table_names(), ", ")));
  }

  template <typename Row>
  void add(const Row& row) {
    const auto* own = std::get_if<Fields<Row>>(&fields);
    if (!own) return;
    values.clear();
    for (const TableField<Row>& field : *own) values.push_back(field.value(row));
    take(values);
  }

  Any fields;
  std::vector<std::string> names;  ///< of the bodies
  Take take;
  Walk walk;
  std::vector<TableValue> values = {};  ///< of one row
};

TableRows::TableRows(std::string_view table, const TrialHeader& header, Take take, Walk walk)
    : table_(std::make_unique<Table>(
          Table{Table::fields_of(table), header.body_names, std::move(take), std::move(walk)})) {}
TableRows::~TableRows() = default;
TableRows::TableRows(TableRows&&) noexcept = default;

void TableRows::add(const devices::Sample& sample) {
  if (const auto* mouse = std::get_if<devices::MouseSample>(&sample)) return table_->add(*mouse);
  const auto& tracker = std::get<devices::TrackerSample>(sample);
  table_->add(
      TrackerRow{tracker, table_->walk ? table_->walk(devices::available(sample)) : std::nullopt});
}

void TableRows::add(const ThrowRow& row) {
  table_->add(row);
}

void TableRows::add(const Event& event) {
  table_->add(event);
}

void TableRows::add(const TickState& state) {
  const std::vector<std::string>& names = table_->names;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const std::string name = i < names.size() ? names[i] : fmt::format("body {}", i);
    table_->add(StateRow{state, state.bodies[i], name});
  }
}

void TableRows::add(const FrameRecord& frame) {
  for (std::size_t eye = 0; eye < 2; ++eye) table_->add(EyeRow{frame, eye});
}

TableWriter::TableWriter(std::ostream& out, std::string_view table, const TrialHeader& header,
                         TableRows::Walk walk)
    : rows_(std::make_unique<std::int64_t>(0)),
      table_(
          table, header,
          [&out, count = rows_.get()](std::span<const TableValue> row) {
            for (const TableValue& value : row) {
              out << (&value == row.data() ? "" : ",") << std::visit(CsvText{}, value);
            }
            out << '\n';
            ++*count;
          },
          std::move(walk)) {
  const char* comma = "";
  for (const TableColumn& column : table_columns()) {
    if (column.table != table) continue;
    out << comma << column.name;
    comma = ",";
  }
  out << '\n';
}

std::vector<std::string> bodies_in(std::string_view cell) {
  std::vector<std::string> bodies;
  while (!cell.empty()) {
    const std::size_t end = std::min(cell.find(';'), cell.size());
    bodies.emplace_back(cell.substr(0, end));
    cell.remove_prefix(std::min(end + 1, cell.size()));
  }
  return bodies;
}

void write_dictionary(std::ostream& out) {
  out << "table,column,kind,unit,meaning\n";
  for (const TableColumn& c : table_columns()) {
    out << fmt::format("{},{},{},{},{}\n", c.table, c.name, c.kind, c.unit, csv_quoted(c.meaning));
  }
}

}  // namespace headpin::scene
