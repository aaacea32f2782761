#include "scene/record/xdf.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/base/sources.h"
#include "devices/log/sample_messages.h"
#include "scene/record/end_time.h"
#include "scene/record/outside.h"
#include "scene/record/tables.h"

namespace headpin::scene {
namespace {

constexpr std::string_view kMocap = "MoCap", kButtons = "Buttons", kMarkers = "Markers",
                           kEventBodies = "EventBodies", kEventDetails = "EventDetails",
                           kEventValues = "EventValues";

/// Older files have no channels after `order`, the number of the sample among all of the trial.
constexpr std::ptrdiff_t kTrackerChannelsSince = 3;

/// Channels of a receiver.
std::vector<devices::XdfChannel> tracker_channels(const std::string& object) {
  std::vector<devices::XdfChannel> channels = {
      {"x_m", "PositionX", "meters", ""},
      {"y_m", "PositionY", "meters", ""},
      {"z_m", "PositionZ", "meters", ""},
      {"qw", "OrientationA", "quaternion", ""},
      {"qx", "OrientationB", "quaternion", ""},
      {"qy", "OrientationC", "quaternion", ""},
      {"qz", "OrientationD", "quaternion", ""},
      {"status", "Status",
       "0 good, else the code of the Fastrak's error letter, or of another character", ""},
      {"stylus", "Switch", "0/1", ""},
      {"host_time_s", "Time", "s", ""},
      {"session_time_s", "Time", "s", ""},
      {"sequence", "Count", "", ""},
      {"order", "Count", "", ""},
      {"sent_time_s", "Time", "s", ""},
      {"position_estimated", "Status", "0/1", ""},
      {"orientation_estimated", "Status", "0/1", ""}};
  for (devices::XdfChannel& channel : channels) channel.object = object;
  return channels;
}

const std::vector<devices::XdfChannel> kMouseChannels = {
    {"left_thumb", "Button", "0/1", ""}, {"right_thumb", "Button", "0/1", ""},
    {"trigger", "Button", "0/1", ""},    {"host_time_s", "Time", "s", ""},
    {"session_time_s", "Time", "s", ""}, {"order", "Count", "", ""}};

// Some readers expect one channel in each stream of strings.
const std::vector<devices::XdfChannel> kMarkerChannels = {{"kind", "Marker", "", ""}};
const std::vector<devices::XdfChannel> kBodiesChannels = {{"bodies", "Text", "", ""}};
const std::vector<devices::XdfChannel> kDetailChannels = {{"detail", "Text", "", ""}};
const std::vector<devices::XdfChannel> kValueChannels = {{"tick", "Count", "", ""},
                                                         {"x_m", "EventX", "meters", ""},
                                                         {"y_m", "EventY", "meters", ""},
                                                         {"z_m", "EventZ", "meters", ""},
                                                         {"impulse_x_ns", "ImpulseX", "N s", ""},
                                                         {"impulse_y_ns", "ImpulseY", "N s", ""},
                                                         {"impulse_z_ns", "ImpulseZ", "N s", ""},
                                                         {"value", "Value", "", ""}};

std::string xml_element(std::string_view name, std::string_view text) {
  return fmt::format("<{0}>{1}</{0}>", name, devices::xml_escaped(text));
}

std::string about_trial(const TrialSummary& trial, const std::optional<Time>& end) {
  const TrialHeader& header = trial.header;
  return fmt::format(
      "<headpin>{}</headpin>",
      xml_element("participant", header.participant) + xml_element("condition", header.condition) +
          xml_element("seed", std::to_string(header.seed)) +
          xml_element("version", header.software_version) +
          xml_element("complete", trial.complete ? "true" : "false") +
          (end ? xml_element("end_s", fmt::format("{}", nearest_seconds(*end))) : "") +
          xml_element("scenario", header.scenario));
}

/// The frame of positions and rotations.
std::string about_frame(std::int32_t station, const std::optional<Pose>& X_WT) {
  std::string about = xml_element("station", std::to_string(station)) +
                      "<setup><name>T, the frame of the transmitter</name>";
  if (X_WT) {
    const Vec3& p = X_WT->p;
    const Quat& q = X_WT->q;
    about += fmt::format(
        "<transmitter_in_world><X>{}</X><Y>{}</Y><Z>{}</Z><A>{}</A><B>{}</B><C>{}</C><D>{}</D>"
        "</transmitter_in_world>",
        p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  }
  return about + "</setup>";
}

class TrialToXdf {
 public:
  TrialToXdf(const TrialSummary& trial, const XdfSetting& setting,
             const std::function<void(std::string_view)>& put)
      : writer_(put, about_trial(trial, setting.end)), events_(trial.events) {
    for (const auto& [device, summary] : trial.devices) {
      const std::optional<std::int32_t> station = devices::station_of(device);
      if (!station) continue;
      streams_[device] = writer_.begin({devices::device_name(device), std::string(kMocap),
                                        "double64", tracker_channels(devices::device_name(device)),
                                        about_frame(*station, setting.X_WT)});
    }
    if (trial.devices.contains(devices::Device::mouse)) {
      streams_[devices::Device::mouse] =
          writer_.begin({devices::device_name(devices::Device::mouse), std::string(kButtons),
                         "double64", kMouseChannels});
    }
    kinds_ = writer_.begin({"events", std::string(kMarkers), "string", kMarkerChannels});
    bodies_ = writer_.begin({"event bodies", std::string(kEventBodies), "string", kBodiesChannels});
    details_ =
        writer_.begin({"event details", std::string(kEventDetails), "string", kDetailChannels});
    values_ =
        writer_.begin({"event values", std::string(kEventValues), "double64", kValueChannels});
  }

  void add(const devices::Sample& sample) {
    const Time now = devices::available(sample);
    add_events(now);
    clock_ = std::max(clock_, nearest_seconds(now));
    writer_.advance(clock_);
    std::visit([this](const auto& one) { add_one(one); }, sample);
    ++order_;
  }

  std::vector<devices::XdfWriter::Count> finish() {
    add_events(Time::max());
    writer_.finish();
    return writer_.counts();
  }

 private:
  void add_events(Time until) {
    for (; next_event_ < events_.size() && events_[next_event_].time <= until; ++next_event_) {
      add_event(events_[next_event_]);
    }
  }

  void add_event(const Event& event) {
    const double time = nearest_seconds(event.time);
    clock_ = std::max(clock_, time);
    writer_.advance(clock_);
    writer_.add(kinds_, time, std::array{event.kind});
    writer_.add(bodies_, time, std::array{fmt::format("{}", fmt::join(event.bodies, ";"))});
    writer_.add(details_, time, std::array{event.detail.text()});
    writer_.add(
        values_, time,
        std::array{static_cast<double>(event.tick), event.p_W.x(), event.p_W.y(), event.p_W.z(),
                   event.j_W.x(), event.j_W.y(), event.j_W.z(), event.value});
  }

  void add_one(const devices::TrackerSample& s) {
    const Vec3& p = s.X_TS.p;
    const Quat& q = s.X_TS.q;
    writer_.add(streams_.at(devices::device_at(s.station)), nearest_seconds(s.device_time),
                std::array{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(),
                           s.good() ? 0.0 : static_cast<double>(devices::status_character(s)),
                           static_cast<double>(s.buttons & 1), nearest_seconds(s.host_time),
                           nearest_seconds(s.session_time), static_cast<double>(s.sequence),
                           static_cast<double>(order_), nearest_seconds(s.sent_time),
                           s.position_estimated ? 1.0 : 0.0, s.orientation_estimated ? 1.0 : 0.0});
  }

  void add_one(const devices::MouseSample& s) {
    const auto number = [](bool pressed) { return pressed ? 1.0 : 0.0; };
    writer_.add(streams_.at(devices::Device::mouse), nearest_seconds(s.device_time),
                std::array{number(s.left_thumb), number(s.right_thumb), number(s.trigger),
                           nearest_seconds(s.host_time), nearest_seconds(s.session_time),
                           static_cast<double>(order_)});
  }

  devices::XdfWriter writer_;
  const std::vector<Event>& events_;
  std::size_t next_event_ = 0;
  std::map<devices::Device, std::size_t> streams_;
  std::size_t kinds_ = 0, bodies_ = 0, details_ = 0, values_ = 0;
  std::int64_t order_ = 0;
  double clock_ = 0.0;
};

/// A sample of a stream, by the labels of its channels.
class StreamRow {
 public:
  StreamRow(const devices::XdfStream& stream, const std::vector<devices::XdfChannel>& expected,
            std::string_view where)
      : stream_(stream), where_(where) {
    const auto same = [](const devices::XdfChannel& a, const devices::XdfChannel& b) {
      return a.label == b.label;
    };
    const bool words = expected.front().type == "Marker" || expected.front().type == "Text";
    if (!std::ranges::equal(stream.channels, expected, same) || words != stream.has_words()) {
      fail("expected the channels that export writes");
    }
  }

  void go_to(std::size_t row) { row_ = row; }
  bool has(std::string_view label) const { return column(label) < stream_.channels.size(); }
  std::size_t row() const { return row_; }

  double number(std::string_view label) const {
    const double number = stream_.numbers[row_ * stream_.channels.size() + column(label)];
    if (!(std::abs(number) < 1e15)) fail("expected a finite number");
    return number;
  }
  std::int64_t whole(std::string_view label) const { return std::llround(number(label)); }
  Time time(std::string_view label) const { return time_of(number(label)); }
  Time time() const { return time_of(stream_.times[row_]); }
  const std::string& word(std::string_view label) const {
    return stream_.words[row_ * stream_.channels.size() + column(label)];
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(
        fmt::format("{}: stream '{}': sample {}: {}", where_, stream_.name, row_ + 1, what));
  }

 private:
  std::size_t column(std::string_view label) const {
    return static_cast<std::size_t>(
        std::ranges::find(stream_.channels, label, &devices::XdfChannel::label) -
        stream_.channels.begin());
  }
  Time time_of(double seconds) const {
    if (!(std::abs(seconds) < 1e11)) fail("expected a time");
    return Time{std::llround(1e6 * seconds)};
  }

  const devices::XdfStream& stream_;
  std::string_view where_;
  std::size_t row_ = 0;
};

devices::TrackerSample tracker_at(const StreamRow& row, std::int32_t station) {
  devices::TrackerSample s;
  s.device_time = row.time();
  s.host_time = row.time("host_time_s");
  s.session_time = row.time("session_time_s");
  s.sequence = row.whole("sequence");
  s.station = station;
  s.X_TS.p = {row.number("x_m"), row.number("y_m"), row.number("z_m")};
  s.X_TS.q = {row.number("qw"), row.number("qx"), row.number("qy"), row.number("qz")};
  if (!(std::abs(s.X_TS.q.norm() - 1.0) < 1e-3)) row.fail("expected a unit quaternion");
  const std::int64_t status = row.whole("status");
  if (status < 0 || status > 127) row.fail("expected a status");
  s.status = status == 0 ? ' ' : static_cast<char>(status);
  s.buttons = row.whole("stylus") == 0 ? 0 : 1;
  if (!row.has("sent_time_s")) return s;
  s.sent_time = row.time("sent_time_s");
  s.position_estimated = row.whole("position_estimated") != 0;
  s.orientation_estimated = row.whole("orientation_estimated") != 0;
  return s;
}

devices::MouseSample mouse_at(const StreamRow& row) {
  devices::MouseSample s;
  s.device_time = row.time();
  s.host_time = row.time("host_time_s");
  s.session_time = row.time("session_time_s");
  s.left_thumb = row.whole("left_thumb") != 0;
  s.right_thumb = row.whole("right_thumb") != 0;
  s.trigger = row.whole("trigger") != 0;
  return s;
}

/// The station with a device_name(); nothing if there is none.
std::optional<std::int32_t> station_called(std::string_view name) {
  const auto is_called = [&](std::int32_t station) {
    return devices::device_name(devices::device_at(station)) == name;
  };
  for (const std::int32_t station :
       {devices::kHeadStation, devices::kHandStation, devices::kLeftHandStation}) {
    if (is_called(station)) return station;
  }
  const std::size_t number = std::min(name.size(), std::string_view("station ").size());
  std::int32_t station = 0;
  std::from_chars(name.data() + number, name.data() + name.size(), station);
  return is_called(station) ? std::optional(station) : std::nullopt;
}

class TrialFromXdf {
 public:
  TrialFromXdf(const devices::XdfFile& file, std::string_view where) : file_(file), where_(where) {}

  XdfTrial read() {
    const devices::XmlElement& about = *file_.header.find({"headpin"});
    trial_.notes = file_.notes;
    trial_.header.participant = raw(about, "participant");
    trial_.header.condition = raw(about, "condition");
    trial_.header.scenario = raw(about, "scenario");
    const std::string seed = about.text_at({"seed"});
    std::from_chars(seed.data(), seed.data() + seed.size(), trial_.header.seed);
    trial_.complete = about.text_at({"complete"}) != "false";
    if (file_.notes.empty()) trial_.end = end_in(about.text_at({"end_s"}));
    for (const devices::XdfStream& stream : file_.streams) {
      if (stream.type == kMocap) take_tracker(stream);
      if (stream.type == kButtons) take_mouse(stream);
    }
    std::ranges::stable_sort(samples_, {}, &Ordered::first);
    for (auto& [order, sample] : samples_) trial_.samples.push_back(std::move(sample));
    if (trial_.samples.empty()) {
      throw std::invalid_argument(
          fmt::format("{}: expected samples of a trial, found none", where_));
    }
    take_events();
    return std::move(trial_);
  }

 private:
  using Ordered = std::pair<std::int64_t, devices::Sample>;

  static std::string raw(const devices::XmlElement& about, std::string_view name) {
    const devices::XmlElement* found = about.find({name});
    return found ? found->text : "";
  }

  Time end_in(const std::string& text) const {
    double end_s = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), end_s);
    return end_time(end_s, where_);
  }

  void take_tracker(const devices::XdfStream& stream) {
    std::vector<devices::XdfChannel> expected = tracker_channels(stream.name);
    const auto since = expected.end() - kTrackerChannelsSince;
    if (stream.channels.size() == expected.size() - std::size_t{kTrackerChannelsSince}) {
      expected.erase(since, expected.end());
    }
    StreamRow row(stream, expected, where_);
    const std::optional<std::int32_t> station = station_called(stream.name);
    if (!station) row.fail("expected the name of a receiver");
    for (std::size_t i = 0; i < stream.times.size(); ++i) {
      row.go_to(i);
      samples_.emplace_back(row.whole("order"), tracker_at(row, *station));
    }
  }

  void take_mouse(const devices::XdfStream& stream) {
    StreamRow row(stream, kMouseChannels, where_);
    for (std::size_t i = 0; i < stream.times.size(); ++i) {
      row.go_to(i);
      samples_.emplace_back(row.whole("order"), mouse_at(row));
    }
  }

  const devices::XdfStream* stream_of(std::string_view type) const {
    const auto found = std::ranges::find(file_.streams, type, &devices::XdfStream::type);
    return found == file_.streams.end() ? nullptr : &*found;
  }

  void take_events() {
    const devices::XdfStream *kinds = stream_of(kMarkers), *bodies = stream_of(kEventBodies),
                             *details = stream_of(kEventDetails), *values = stream_of(kEventValues);
    if (!kinds || !bodies || !details || !values) return;
    StreamRow kind(*kinds, kMarkerChannels, where_), body(*bodies, kBodiesChannels, where_),
        detail(*details, kDetailChannels, where_), value(*values, kValueChannels, where_);
    const std::size_t count = std::min(
        {kinds->times.size(), bodies->times.size(), details->times.size(), values->times.size()});
    for (std::size_t i = 0; i < count; ++i) {
      for (StreamRow* row : {&kind, &body, &detail, &value}) row->go_to(i);
      if (!is_outside(value.whole("tick"), kind.word("kind"))) continue;
      Event event;
      event.time = kind.time();
      event.kind = kind.word("kind");
      event.bodies = bodies_in(body.word("bodies"));
      event.detail = Detail::read(event.kind, detail.word("detail"));
      event.p_W = {value.number("x_m"), value.number("y_m"), value.number("z_m")};
      event.j_W = {value.number("impulse_x_ns"), value.number("impulse_y_ns"),
                   value.number("impulse_z_ns")};
      event.value = value.number("value");
      trial_.events.push_back(std::move(event));
    }
  }

  const devices::XdfFile& file_;
  std::string_view where_;
  std::vector<Ordered> samples_;
  XdfTrial trial_;
};

}  // namespace

std::vector<devices::XdfWriter::Count> write_xdf_trial(
    const TrialFile& trial, const XdfSetting& setting,
    const std::function<void(std::string_view)>& put) {
  TrialToXdf out(trial.summary(), setting, put);
  trial.walk([&](const TrialFile::Item& item) {
    if (const auto* sample = std::get_if<devices::Sample>(&item)) out.add(*sample);
    return true;
  });
  return out.finish();
}

bool is_xdf_trial(const devices::XdfBytes& bytes) {
  const std::optional<devices::XmlElement> header = xdf_header(bytes);
  return header && header->find({"headpin"});
}

XdfTrial read_xdf_trial(const devices::XdfBytes& bytes, std::string_view where) {
  const devices::XdfFile file =
      devices::read_xdf(bytes, where, [](const devices::XdfStream&) { return true; });
  if (!file.header.find({"headpin"})) {
    throw std::invalid_argument(fmt::format("{}: expected a trial, found no header of one", where));
  }
  return TrialFromXdf(file, where).read();
}

}  // namespace headpin::scene
