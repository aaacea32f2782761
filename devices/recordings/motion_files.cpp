#include "devices/recordings/motion_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "devices/recordings/motion_axes.h"
#include "devices/recordings/text_table.h"
#include "devices/trial/event_log.h"
#include "files/input_file.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;
using Tracks = std::vector<std::pair<std::string, PoseTrack>>;

constexpr std::size_t kMost = 2'000'000'000;  // bytes of a recording: hours

std::string text_of(const std::string& path) {
  return files::read_text(path, kMost);
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

constexpr std::array kParts = {"head", "left hand", "right hand"};

/// Words in the names of heads, left and right hands, in small letters.
bool is_called(const std::string& name, std::size_t part) {
  const std::string text = lower(name);
  const auto has = [&](std::string_view word) { return text.find(word) != std::string::npos; };
  const bool eye = has("eye");  // Unity's LeftEyeAnchor is no hand, CenterEyeAnchor the head
  if (part == 0)
    return has("head") || has("hmd") || has("camera") || has("helmet") || has("centereye");
  return !eye && has(part == 1 ? "left" : "right");
}

/// The tracks of a part of the body, by the given name or by words in their names.
std::vector<const PoseTrack*> tracks_of(const Tracks& tracks, std::size_t part,
                                        const std::string& wanted) {
  std::vector<const PoseTrack*> found;
  for (const auto& [name, track] : tracks) {
    const bool is_it =
        wanted.empty() ? is_called(name, part) : name == wanted || name.ends_with(":" + wanted);
    if (is_it) found.push_back(&track);
  }
  return found;
}

/// Head, left and right hand; null for a hand that was not tracked.
using Parts = std::array<const PoseTrack*, 3>;

/// Sensors without words in their names are numbered: head, left, right; or head and the only hand.
std::optional<Parts> numbered(const Tracks& tracks, bool only_hand_is_left) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i].first.ends_with(":" + std::to_string(i))) return std::nullopt;
  }
  if (tracks.size() == 3) return Parts{&tracks[0].second, &tracks[1].second, &tracks[2].second};
  if (tracks.size() != 2) return std::nullopt;
  Parts parts{&tracks[0].second, nullptr, nullptr};
  parts[only_hand_is_left ? 1 : 2] = &tracks[1].second;
  return parts;
}

Parts find_parts(const Tracks& tracks, const MotionOptions& options, const std::string& where) {
  const bool named = std::ranges::any_of(options.names, [](auto& name) { return !name.empty(); });
  std::array<std::vector<const PoseTrack*>, 3> found;
  for (std::size_t part = 0; part < 3; ++part) {
    if (named && options.names[part].empty()) continue;  // not tracked
    found[part] = tracks_of(tracks, part, options.names[part]);
  }
  const bool none = std::ranges::all_of(found, [](const auto& all) { return all.empty(); });
  if (none && !named) {
    if (const auto parts = numbered(tracks, options.only_hand_is_left)) return *parts;
  }
  std::vector<std::string> names;
  for (const auto& [name, track] : tracks) names.push_back(name);
  const auto refuse = [&](const std::string& expected, std::size_t count) {
    throw std::invalid_argument(
        fmt::format("{}: expected one {} among {}; found {} (--names HEAD,LEFT,RIGHT says which; a "
                    "hand may be left empty)",
                    where, expected,
                    names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", ")), count));
  };
  Parts parts{};
  for (std::size_t part = 0; part < 3; ++part) {
    const bool needed = part == 0 || !options.names[part].empty();
    if (found[part].size() > 1 || (needed && found[part].empty())) {
      refuse(kParts[part], found[part].size());
    }
    if (!found[part].empty()) parts[part] = found[part].front();
  }
  if (!parts[1] && !parts[2]) refuse("hand", 0);
  return parts;
}

MotionRecording of_parts(MotionTracks read, const MotionOptions& options,
                         const std::string& where) {
  const auto [head, left, right] = find_parts(read.tracks, options, where);
  MotionRecording recording = together(*head, left, right, where);
  recording.notes = std::move(read.notes);
  return recording;
}

// The catalogue.

bool is_catalogue(const std::string&, std::string_view begin) {
  const std::string_view line = begin.substr(0, begin.find('\n'));
  return std::ranges::any_of(catalogue_columns(), [&](const std::string& column) {
    return line.find(column) != std::string_view::npos;
  });
}

MotionRecording read_catalogue(const std::string& path, const MotionOptions& options) {
  if (options.axes ||
      std::ranges::any_of(options.names, [](auto& name) { return !name.empty(); })) {
    throw std::invalid_argument(
        path +
        ": the catalogue's CSV says itself where its axes point and what is "
        "tracked; expected neither --axes nor --names");
  }
  return parse_catalogue_csv(text_of(path), path, options.unit_m.value_or(0.01));
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

MotionRecording read_uxf(const std::string& path, const MotionOptions& options) {
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
    read.tracks.push_back({object.substr(0, object.size() - ending.size()),
                           parse_uxf(text_of(name), name.string(), read.notes)});
  }
  return of_parts(std::move(read), options, path);
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

/// The value of this name in the first reference frame; empty if it has none.
std::string said_of_frame(const nlohmann::json& channels, const char* name) {
  if (!channels.is_object()) return "";
  const nlohmann::json frame = channels.value("reference_frame", nlohmann::json::object());
  const nlohmann::json levels =
      frame.is_object() ? frame.value("Levels", nlohmann::json::object()) : nlohmann::json();
  if (!levels.is_object() || levels.empty()) return "";
  const nlohmann::json first = levels.begin().value();
  const bool said = first.is_object() && first.contains(name) && first[name].is_string();
  return said ? first[name].get<std::string>() : "";
}

MotionRecording read_motion_bids(const std::string& path, const MotionOptions& options) {
  const std::string stem = path.substr(0, path.size() - kMotionTsv.size());
  const nlohmann::json beside = json_beside(stem, "_channels.json");
  BidsFrame frame;
  frame.axes = options.axes.value_or(said_of_frame(beside, "SpatialAxes"));
  frame.rotation_order = said_of_frame(beside, "RotationOrder");
  frame.left_handed = said_of_frame(beside, "RotationRule") == "left-hand";
  if (frame.axes.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: expected SpatialAxes in {}_channels.json, or --axes", path, stem));
  }
  const nlohmann::json about = json_beside(stem, "_motion.json");
  if (about.is_object() && about.contains("SamplingFrequency") &&
      about["SamplingFrequency"].is_number()) {
    frame.rate_hz = about["SamplingFrequency"].get<double>();
  }
  return of_parts(parse_motion_bids(text_of(path), text_of(stem + "_channels.tsv"), path, frame),
                  options, path);
}

// VRPN.

bool is_vrpn(const std::string&, std::string_view begin) {
  return begin.starts_with("vrpn: ver.");
}

MotionRecording read_vrpn(const std::string& path, const MotionOptions& options) {
  const std::vector<std::uint8_t> bytes = files::read_bytes(path, kMost);
  const Axes axes(options.axes.value_or("RSP"), path);
  MotionTracks ours;
  for (const auto& [name, track] : parse_vrpn(bytes, path, options.unit_m.value_or(1.0))) {
    PoseTrack turned;
    for (const Stamped<Pose>& sample : track.samples()) {
      turned.push(sample.time, axes.ours(sample.value));
    }
    ours.tracks.push_back({name, std::move(turned)});
  }
  return of_parts(std::move(ours), options, path);
}

constexpr std::array<MotionFormat, 4> kFormats = {{
    {"the XR motion catalogue", "its CSV", is_catalogue, read_catalogue},
    {"UXF", "a session's folder, or one of its OBJECT_movement_T001.csv", is_uxf, read_uxf},
    {"Motion-BIDS", "..._motion.tsv", is_motion_bids, read_motion_bids},
    {"VRPN", "a connection's log", is_vrpn, read_vrpn},
}};

/// The probable kind of a file in an unknown format.
std::string looks_like(const std::string& path, std::string_view begin) {
  if (fs::is_directory(path)) return "a folder of something else";
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kBeginnings = {{
      {"HIERARCHY", "BVH"},
      {"XDF:", "XDF"},
      {"Kaydara FBX", "FBX"},
      {"\x89MCAP", "MCAP"},
      {"#ROSBAG", "a ROS bag"},
      {"\xed\xa1\xda\x01", "an LCM event log; a trial needs no import"},
      {"PK\x03\x04", "a ZIP archive"},
      {"\x1f\x8b", "compressed by gzip"},
      {"\x89HDF", "HDF5"},
      {"{", "JSON"},
      {"<?xml", "XML"},
  }};
  for (const auto& [bytes, name] : kBeginnings) {
    if (begin.starts_with(bytes)) return std::string(name);
  }
  if (begin.empty()) return "empty";
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
  const std::span<const std::uint8_t> bytes = file.read(0, 4096);
  return {bytes.begin(), bytes.end()};
}

/// The recording in a frame with its origin on the floor.
MotionRecording counted_from(const Vec3& p_origin, MotionRecording recording) {
  for (auto* track : {&recording.head, &recording.left_hand, &recording.right_hand}) {
    for (Pose& pose : *track) pose.p += p_origin;
  }
  return recording;
}

}  // namespace

std::span<const MotionFormat> motion_formats() {
  return kFormats;
}

MotionRecording read_motion(const std::string& path, const MotionOptions& options) {
  const std::string begin = beginning(path);
  std::vector<std::string> known;
  for (const MotionFormat& format : kFormats) {
    if (format.is_one(path, begin)) {
      return counted_from(options.p_origin, format.read(path, options));
    }
    known.push_back(fmt::format("{} ({})", format.name, format.files));
  }
  throw std::invalid_argument(
      fmt::format("{}: unknown format; known formats: {}; this seems to be {}", path,
                  fmt::join(known, ", "), looks_like(path, begin)));
}

MotionRecording together(const PoseTrack& head, const PoseTrack* left, const PoseTrack* right,
                         std::string_view where) {
  const Parts tracks = {&head, left, right};
  Time begin = Time::min(), end = Time::max();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!tracks[i]) continue;
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    if (samples.empty()) {
      throw std::invalid_argument(fmt::format("{}: no samples of the {}", where, kParts[i]));
    }
    begin = std::max(begin, samples.front().time);
    end = std::min(end, samples.back().time);
  }
  constexpr Time kLongestMixed{100'000};  // as long as any gap may be
  for (std::size_t i = 1; i < 3; ++i) {
    if (!tracks[i]) continue;
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const Time from = samples[k - 1].time, gap = samples[k].time - from;
      if (gap <= kLongestMixed || from >= end || samples[k].time <= begin) continue;
      throw std::invalid_argument(fmt::format(
          "{}: no samples of the {} for {:.3g} s from {:.3g} s, expected no gap above 0.1 s", where,
          kParts[i], seconds(gap), seconds(from)));
    }
  }
  MotionRecording recording;
  for (const Stamped<Pose>& sample : head.samples()) {
    if (sample.time < begin || sample.time > end) continue;
    recording.times.push_back(sample.time - begin);
    recording.head.push_back(sample.value);
    if (left) recording.left_hand.push_back(*left->at(sample.time));
    if (right) recording.right_hand.push_back(*right->at(sample.time));
  }
  if (recording.times.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: head and hands were never recorded at the same time", where));
  }
  return recording;
}

}  // namespace headpin::devices
