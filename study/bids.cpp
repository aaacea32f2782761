#include "study/bids.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "devices/base/median_step.h"
#include "study/csv.h"

namespace headpin::study {

namespace {

using Json = nlohmann::ordered_json;

const std::string& name_of(const Design& design) {
  return design.title.empty() ? design.name : design.title;
}

/// One column of a tracking system.
struct Channel {
  std::string name, component, type, point, units;
};

const std::vector<const char*> kPoseParts = {"x", "y", "z", "quat_w", "quat_x", "quat_y", "quat_z"};

constexpr const char* kNotInPlay =
    "n/a is the pose of a body that is not in play: of a skittle that was counted, and of a hand that is "
    "not tracked, carries something or is not clear yet of what it let go";

std::string line(const std::vector<std::string>& cells) {
  std::string text;
  for (const std::string& cell : cells) text += (text.empty() ? "" : "\t") + cell;
  return text + "\n";
}

/// A text with spaces in place of the characters that end a cell.
std::string cell_of(std::string text) {
  for (char& c : text) {
    if (c == '\t' || c == '\n' || c == '\r') c = ' ';
  }
  return text.empty() ? kNoAnswer : text;
}

std::string exact_seconds(Time time) {
  const std::int64_t us = time.count();
  return fmt::format("{}{}.{:06}", us < 0 ? "-" : "", std::abs(us) / 1'000'000,
                     std::abs(us) % 1'000'000);
}

std::string stem(const BidsSession& session) {
  return fmt::format("sub-{0}/motion/sub-{0}_task-bowling", session.subject);
}

std::string name_of(const BidsSession& session, const std::string& system, const char* what) {
  return fmt::format("{}_tracksys-{}_run-{}_{}", stem(session), system, session.run, what);
}

/// "head", "hand", "lefthand", "station4"
std::string system_of(std::int32_t station, const scene::Rig& rig) {
  if (station == rig.head_station) return "head";
  if (station != rig.hand_station) return fmt::format("station{}", station);
  return station == devices::kLeftHandStation ? "lefthand" : "hand";
}

void add_pose(std::vector<Channel>& channels, const std::string& point) {
  for (const char* part : kPoseParts) {
    const bool turn = part[0] == 'q';
    channels.push_back(
        {point + "_" + part, part, turn ? "ORNT" : "POS", point, turn ? kNoAnswer : "m"});
  }
}

std::vector<Channel> tracker_channels(const std::string& point) {
  std::vector<Channel> channels = {{"latency", kNoAnswer, "LATENCY", kNoAnswer, "s"}};
  add_pose(channels, point);
  for (const auto& [name, units] : {std::pair("sequence", "n/a"),
                                    {"status", "n/a"},
                                    {"stylus", "n/a"},
                                    {"host_time", "s"},
                                    {"session_time", "s"},
                                    {"log_index", "n/a"},
                                    {"sent_time", "s"},
                                    {"position_estimated", "n/a"},
                                    {"orientation_estimated", "n/a"}}) {
    channels.push_back({name, kNoAnswer, "MISC", point, units});
  }
  return channels;
}

std::string channels_tsv(const std::vector<Channel>& channels) {
  std::string text =
      line({"name", "component", "type", "tracked_point", "units", "reference_frame"});
  for (const Channel& one : channels) {
    const bool space = one.type == "POS" || one.type == "ORNT";
    text += line(
        {one.name, one.component, one.type, one.point, one.units, space ? "global" : kNoAnswer});
  }
  return text;
}

/// @param axes  where +x, +y and +z point
Json channels_json(const std::string& axes, const std::string& meaning) {
  return {
      {"reference_frame",
       {{"Description", meaning},
        {"Levels",
         {{"global",
           {{"SpatialAxes", axes}, {"RotationRule", "right-hand"}, {"RotationOrder", "ZXY"}}}}}}}};
}

/// Rows a second; 0 where there is no rate.
double rate_of(std::int64_t rows, double duration_s) {
  return duration_s > 0.0 ? static_cast<double>(rows - 1) / duration_s : 0.0;
}

/// The rate of a device, by the usual step between its samples. Stamps are whole microseconds or coarser, and
/// clocks run a little fast or slow: half a percent from a whole number of hertz is that number.
///
/// @param times_us  when the samples were measured [us]
/// @return          [Hz]; 0 where time never advances
double nominal_rate(const std::vector<double>& times_us) {
  const double step_us = devices::usual_step(times_us);
  if (step_us == 0.0) return 0.0;
  const double rate_hz = 1e6 / step_us, whole_hz = std::round(rate_hz);
  return std::abs(rate_hz - whole_hz) <= 0.005 * rate_hz ? whole_hz : rate_hz;
}

/// @param rate_hz  of the device; 0 where there is no rate, as for one row: a rate of 0 would be wrong
Json motion_json(const std::vector<Channel>& channels, const std::string& system, double rate_hz,
                 std::int64_t rows, double duration_s) {
  const auto count = [&](const char* type) {
    return std::ranges::count(channels, std::string(type), &Channel::type);
  };
  std::set<std::string> points;
  for (const Channel& one : channels) {
    if (one.type == "POS") points.insert(one.point);
  }
  Json all = {{"TaskName", "bowling"},
              {"TaskDescription", "Two games of bowling at skittles in a virtual room"}};
  if (rate_hz > 0.0) {
    all["SamplingFrequency"] = rate_hz;
    all["SamplingFrequencyEffective"] = duration_s > 0.0 ? rate_of(rows, duration_s) : rate_hz;
  }
  all["RecordingDuration"] = duration_s;
  all["TrackingSystemName"] = system;
  all["MotionChannelCount"] = channels.size();
  all["POSChannelCount"] = count("POS");
  all["ORNTChannelCount"] = count("ORNT");
  all["LATENCYChannelCount"] = count("LATENCY");
  all["MISCChannelCount"] = count("MISC");
  all["TrackedPointsCount"] = points.size();
  return all;
}

std::string tracker_row(const devices::TrackerSample& s, std::size_t index) {
  std::vector<std::string> cells = {exact_seconds(s.device_time)};
  for (const double value : {s.X_TS.p.x(), s.X_TS.p.y(), s.X_TS.p.z(), s.X_TS.q.w(), s.X_TS.q.x(),
                             s.X_TS.q.y(), s.X_TS.q.z()}) {
    cells.push_back(fmt::format("{}", value));
  }
  cells.push_back(fmt::format("{}", s.sequence));
  cells.push_back(fmt::format("{}", static_cast<int>(s.status)));
  cells.push_back(fmt::format("{}", s.buttons));
  cells.push_back(exact_seconds(s.host_time));
  cells.push_back(exact_seconds(s.session_time));
  cells.push_back(fmt::format("{}", index));
  cells.push_back(exact_seconds(s.sent_time));
  for (const bool estimated : {s.position_estimated, s.orientation_estimated}) {
    cells.emplace_back(estimated ? "1" : "0");
  }
  return line(cells);
}

/// A direction in the room: its axis, its sign, a letter of SpatialAxes and a word.
struct Direction {
  int along = 0;
  double sign = 1.0;

  char letter() const { return "RLAPSI"[place()]; }
  const char* word() const {
    static constexpr std::array kWords = {"right", "left", "ahead", "back", "up", "down"};
    return kWords[place()];
  }

 private:
  std::size_t place() const { return static_cast<std::size_t>(2 * along + (sign < 0.0 ? 1 : 0)); }
};

/// Where the axes of a transmitter point, about: the nearest of the 24 right-handed frames that have
/// their axes along those of the room. Each axis by itself could take the direction of another one.
std::array<Direction, 3> directions_of(const Quat& q_WT) {
  const Mat3 R_WT = q_WT.toRotationMatrix();
  std::array<Direction, 3> nearest;
  double best = -4.0;  // a sum of three cosines is more
  std::array<int, 3> along = {0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      std::array<Direction, 3> frame;
      Mat3 R_WF = Mat3::Zero();
      for (unsigned i = 0; i < 3; ++i) {
        frame[i] = {along[i], ((signs >> i) & 1u) != 0 ? -1.0 : 1.0};
        R_WF(frame[i].along, i) = frame[i].sign;
      }
      const double cosines = R_WF.cwiseProduct(R_WT).sum();
      if (R_WF.determinant() < 0.0 || cosines <= best) continue;
      best = cosines;
      nearest = frame;
    }
  } while (std::ranges::next_permutation(along).found);
  return nearest;
}

std::string axes_of(const Quat& q_WT) {
  std::string axes;
  for (const Direction& direction : directions_of(q_WT)) axes += direction.letter();
  return axes;
}

std::string meaning_of(const Quat& q_WT) {
  const std::array<Direction, 3> to = directions_of(q_WT);
  return fmt::format(
      "the tracker's own frame, in the room about: +x {}, +y {}, +z {}; exactly, it is turned in "
      "the frame of tracksys-simulated by the quaternion (w, x, y, z) = ({:.6g}, {:.6g}, {:.6g}, "
      "{:.6g})",
      to[0].word(), to[1].word(), to[2].word(), q_WT.w(), q_WT.x(), q_WT.y(), q_WT.z());
}

void add_tracker(const BidsSession& session, std::int32_t station, std::vector<BidsFile>& files) {
  const std::string system = system_of(station, session.rig);
  const std::vector<Channel> channels = tracker_channels(system);
  std::string rows;
  std::vector<double> times_us;
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    const auto* sample = std::get_if<devices::TrackerSample>(&session.samples[i]);
    if (!sample || sample->station != station) continue;
    rows += tracker_row(*sample, i);
    times_us.push_back(static_cast<double>(sample->device_time.count()));
  }
  const Quat& q_WT = session.rig.X_WT.q;
  const Json sidecar =
      motion_json(channels, "receiver " + system, nominal_rate(times_us), std::ssize(times_us),
                  1e-6 * (times_us.back() - times_us.front()));
  files.emplace_back(name_of(session, system, "motion.tsv"), rows);
  files.emplace_back(name_of(session, system, "motion.json"), sidecar.dump(2) + "\n");
  files.emplace_back(name_of(session, system, "channels.tsv"), channels_tsv(channels));
  files.emplace_back(name_of(session, system, "channels.json"),
                     channels_json(axes_of(q_WT), meaning_of(q_WT)).dump(2) + "\n");
}

const std::vector<std::string> kEventColumns = {
    "onset",       "duration", "trial_type", "value",        "bodies",
    "x",           "y",        "z",          "detail",       "left_thumb",
    "right_thumb", "trigger",  "host_time",  "session_time", "log_index"};

std::string event_row(const scene::Event& event) {
  std::string bodies;
  for (const std::string& body : event.bodies) bodies += (bodies.empty() ? "" : ";") + body;
  std::vector<std::string> cells = {exact_seconds(event.time), "0", event.kind,
                                    fmt::format("{}", event.value), cell_of(bodies)};
  for (const double value : {event.p_W.x(), event.p_W.y(), event.p_W.z()}) {
    cells.push_back(fmt::format("{}", value));
  }
  cells.push_back(cell_of(event.detail.text()));
  cells.resize(kEventColumns.size(), kNoAnswer);
  return line(cells);
}

std::string button_row(const devices::MouseSample& s, std::size_t index) {
  std::vector<std::string> cells = {exact_seconds(s.device_time), "0", "button"};
  cells.resize(9, kNoAnswer);
  for (const bool down : {s.left_thumb, s.right_thumb, s.trigger}) {
    cells.emplace_back(down ? "1" : "0");
  }
  cells.push_back(exact_seconds(s.host_time));
  cells.push_back(exact_seconds(s.session_time));
  cells.push_back(fmt::format("{}", index));
  return line(cells);
}

/// The sidecar of the events. From the trial in it, `import` makes the trial again.
Json events_json(const BidsSession& session, const std::set<std::int32_t>& stations) {
  const scene::TrialHeader& header = *session.header;
  const auto says = [](const char* text) { return Json{{"Description", text}}; };
  Json all;
  all["trial_type"] = says("what happened: button, or a kind of headpin's events (docs/events.md)");
  all["value"] = says("what the kind of event says");
  all["bodies"] = says("to which bodies, separated by semicolons");
  for (const char* axis : {"x", "y", "z"}) {
    all[axis] = {{"Description", "where, in the room: x right, y to the skittles, z up"},
                 {"Units", "m"}};
  }
  all["detail"] = says("what the kind of event says besides, JSON for some");
  all["left_thumb"] = says("of a button event: 1 while it is pressed; walks forward");
  all["right_thumb"] = says("likewise; walks backward");
  all["trigger"] = says("likewise; takes and lets go");
  for (const char* time : {"host_time", "session_time"}) {
    all[time] = {{"Description", "when the host, or the session, got the sample; 0 for never"},
                 {"Units", "s"}};
  }
  all["log_index"] = says("place among all samples of the session, trackers' and buttons'");
  all["HeadpinTrial"] = {{"Description", "the trial that these tables are of"},
                         {"participant", header.participant},
                         {"condition", header.condition},
                         {"seed", fmt::format("{}", header.seed)},
                         {"scenario", header.scenario},
                         {"end_s", nearest_seconds(session.end)},
                         {"samples", session.samples.size()},
                         {"stations", Json::object()}};
  for (const std::int32_t station : stations) {
    all["HeadpinTrial"]["stations"][system_of(station, session.rig)] = station;
  }
  return all;
}

void add_events(const BidsSession& session, const std::set<std::int32_t>& stations,
                std::vector<BidsFile>& files) {
  std::vector<std::pair<Time, std::string>> rows;
  for (const scene::Event& event : session.events) rows.emplace_back(event.time, event_row(event));
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    if (const auto* sample = std::get_if<devices::MouseSample>(&session.samples[i])) {
      rows.emplace_back(sample->device_time, button_row(*sample, i));
    }
  }
  std::ranges::stable_sort(rows, {}, &std::pair<Time, std::string>::first);
  std::string text = line(kEventColumns);
  for (const auto& [time, row] : rows) text += row;
  const std::string name = fmt::format("{}_run-{}_events", stem(session), session.run);
  files.emplace_back(name + ".tsv", text);
  files.emplace_back(name + ".json", events_json(session, stations).dump(2) + "\n");
}

std::string with_tabs(const std::string& csv, const std::string& where) {
  const CsvTable table = parse_csv(csv, where);
  std::vector<std::string> names = table.columns;
  names[0] = "participant_id";
  std::string text = line(names);
  for (const CsvRow& row : table.rows) {
    std::vector<std::string> cells;
    for (const std::string& cell : row.cells) cells.push_back(cell_of(cell));
    cells[0] = "sub-" + cells[0];
    text += line(cells);
  }
  return text;
}

Json dictionary(const std::vector<Column>& columns) {
  Json all;
  for (const Column& column : columns) {
    if (column.name == "participant") continue;
    all[column.name]["Description"] = column.meaning;
    if (!column.unit.empty()) all[column.name]["Units"] = column.unit;
  }
  return all;
}

/// The questionnaire's answers in phenotype/.
void add_phenotype(const Questionnaire& questions, const std::vector<Person>& people,
                   std::vector<BidsFile>& files) {
  std::vector<std::string> cells = {"participant_id"};
  Json sidecar = {{"MeasurementToolMetadata", {{"Description", questions.name}}}};
  for (const Item& item : questions.items) {
    cells.push_back(item.id);
    Json& one = sidecar[item.id];
    one["Description"] = item.text.at(questions.languages[0]);
    if (item.is_scale()) {
      one["Levels"] = {{fmt::format("{}", item.low), item.low_end.at(questions.languages[0])},
                       {fmt::format("{}", item.high), item.high_end.at(questions.languages[0])}};
    } else {
      for (const Choice& choice : item.choices) {
        one["Levels"][choice.id] = choice.text.at(questions.languages[0]);
      }
    }
  }
  std::string text = line(cells);
  for (const Person& person : people) {
    cells = {"sub-" + person.planned.id};
    for (const Item& item : questions.items) {
      const Answer* answer = find(person.answers, item.id);
      cells.push_back(answer ? answer->answer : kNoAnswer);
    }
    text += line(cells);
  }
  files.emplace_back("phenotype/questionnaire.tsv", text);
  files.emplace_back("phenotype/questionnaire.json", sidecar.dump(2) + "\n");
}

}  // namespace

std::string bids_readme(const Design& design, const std::vector<Person>& people,
                        bool deidentified) {
  const bool virtuals = std::ranges::any_of(people, &Person::is_virtual);
  const bool all_replay =
      std::ranges::all_of(people, [](const Person& p) { return p.played.replays; });
  return fmt::format(
      "{}\n\nTwo games of bowling at skittles in a virtual room a participant, between which one "
      "parameter of the collisions changes.\n{}"
      "tracksys-head and tracksys-hand (tracksys-lefthand of a left hand) are what the tracker "
      "measured, tracksys-simulated is what "
      "the simulation made of it. There, {}. The events have the buttons among them. Latencies of all "
      "tracking systems and onsets of the events are seconds on the one clock of the trial, so they may be "
      "compared: none counts from the first sample of its own table. {}{}\n",
      name_of(design),
      virtuals ? "Some or all of the participants are virtual: see `virtual` in participants.tsv.\n"
               : "",
      kNotInPlay,
      deidentified
          ? "The participants have numbers in place of their names, and the trials are left out."
      : all_replay ? "sourcedata/ holds the trials themselves, which headpin replays to the bit."
                   : "sourcedata/ holds the trials themselves.",
      all_replay
          ? ""
          : " Where the simulation by the version of headpin that wrote this dataset differs "
            "from the recording, tracksys-simulated is left out; `replays` in "
            "participants.tsv is no there.");
}

std::vector<BidsFile> dataset_files(const Design& design, const Questionnaire& questions,
                                    const std::vector<Person>& people, const std::string& version) {
  const Json description = {
      {"Name", name_of(design)}, {"BIDSVersion", "1.9.0"},
      {"DatasetType", "raw"},    {"License", "n/a"},
      {"Authors", {"n/a"}},      {"GeneratedBy", {{{"Name", "headpin"}, {"Version", version}}}}};
  std::vector<BidsFile> files = {
      {"participants.tsv", with_tabs(people_csv(design, questions, people), "participants.csv")},
      {"participants.json", dictionary(people_columns(design, questions)).dump(2) + "\n"}};
  add_phenotype(questions, people, files);
  files.emplace_back("dataset_description.json", description.dump(2) + "\n");
  return files;
}

std::vector<BidsFile> session_files(const BidsSession& session) {
  std::set<std::int32_t> stations;
  for (const devices::Sample& sample : session.samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (tracker && tracker->station > 0) stations.insert(tracker->station);
  }
  std::vector<BidsFile> files;
  for (const std::int32_t station : stations) add_tracker(session, station, files);
  add_events(session, stations, files);
  return files;
}

void SimulatedSystem::start(const scene::Session& session) {
  names_ = scene::body_names(*session.stage);
  const scene::Rates& rates = session.scenario().rates;
  every_ = std::max<std::int64_t>(1, rates.physics_hz / rates.frame_hz);
  rate_hz_ = static_cast<double>(rates.physics_hz) / static_cast<double>(every_);
}

void SimulatedSystem::tick(const scene::Session& session) {
  if (session.tick % every_ != 0) return;
  scene::tick_state(session, state_);
  std::string row = exact_seconds(state_.time);
  for (std::size_t i = 0; i < state_.bodies.size(); ++i) {
    const Pose& X = state_.bodies[i].X_WB;
    if (scene::is_away(*session.stage, static_cast<engine::BodyId>(i), X)) {
      for (std::size_t part = 0; part < kPoseParts.size(); ++part) {
        row += '\t';
        row += kNoAnswer;
      }
      continue;
    }
    for (const double value : {X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()}) {
      row += fmt::format("\t{:.6g}", value);
    }
  }
  take_(row + "\n");
  if (rows_++ == 0) first_ = state_.time;
}

std::string SimulatedSystem::table_name(const BidsSession& session) {
  return name_of(session, "simulated", "motion.tsv");
}

std::vector<BidsFile> SimulatedSystem::files(const BidsSession& session) const {
  std::vector<Channel> channels = {{"latency", kNoAnswer, "LATENCY", kNoAnswer, "s"}};
  for (const std::string& name : names_) add_pose(channels, name);
  Json sidecar = motion_json(channels, "headpin", rate_hz_, rows_, seconds(state_.time - first_));
  sidecar["TaskDescription"] =
      fmt::format("Bodies of the virtual room, simulated; a frame of 1/{:.6g} s a row; {}",
                  rate_hz_, kNotInPlay);
  return {{name_of(session, "simulated", "motion.json"), sidecar.dump(2) + "\n"},
          {name_of(session, "simulated", "channels.tsv"), channels_tsv(channels)},
          {name_of(session, "simulated", "channels.json"),
           channels_json("RAS", "the room: +x right, +y to the skittles, +z up").dump(2) + "\n"}};
}

}  // namespace headpin::study
