#include "devices/recordings/motion_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/input_file.h"
#include "devices/log/event_log.h"
#include "devices/recordings/any_table.h"
#include "devices/recordings/motion_bids.h"
#include "devices/recordings/same_times.h"
#include "devices/recordings/table_motion.h"
#include "devices/recordings/text_encoding.h"
#include "devices/recordings/text_table.h"
#include "devices/recordings/uxf.h"
#include "devices/recordings/vrpn_log.h"
#include "devices/recordings/xdf_motion.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;
using Tracks = std::vector<std::pair<std::string, PoseTrack>>;

constexpr std::size_t kMost = 2'000'000'000;  // bytes of a recording: hours
constexpr std::size_t kBeginning = 4096;      // bytes by which a format is known
constexpr std::string_view kLcmLog = "\xed\xa1\xda\x01";

std::string text_of(const std::string& path) {
  return read_as_utf8(path, kMost);
}

/// The tracks of a part of the body, by the given name or by words in their names.
std::vector<const PoseTrack*> tracks_of(const Tracks& tracks, std::size_t part,
                                        const std::string& wanted) {
  std::vector<const PoseTrack*> found;
  for (const auto& [name, track] : tracks) {
    const bool is_it = wanted.empty() ? part_of_name(name) == part
                                      : name == wanted || name.ends_with(":" + wanted);
    if (is_it) found.push_back(&track);
  }
  return found;
}

/// Sensors without words in their names are numbered: head, left, right; or head and the only hand.
std::optional<PartTracks> numbered(const Tracks& tracks, bool only_hand_is_left) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i].first.ends_with(":" + std::to_string(i))) return std::nullopt;
  }
  if (tracks.size() == 3)
    return PartTracks{&tracks[0].second, &tracks[1].second, &tracks[2].second};
  if (tracks.size() != 2) return std::nullopt;
  PartTracks parts{&tracks[0].second, nullptr, nullptr};
  parts[only_hand_is_left ? 1 : 2] = &tracks[1].second;
  return parts;
}

PartTracks find_parts(const MotionTracks& read, const MotionOptions& options,
                      const std::string& where) {
  const Tracks& tracks = read.tracks;
  const bool named = std::ranges::any_of(options.names, [](auto& name) { return !name.empty(); });
  std::array<std::vector<const PoseTrack*>, 3> found;
  for (std::size_t part = 0; part < 3; ++part) {
    if (named && options.names[part].empty()) continue;  // not tracked
    found[part] = tracks_of(tracks, part, read.by_part ? "" : options.names[part]);
  }
  const bool none = std::ranges::all_of(found, [](const auto& all) { return all.empty(); });
  if (none && !named) {
    if (const auto parts = numbered(tracks, options.only_hand_is_left)) return *parts;
  }
  std::vector<std::string> names;
  for (const auto& [name, track] : tracks) names.push_back(name);
  const auto refuse = [&](const std::string& expected, std::size_t count) {
    throw UnclearObjects(
        fmt::format("{}: expected one {} among {}; found {}", where, expected,
                    names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", ")), count));
  };
  PartTracks parts{};
  for (std::size_t part = 0; part < 3; ++part) {
    const bool needed = part == 0 ? !options.p_head : !options.names[part].empty();
    if (found[part].size() > 1 || (needed && found[part].empty())) {
      refuse(kPartNames[part], found[part].size());
    }
    if (!found[part].empty()) parts[part] = found[part].front();
  }
  if (!parts[1] && !parts[2] && !options.no_hand) refuse("hand", 0);
  return parts;
}

/// The track of a head that stands still, at the times of another track.
PoseTrack standing(const Vec3& p, const PoseTrack& times) {
  PoseTrack head;
  for (const Stamped<Pose>& sample : times.samples()) head.push(sample.time, {Quat::Identity(), p});
  return head;
}

// UXF: OBJECT_movement_T001.csv, a file an object and trial.

constexpr std::string_view kMovement = "_movement_";

/// "_movement_T001.csv" of a tracker's file, empty for others.
std::string uxf_ending(const fs::path& path) {
  const std::string name = path.filename().string();
  const std::size_t at = name.rfind(kMovement);
  return at == std::string::npos || !name.ends_with(".csv") ? "" : name.substr(at);
}

fs::path uxf_folder(const fs::path& path) {
  return fs::is_directory(path / "trackers") ? path / "trackers" : path;
}

bool is_uxf(const std::string& path, std::string_view begin) {
  if (!fs::is_directory(path)) {
    return !uxf_ending(path).empty() && begin.find("pos_x") != std::string_view::npos;
  }
  return std::ranges::any_of(fs::directory_iterator(uxf_folder(path)),
                             [](const auto& entry) { return !uxf_ending(entry.path()).empty(); });
}

MotionTracks read_uxf(const std::string& path, const MotionOptions& options) {
  const bool folder = fs::is_directory(path);
  const fs::path there = folder ? uxf_folder(path) : fs::absolute(path).parent_path();
  std::string ending = folder ? "" : uxf_ending(path);
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(there)) {
    const std::string its = uxf_ending(entry.path());
    if (its.empty() || (!folder && its != ending)) continue;
    if (folder && !ending.empty() && its != ending) {
      throw std::invalid_argument(fmt::format(
          "{}: contains several trials, such as {} and {}; expected a file of one trial", path,
          ending.substr(1), its.substr(1)));
    }
    ending = its;
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  MotionTracks read;
  for (const fs::path& name : files) {
    const std::string object = name.filename().string();
    read.tracks.push_back(
        {object.substr(0, object.size() - ending.size()),
         parse_uxf(text_of(name), name.string(), read.notes, options.rotations != "none")});
  }
  read.reading.axes = read.reading.turning = "RSA";  // Unity's
  return read;
}

// Motion-BIDS.

constexpr std::string_view kMotionTsv = "_motion.tsv";

bool is_motion_bids(const std::string& path, std::string_view) {
  return path.ends_with(kMotionTsv);
}

nlohmann::json json_beside(const std::string& stem, const char* ending) {
  if (!fs::exists(stem + ending)) return nullptr;
  return nlohmann::json::parse(text_of(stem + ending), nullptr, false);
}

/// Takes what ..._motion.json says of rate and missing values. The effective rate holds before the nominal one,
/// as the specification has it.
void take_about(const nlohmann::json& about, BidsFrame& frame) {
  if (!about.is_object()) return;
  for (const char* key : {"SamplingFrequencyEffective", "SamplingFrequency"}) {
    const auto rate = about.find(key);
    if (rate == about.end() || !rate->is_number() || !(rate->get<double>() > 0.0)) continue;
    frame.rate_hz = rate->get<double>();
    frame.rate_from = key;
    break;
  }
  const auto missing = about.find("MissingValues");
  if (missing == about.end()) return;
  if (missing->is_string()) frame.missing = missing->get<std::string>();
  if (missing->is_number()) frame.missing = missing->dump();
}

MotionTracks read_motion_bids(const std::string& path, const MotionOptions& options) {
  const std::string stem = path.substr(0, path.size() - kMotionTsv.size());
  const std::string channels = text_of(stem + "_channels.tsv"), levels = stem + "_channels.json";
  // What the user says holds before what the file says.
  BidsFrame frame = bids_frame(channels, fs::exists(levels) ? text_of(levels) : "", path,
                               options.reading.axes.value_or(""));
  frame.turning = options.reading.turning.value_or("");
  if (frame.axes.empty()) {
    throw std::invalid_argument(fmt::format(
        "{}: expected SpatialAxes{} in {}, or axes from the user", path,
        frame.name.empty() ? "" : fmt::format(" of reference frame '{}'", frame.name), levels));
  }
  take_about(json_beside(stem, "_motion.json"), frame);
  return parse_motion_bids(text_of(path), channels, path, frame, options.names,
                           options.rotations != "none");
}

// VRPN.

bool is_vrpn(const std::string&, std::string_view begin) {
  return begin.starts_with("vrpn: ver.");
}

MotionTracks read_vrpn(const std::string& path, const MotionOptions& options) {
  MotionTracks read;
  read.tracks =
      parse_vrpn(base::read_bytes(path, kMost), path, 1.0, read.notes, options.rotations != "none");
  read.reading.quaternion = "xyzw";
  return read;
}

// Any other table.

bool is_table(const std::string& path, std::string_view begin) {
  if (fs::is_directory(path)) return false;
  // Text: no zero bytes, and some line with three separators of one kind, or four words.
  if (begin.find('\0') != std::string_view::npos) return false;
  std::string_view rest = begin;
  while (!rest.empty()) {
    const std::string_view line = trimmed(take_front(rest, '\n'));
    for (const char separator : {',', ';', '\t', '|', ' '}) {
      if (std::ranges::count(line, separator) >= 3 &&
          std::ranges::any_of(line, [](char c) { return c >= '0' && c <= '9'; }))
        return true;
    }
  }
  return false;
}

MotionTracks read_table(const std::string& path, const MotionOptions& options) {
  return parse_motion_table(text_of(path), path, options);
}

TableFindings inspect_text(const std::string& path, const MotionOptions& options) {
  return inspect_table(text_of(path), path, options);
}

// XDF.

bool is_xdf(const std::string&, std::string_view begin) {
  return begin.starts_with(kXdfMagic);
}

MotionTracks read_xdf_file(const std::string& path, const MotionOptions& options) {
  FileWindow file(path);
  return parse_xdf_motion(bytes_of(file), path, options);
}

TableFindings inspect_xdf_file(const std::string& path, const MotionOptions& options) {
  FileWindow file(path);
  return inspect_xdf(bytes_of(file), path, options);
}

constexpr std::array<MotionFormat, 5> kFormats = {{
    {"UXF", "a session's folder, or one of its OBJECT_movement_T001.csv", is_uxf, read_uxf},
    {"Motion-BIDS", "..._motion.tsv", is_motion_bids, read_motion_bids},
    {"VRPN", "a connection's log", is_vrpn, read_vrpn},
    {"XDF", "a recording of LabRecorder", is_xdf, read_xdf_file, inspect_xdf_file},
    {"table", "any text table with a time and the poses of head and hand", is_table, read_table,
     inspect_text},
}};

/// The kind of a file of another format that is known by its first bytes; empty if it is none.
std::string known_binary(std::string_view begin) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kBeginnings = {{
      {"HIERARCHY", "BVH"},
      {"Kaydara FBX", "FBX"},
      {"\x89MCAP", "MCAP"},
      {"#ROSBAG", "a ROS bag"},
      {kLcmLog, "an LCM event log"},
      {"PK\x03\x04", "a ZIP archive"},
      {"\x1f\x8b", "compressed by gzip"},
      {"\x89HDF", "HDF5"},
      {"{", "JSON"},
      {"<?xml", "XML"},
  }};
  for (const auto& [bytes, name] : kBeginnings) {
    if (begin.starts_with(bytes)) return std::string(name);
  }
  return "";
}

/// The probable kind of a file in an unknown format.
std::string looks_like(const std::string& path, std::string_view begin) {
  if (fs::is_directory(path)) return "a folder of something else";
  if (const std::string known = known_binary(begin); !known.empty()) return known;
  if (begin.size() > 1 && begin[1] == 'P' && static_cast<unsigned char>(begin[0]) < 32)
    return "C3D";
  const std::string_view line = trimmed(begin.substr(0, begin.find('\n')));
  const bool text = std::ranges::none_of(
      line, [](char c) { return static_cast<unsigned char>(c) < 32 && c != '\t'; });
  if (!text) return "binary data";
  for (const auto& [separator, name] : {std::pair{',', "CSV"}, {'\t', "TSV"}, {';', "CSV"}}) {
    if (line.find(separator) != std::string_view::npos) {
      return fmt::format("{} that begins with '{}'", name, line.substr(0, 60));
    }
  }
  return fmt::format("text that begins with '{}'", line.substr(0, 60));
}

/// The first bytes of a file; none of a folder.
std::string beginning(const std::string& path) {
  if (fs::is_directory(path)) return "";
  FileWindow file(path);
  const std::span<const std::uint8_t> bytes = file.read(0, kBeginning);
  return as_utf8({bytes.begin(), bytes.end()}).text;
}

/// Refuses a file of no known format, and says what it is or seems to be.
[[noreturn]] void refuse_unknown(const std::string& path) {
  const std::string begin = beginning(path);
  const auto refusal = [&](const std::string& what) {
    return std::invalid_argument(path + ": " + what);
  };
  if (begin.empty() && !fs::is_directory(path)) {
    throw refusal("is empty; expected a recording (UXF, Motion-BIDS, VRPN, XDF or a table)");
  }
  if (begin.starts_with(kLcmLog)) {
    throw refusal(
        "is an LCM event log (a trial) and needs no import; expected a recording of another "
        "program");
  }
  if (begin.size() < kBeginning) require_rows(begin, path);
  std::vector<std::string> known;
  for (const MotionFormat& format : kFormats) {
    known.push_back(fmt::format("{} ({})", format.name, format.files));
  }
  throw refusal(fmt::format("seems to be {}; expected one of {}", looks_like(path, begin),
                            fmt::join(known, ", ")));
}

/// Refuses what a user says of columns and angles for a format that says them itself.
void refuse_told_columns(const MotionFormat& format, const MotionOptions& options,
                         const std::string& path) {
  if (format.inspect) return;
  const auto refuse = [&](const std::string& found) {
    throw std::invalid_argument(
        fmt::format("{}: expected nothing said of columns or angles, as {} says its own; found {}",
                    path, format.name, found));
  };
  if (!options.columns.empty()) refuse(options.columns[0].key + " = " + options.columns[0].column);
  if (options.rotations && *options.rotations != "none") refuse(*options.rotations);
  if (options.degrees) refuse(*options.degrees ? "deg" : "rad");
}

/// The tracks without their rotations.
MotionTracks without_rotations(MotionTracks read) {
  read.without_rotation.clear();
  for (auto& [name, track] : read.tracks) {
    PoseTrack level;
    for (const Stamped<Pose>& sample : track.samples())
      level.push(sample.time, {Quat::Identity(), sample.value.p});
    track = std::move(level);
    read.without_rotation.push_back(name);
  }
  read.reading.angles = "none";
  return read;
}

/// The tracks as the user says that their numbers are read.
MotionTracks as_told(MotionTracks read, const ToldReading& told, const std::string& path) {
  const Reading wanted = with(told, read.reading, path);
  if (wanted == read.reading) return read;
  const Again again(read.reading, wanted, path);
  for (auto& [name, track] : read.tracks) {
    PoseTrack turned;
    for (const Stamped<Pose>& sample : track.samples())
      turned.push(again(sample.time), again(sample.value));
    track = std::move(turned);
  }
  for (auto& trigger : read.triggers) {
    for (Stamped<bool>& change : trigger) change.time = again(change.time);
  }
  read.reading = wanted;
  return read;
}

/// The recording in a frame with its origin on the floor.
MotionRecording counted_from(const Vec3& p_origin, MotionRecording recording) {
  for (auto* track : {&recording.head, &recording.left_hand, &recording.right_hand}) {
    for (Pose& pose : *track) pose.p += p_origin;
  }
  recording.p_origin = p_origin;
  return recording;
}

}  // namespace

std::span<const MotionFormat> motion_formats() {
  return kFormats;
}

const MotionFormat* format_of(const std::string& path) {
  const std::string begin = beginning(path);
  if (!known_binary(begin).empty()) return nullptr;
  const auto format = std::ranges::find_if(
      kFormats, [&](const MotionFormat& one) { return one.is_one(path, begin); });
  return format == kFormats.end() ? nullptr : format;
}

MotionRecording recording_of(const MotionTracks& read, const MotionOptions& options,
                             const std::string& where) {
  const auto [head, left, right] = find_parts(read, options, where);
  const std::size_t thrower = throwing_part({head, left, right}, options.left_throws);
  const PoseTrack fixed =
      options.p_head && thrower != 0
          ? standing(*options.p_head - options.p_origin, thrower == 1 ? *left : *right)
          : PoseTrack{};
  const PartTracks parts = {options.p_head ? &fixed : head, left, right};
  MotionRecording recording = options.no_hand
                                  ? together(parts, 0, 0, where)
                                  : together(parts, thrower, timing_part(parts, thrower), where);
  if (read.since_start) {
    for (Time& time : recording.times) time += recording.start;
    recording.start = Time{};
  }
  recording.notes.insert(recording.notes.begin(), read.notes.begin(), read.notes.end());
  recording.reading = read.reading;
  recording.triggers = read.triggers;
  for (auto& trigger : recording.triggers) {
    for (Stamped<bool>& change : trigger) change.time -= recording.start;
  }
  const auto turns = [&](const PoseTrack* track) {
    const auto named =
        std::ranges::find_if(read.tracks, [&](const auto& one) { return &one.second == track; });
    return named == read.tracks.end() ||
           std::ranges::find(read.without_rotation, named->first) == read.without_rotation.end();
  };
  recording.head_moves = !options.p_head;
  recording.head_turns = recording.head_moves && turns(head);
  recording.hands_turn = turns(left) && turns(right);
  return recording;
}

MotionRecording read_motion(const std::string& path, const MotionOptions& options) {
  if (const MotionFormat* format = format_of(path)) {
    refuse_told_columns(*format, options, path);
    MotionTracks read = as_told(format->read(path, options), options.reading, path);
    if (options.rotations == "none") read = without_rotations(std::move(read));
    return counted_from(options.p_origin, recording_of(read, options, path));
  }
  refuse_unknown(path);
}

}  // namespace headpin::devices
