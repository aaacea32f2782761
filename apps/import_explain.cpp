#include "apps/import_explain.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/import_thrown.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "scene/people/throw.h"
#include "scene/people/throw_checks.h"

namespace headpin::apps {
namespace {

using devices::MotionRecording;

/// What was found out about a file.
struct Explained {
  std::optional<devices::TableFindings> table;
  std::optional<MotionRecording> recording;
  std::vector<std::string> persons;  ///< a person in the room, at some of the samples
  std::string problem;               ///< why it cannot be imported; empty if it can
  std::string remedy;                ///< options that would make it a throw
  std::size_t throws = 0;            ///< in the file
  bool by_trigger = false;           ///< grab and release are those of a trigger
};

/// Where a level direction points, seen along another one.
std::string towards(const Vec3& gaze, const Vec3& along) {
  const Vec3 level(gaze.x(), 0.0, gaze.z()), ahead(along.x(), 0.0, along.z());
  const double up = std::asin(std::clamp(gaze.y(), -1.0, 1.0)) * 57.29577951308232;
  std::string where = "down the lane";
  if (level.norm() < 0.2) return gaze.y() < 0.0 ? "at the floor" : "at the ceiling";
  const double c = level.normalized().dot(ahead.normalized());
  const double side = ahead.cross(Vec3::UnitY()).dot(level);
  if (c < -0.7)
    where = "away from the lane";
  else if (c < 0.7)
    where = side > 0.0 ? "to the right of the lane" : "to the left of the lane";
  if (up < -20.0) where += fmt::format(", {:.0f} degrees down", -up);
  if (up > 20.0) where += fmt::format(", {:.0f} degrees up", up);
  return where;
}

std::string person_at(const MotionRecording& r, std::size_t i, const Vec3& along) {
  const Vec3 right = along.cross(Vec3::UnitY());
  std::string text = fmt::format(
      "at {:.3f} s: head {:.2f} m up, looking {}", nearest_seconds(r.times[i]), r.head[i].p.y(),
      r.head_turns ? towards(r.head[i].q * -Vec3::UnitZ(), along) : "nobody knows where");
  const auto add = [&](const char* name, const std::vector<Pose>& hand) {
    if (hand.empty()) return;
    const Vec3 p = hand[i].p - r.head[i].p;
    const double aside = p.dot(right), ahead = p.dot(along);
    text += fmt::format("; {} hand {:.2f} m up, {:.2f} m {}, {:.2f} m {}", name, hand[i].p.y(),
                        std::abs(aside), aside < 0.0 ? "left" : "right", std::abs(ahead),
                        ahead < 0.0 ? "behind" : "ahead");
  };
  add("left", r.left_hand);
  add("right", r.right_hand);
  return text;
}

/// The direction of the throw, or of the recording's -z where there is none.
Vec3 lane_of(const MotionRecording& r, const scene::Hand& hand, scene::Side side) {
  if (r.times.size() < 10 || scene::throwing_hand(r, side).empty()) return -Vec3::UnitZ();
  const Vec3 v = scene::find_throw(r, hand, side).V_TB.v;
  const Vec3 level(v.x(), 0.0, v.z());
  return level.norm() > 0.0 ? Vec3(level.normalized()) : Vec3(-Vec3::UnitZ());
}

void judge_head(const ImportOptions& options, Explained& found) {
  MotionRecording& r = *found.recording;
  std::ranges::move(scene::doubts_about_head(r), std::back_inserter(r.notes));
  if (const std::string why = scene::why_no_head(r); !why.empty())
    found.problem = fmt::format("{}: not a person's head: {}", options.file, why);
}

void judge(const ImportOptions& options, const scene::Hand& hand, Explained& found) {
  const MotionRecording& r = *found.recording;
  if (r.left_hand.empty() && r.right_hand.empty()) return judge_head(options, found);
  const Thrown thrown = thrown_in(r, options, hand);
  const std::optional<Refusal> refused = refusal(options, thrown, hand);
  if (refused) {
    found.problem = refused->why;
    found.remedy = refused->remedy;
  }
  // Numbers that are no person's may have any number of swings.
  if (!refused || refused->gap) found.throws = thrown.throws;
  found.by_trigger = thrown.recording.times.size() >= 10 &&
                     scene::find_throw(thrown.recording, hand, thrown.side).by_trigger;
  const Vec3 along = lane_of(r, hand, thrown.side);
  const std::size_t n = r.times.size();
  for (const std::size_t i : {std::size_t{0}, n / 4, n / 2}) {
    if (i < n) found.persons.push_back(person_at(r, i, along));
  }
}

bool has_columns(const std::string& file) {
  const devices::MotionFormat* format = devices::format_of(file);
  return format && format->inspect;
}

Explained find_out(const ImportOptions& options, const scene::Hand& hand) {
  Explained found;
  const devices::MotionOptions motion = declared(options);
  try {
    if (has_columns(options.file)) found.table = inspect_declared(options.file, motion);
    found.recording = recording_in(options, hand);
    judge(options, hand, found);
  } catch (const std::invalid_argument& error) {
    found.problem = error.what();
  }
  return found;
}

std::string separator_name(char separator) {
  return separator == ','    ? "commas"
         : separator == ';'  ? "semicolons"
         : separator == '\t' ? "tabs"
         : separator == '|'  ? "bars"
                             : "blanks";
}

void print_table(const devices::TableFindings& table) {
  if (table.of_streams) {
    std::cout << fmt::format("  streams            {} samples, {} columns\n", table.rows,
                             table.columns.size());
  } else {
    std::cout << fmt::format("  table              {} rows, {} columns between {}{}{}\n",
                             table.rows, table.columns.size(), separator_name(table.separator),
                             table.decimal_comma ? ", decimal commas" : "",
                             table.kind.empty() ? "" : ", as " + table.kind + " writes them");
  }
  std::size_t widest = 0;
  for (const auto& column : table.columns)
    widest = std::max(widest, std::min<std::size_t>(column.name.size(), 40));
  for (const auto& column : table.columns) {
    std::cout << fmt::format("    {:{}}  {:28} {}{}\n", printable(column.name), widest,
                             column.meaning.empty() ? "not used" : column.meaning,
                             printable(column.first.substr(0, 24)),
                             column.unit.empty() ? "" : " " + printable(column.unit));
  }
}

void print_recording(const MotionRecording& r, const Explained& found) {
  const devices::Reading& reading = r.reading;
  const double duration = r.times.empty() ? 0.0 : nearest_seconds(r.times.back() - r.times.front());
  std::cout << fmt::format("  samples            {} in {:.3f} s\n", r.times.size(), duration);
  std::cout << fmt::format(
      "  read with          {}\n",
      options_between({.unit_m = 0, .axes = "", .turning = "", .time_unit_s = 0}, reading));
  if (found.throws > 1) {
    std::cout << fmt::format("  throws             {}; --throw N takes one of them\n",
                             found.throws);
  }
  std::cout << fmt::format("  trigger            {}\n",
                           found.by_trigger ? "grab and release are those of the trigger"
                                            : "none: grab and release are found in the motion");
}

void print_explained(const ImportOptions& options, const Explained& found) {
  std::cout << printable(options.file) << '\n';
  if (found.table) print_table(*found.table);
  if (found.recording) print_recording(*found.recording, found);
  for (std::string person : found.persons) {
    for (std::size_t at = 0; (at = person.find("; ")) != std::string::npos;) {
      person.replace(at, 2, "\n                       ");
    }
    std::cout << "  person             " << person << '\n';
  }
  std::vector<std::string> notes =
      found.recording ? found.recording->notes : std::vector<std::string>{};
  if (found.table && !found.recording) notes = found.table->missing;
  for (const std::string& note : notes)
    std::cout << "  note               " << printable(note) << '\n';
  if (found.problem.empty()) {
    std::cout << "  result             can be imported\n";
  } else {
    std::cout << "  result             " << printable(found.problem) << '\n';
    if (!found.remedy.empty()) std::cout << "  try                " << found.remedy << '\n';
  }
}

void print_as_json(const ImportOptions& options, const Explained& found) {
  nlohmann::ordered_json all = {{"file", options.file}, {"can_be_imported", found.problem.empty()}};
  if (!found.problem.empty()) all["problem"] = found.problem;
  if (!found.remedy.empty()) all["try"] = found.remedy;
  if (found.table) {
    nlohmann::ordered_json columns = nlohmann::ordered_json::array();
    for (const auto& column : found.table->columns) {
      columns.push_back(
          {{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}});
    }
    all["columns"] = columns;
    all["missing"] = found.table->missing;
  }
  if (found.recording) {
    all["samples"] = found.recording->times.size();
    all["notes"] = found.recording->notes;
    all["persons"] = found.persons;
    if (found.throws > 0) all["throw_count"] = found.throws;
  }
  print_json(all);
}

}  // namespace

void explain_import(const ImportOptions& options, const scene::Scenario& scenario) {
  const Explained found = find_out(options, scenario.hand);
  if (options.output) {
    if (!found.table) {
      throw std::runtime_error(options.file + ": columns can be written for a table only");
    }
    std::vector<std::string> names;
    for (const auto& column : found.table->columns) names.push_back(column.name);
    const std::string text = mapping_text(options.file, found.table->mapping, names,
                                          found.recording ? &*found.recording : nullptr);
    base::write_text(
        {*options.output, {.overwrite = options.force, .inputs = {options.file, options.columns}}},
        text);
  }
  options.json ? print_as_json(options, found) : print_explained(options, found);
}

}  // namespace headpin::apps
