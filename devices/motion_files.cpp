#include "devices/motion_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "devices/event_log.h"
#include "devices/motion_axes.h"
#include "devices/text_table.h"
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

/// Which of the tracks is the head, the left or the right hand.
const PoseTrack& find_part(const Tracks& tracks, std::size_t part, const MotionOptions& options,
                           const std::string& where) {
  constexpr std::array<std::array<std::string_view, 4>, 3> kWords = {
      {{"head", "hmd", "camera", "helmet"},
       {"left", "left", "left", "left"},
       {"right", "right", "right", "right"}}};
  std::vector<const PoseTrack*> found;
  std::vector<std::string> names;
  for (const auto& [sensor, track] : tracks) {
    const std::string& name = sensor;
    names.push_back(name);
    const std::string& wanted = options.names[part];
    const bool is_it =
        wanted.empty() ? std::ranges::any_of(kWords[part],
                                             [&](std::string_view word) {
                                               return lower(name).find(word) != std::string::npos;
                                             })
                       : name == wanted || name.ends_with(":" + wanted);
    if (is_it) found.push_back(&track);
  }
  // Sensors without words in their names are numbered: head, left, right.
  if (found.empty() && options.names[part].empty() && tracks.size() == 3 &&
      tracks[part].first.ends_with(":" + std::to_string(part))) {
    found.push_back(&tracks[part].second);
  }
  if (found.size() == 1) return *found.front();
  throw std::invalid_argument(fmt::format(
      "{}: expected one {} among {}; found {} (--names HEAD,LEFT,RIGHT says which)", where,
      kParts[part], names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", ")),
      found.size()));
}

MotionRecording of_parts(const Tracks& tracks, const MotionOptions& options,
                         const std::string& where) {
  const auto part = [&](std::size_t i) -> const PoseTrack& {
    return find_part(tracks, i, options, where);
  };
  return together(part(0), part(1), part(2), where);
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
          "{}: holds several trials, such as {} and {}; expected one file of the one that is meant",
          path, ending.substr(1), its.substr(1)));
    }
    ending = its;
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  Tracks tracks;
  for (const fs::path& name : files) {
    const std::string object = name.filename().string();
    tracks.push_back(
        {object.substr(0, object.size() - ending.size()), parse_uxf(text_of(name), name.string())});
  }
  return of_parts(tracks, options, path);
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

/// Where its axes point, as the first reference frame says it.
std::string axes_of(const nlohmann::json& channels) {
  if (!channels.is_object()) return "";
  const nlohmann::json frame = channels.value("reference_frame", nlohmann::json::object());
  const nlohmann::json levels =
      frame.is_object() ? frame.value("Levels", nlohmann::json::object()) : nlohmann::json();
  if (!levels.is_object() || levels.empty()) return "";
  const nlohmann::json first = levels.begin().value();
  const bool said =
      first.is_object() && first.contains("SpatialAxes") && first["SpatialAxes"].is_string();
  return said ? first["SpatialAxes"].get<std::string>() : "";
}

MotionRecording read_motion_bids(const std::string& path, const MotionOptions& options) {
  const std::string stem = path.substr(0, path.size() - kMotionTsv.size());
  const std::string said = axes_of(json_beside(stem, "_channels.json"));
  const std::string axes = options.axes.value_or(said);
  if (axes.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: expected SpatialAxes in {}_channels.json, or --axes", path, stem));
  }
  const nlohmann::json about = json_beside(stem, "_motion.json");
  double rate_hz = 0.0;
  if (about.is_object() && about.contains("SamplingFrequency") &&
      about["SamplingFrequency"].is_number()) {
    rate_hz = about["SamplingFrequency"].get<double>();
  }
  return of_parts(
      parse_motion_bids(text_of(path), text_of(stem + "_channels.tsv"), path, axes, rate_hz),
      options, path);
}

// VRPN.

bool is_vrpn(const std::string&, std::string_view begin) {
  return begin.starts_with("vrpn: ver.");
}

MotionRecording read_vrpn(const std::string& path, const MotionOptions& options) {
  const std::vector<std::uint8_t> bytes = files::read_bytes(path, kMost);
  const Axes axes(options.axes.value_or("RSP"), path);
  Tracks ours;
  for (const auto& [name, track] : parse_vrpn(bytes, path, options.unit_m.value_or(1.0))) {
    PoseTrack turned;
    for (const Stamped<Pose>& sample : track.samples()) {
      turned.push(sample.time, axes.ours(sample.value));
    }
    ours.push_back({name, std::move(turned)});
  }
  return of_parts(ours, options, path);
}

constexpr std::array<MotionFormat, 4> kFormats = {{
    {"the XR motion catalogue", "its CSV", is_catalogue, read_catalogue},
    {"UXF", "a session's folder, or one of its OBJECT_movement_T001.csv", is_uxf, read_uxf},
    {"Motion-BIDS", "..._motion.tsv", is_motion_bids, read_motion_bids},
    {"VRPN", "a connection's log", is_vrpn, read_vrpn},
}};

/// What a file of another format seems to be.
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

}  // namespace

std::span<const MotionFormat> motion_formats() {
  return kFormats;
}

MotionRecording read_motion(const std::string& path, const MotionOptions& options) {
  const std::string begin = beginning(path);
  std::vector<std::string> known;
  for (const MotionFormat& format : kFormats) {
    if (format.is_one(path, begin)) return format.read(path, options);
    known.push_back(fmt::format("{} ({})", format.name, format.files));
  }
  throw std::invalid_argument(
      fmt::format("{}: no recording of a format known here: {}; this seems "
                  "to be {}",
                  path, fmt::join(known, ", "), looks_like(path, begin)));
}

MotionRecording together(const PoseTrack& head, const PoseTrack& left, const PoseTrack& right,
                         std::string_view where) {
  const std::array<const PoseTrack*, 3> tracks = {&head, &left, &right};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!tracks[i]->samples().empty()) continue;
    throw std::invalid_argument(fmt::format("{}: no samples of the {}", where, kParts[i]));
  }
  Time begin = Time::min(), end = Time::max();
  for (const PoseTrack* track : tracks) {
    begin = std::max(begin, track->samples().front().time);
    end = std::min(end, track->samples().back().time);
  }
  constexpr Time kLongestMixed{100'000};  // as long as any gap may be
  for (std::size_t i = 1; i < 3; ++i) {
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const Time from = samples[k - 1].time, gap = samples[k].time - from;
      if (gap <= kLongestMixed || from >= end || samples[k].time <= begin) continue;
      throw std::invalid_argument(fmt::format(
          "{}: nothing of the {} for {:.3g} s from {:.3g} s on, expected no gap above 0.1", where,
          kParts[i], seconds(gap), seconds(from)));
    }
  }
  MotionRecording recording;
  for (const Stamped<Pose>& sample : head.samples()) {
    if (sample.time < begin || sample.time > end) continue;
    recording.times.push_back(sample.time - begin);
    recording.head.push_back(sample.value);
    recording.left_hand.push_back(*left.at(sample.time));
    recording.right_hand.push_back(*right.at(sample.time));
  }
  if (recording.times.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: head and hands were never recorded at the same time", where));
  }
  return recording;
}

}  // namespace headpin::devices
