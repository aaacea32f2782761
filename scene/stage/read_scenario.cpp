#include "scene/stage/read_scenario.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "scene/scenario/files.h"
#include "scene/scenario/text.h"
#include "scene/scenario/toml_text.h"
#include "scene/stage/chosen_checks.h"
#include "scene/stage/mesh_measure.h"
#include "scene/stage/outline.h"
#include "scene/stage/scenario_checks.h"
#include "scene/stage/seen_mesh.h"

namespace headpin::scene {

namespace {

/// Completes the parts of skittles, with corners from files if the text names them. A mesh that is not
/// convex becomes several parts, which all are at its line.
void take_parts(Scenario& scenario, ScenarioText& text) {
  constexpr std::size_t kMostParts = 16;  // as text.cpp reads
  const auto key_of_part = [](std::size_t i) { return fmt::format("skittle.parts[{}]", i + 1); };
  const std::vector<SkittlePart> given = std::exchange(scenario.skittle.parts, {});
  std::map<std::string, int> lines;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string key = key_of_part(i);
    std::vector<SkittlePart> parts{given[i]};
    if (text.has(key)) {
      const std::size_t most = kMostParts - scenario.skittle.parts.size() - (given.size() - i - 1);
      try {
        if (given[i].shape == PartShape::polyhedron)
          parts = polyhedra_of_part(given[i], text.folder, most);
      } catch (const std::exception& e) {
        throw std::invalid_argument(
            fmt::format("{}: skittle.parts: {}", text.place(key), e.what()));
      }
      if (!(parts[0].low < parts[0].high)) {
        throw std::invalid_argument(fmt::format(
            "{}: skittle.parts, part {}: low must be below high, found low {} and high {}",
            text.place(key), i + 1, parts[0].low, parts[0].high));
      }
    }
    for (SkittlePart& part : parts) {
      scenario.skittle.parts.push_back(std::move(part));
      if (text.has(key)) {
        lines[key_of_part(scenario.skittle.parts.size() - 1)] = text.lines.at(key);
      }
    }
  }
  for (const auto& [key, line] : lines) text.lines[key] = line;
}

/// Refuses a height that no skittle has and a mesh that does not stand on its base, and names the unit
/// and the axes with which it would.
void require_skittle_stands(const Scenario& scenario, const ScenarioText& text) {
  constexpr double kLeast = 0.05, kMost = 2.0;  // heights [m]
  constexpr double kOff = 1e-3;                 // how far off its base may be [m]
  const double height = scenario.skittle.height;
  std::vector<Vec3> points;
  double low = height;
  MeshMeasure measure;
  for (const SkittlePart& part : scenario.skittle.parts) {
    low = std::min(low, part.low);
    if (part.shape != PartShape::polyhedron) continue;
    points.insert(points.end(), part.corners.begin(), part.corners.end());
    measure = {part.mesh.unit, part.mesh.axes};
  }
  if (height >= kLeast && height <= kMost && std::abs(low) <= kOff) return;
  const std::string offer = offer_of_measure(points, measure);
  if (!(height >= kLeast && height <= kMost)) {
    throw std::invalid_argument(fmt::format("{}: skittle.parts: {:.6g} m high, expected {} to {}{}",
                                            text.place("skittle.parts"), height, kLeast, kMost,
                                            offer));
  }
  throw std::invalid_argument(fmt::format(
      "{}: skittle.parts must begin at the base, 0; found {:.4g} as the lowest{}",
      text.place("skittle.parts"), low,
      offer.empty() ? "; move the mesh so that the middle of its base is at 0, 0, 0" : offer));
}

/// What a file does not say of a skittle that it gives by polyhedra follows from these: its height, its
/// profile, what its mass properties are of, and what is seen.
void follow_polyhedra(Scenario& scenario, const ScenarioText& text) {
  Skittle& skittle = scenario.skittle;
  const bool polyhedra = std::ranges::any_of(
      skittle.parts, [](const SkittlePart& part) { return part.shape == PartShape::polyhedron; });
  if (text.whole || text.one_line || !text.has("skittle.parts") || !polyhedra) return;
  if (!text.has("skittle.height")) {
    skittle.height = 0.0;
    for (const SkittlePart& part : skittle.parts) {
      skittle.height = std::max(skittle.height, part.high);
    }
  }
  require_skittle_stands(scenario, text);
  if (text.has("skittle.profile")) return;
  skittle.profile = profile_of_parts(skittle.parts, skittle.height);
  if (!text.has("skittle.weighed")) skittle.weighed = Weighed::parts;
  if (!text.has("skittle.seen") && !text.has("skittle.mesh.file"))
    skittle.seen = SeenSkittle::collider;
}

/// Whether a text gives a mesh another size, by its unit, its axes, or what it is to be as large as.
bool is_measured_anew(const ScenarioText& text, const std::string& object) {
  return text.has(object + ".mesh.unit") || text.has(object + ".mesh.axes") ||
         (object == "ball" && text.has("ball.radius")) ||
         (object == "skittle" && text.has("skittle.height"));
}

/// A mesh that other values do not fit; those that follow may.
struct MeshMisfit : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Completes the visible meshes: reads files that a text names, and finds those of a trial again. A hash
/// that is given is checked, whether it comes with the file, before it or after it. A file that is not there is
/// not missed where only its size is in question: a trial replays without it.
/// @throws MeshMisfit             for a mesh that is larger or smaller than it must be
/// @throws std::invalid_argument  for a file that cannot be read, or has another hash
void take_meshes(Scenario& scenario, const ScenarioText& text, const Scenario& before) {
  for (const auto& [object, mesh, earlier, reach] :
       {std::tuple{"room", &scenario.room.mesh, &before.room.mesh, kReachOfRoom},
        {"skittle", &scenario.skittle.mesh, &before.skittle.mesh,
         reach_of_skittle(scenario.skittle)},
        {"ball", &scenario.ball.mesh, &before.ball.mesh, reach_of_ball(scenario.ball)},
        {"hand", &scenario.hand.mesh, &before.hand.mesh, kReachOfHand}}) {
    const std::string key = fmt::format("{}.mesh", object);
    const bool named = text.has(key + ".file"), hashed = text.has(key + ".sha256");
    const bool measured = !text.whole && is_measured_anew(text, object) && is_still_there(*mesh);
    if (mesh->file.empty()) {
      if (named && (text.whole || !hashed)) mesh->sha256.clear();  // it belongs to no file
      continue;
    }
    if (!named && !hashed && !measured) continue;
    if (text.whole) {
      find_again(*mesh, text.folder / "trial");
      continue;
    }
    if (named && !hashed && !earlier->file.empty())
      mesh->sha256.clear();  // it belongs to the earlier file
    const auto why = [&](const std::exception& e) {
      return fmt::format("{}: {}: {}", text.place(key + (named ? ".file" : ".sha256")), key,
                         e.what());
    };
    try {
      take_seen(*mesh, text.folder, reach);
    } catch (const std::invalid_argument& e) {
      throw MeshMisfit(why(e));
    } catch (const std::exception& e) {
      throw std::invalid_argument(why(e));
    }
  }
}

/// Completes a scenario after its text was read.
/// @param before  the scenario that the text changed
void complete(Scenario& scenario, ScenarioText& text, const Scenario& before = {}) {
  take_parts(scenario, text);
  follow_polyhedra(scenario, text);
  take_meshes(scenario, text, before);
}

/// Checks a scenario that a text changed.
void check(const Scenario& scenario, const ScenarioText& text) {
  check(scenario, text.where, text.one_line ? Lines{} : text.lines);
  if (!text.whole) check_chosen(scenario, text);
}

/// Completes a scenario after an assignment; whether it then fits together.
/// @throws std::invalid_argument  for what no other assignment mends
bool fits(Scenario& scenario, ScenarioText& text, const Scenario& before) {
  try {
    complete(scenario, text, before);
  } catch (const MeshMisfit&) {
    return false;
  }
  try {
    check(scenario, text);
  } catch (const std::invalid_argument&) {
    return false;
  }
  return true;
}

}  // namespace

Scenario parse_scenario(std::string_view toml, std::string_view where, const Scenario& missing) {
  Scenario scenario = missing;
  ScenarioText text{.where = std::string(where),
                    .folder = std::filesystem::path(where).parent_path()};
  read_text(scenario, toml, text);
  complete(scenario, text);
  check(scenario, text);
  return scenario;
}

Scenario scenario_of_trial(std::string_view toml, std::string_view trial) {
  Scenario scenario;
  ScenarioText text{.where = fmt::format("{} (scenario)", trial),
                    .whole = true,
                    .folder = std::filesystem::path(trial).parent_path()};
  read_text(scenario, toml, text);
  complete(scenario, text);
  check(scenario, text);
  return scenario;
}

std::string whole_scenario(std::string_view toml, std::string_view trial) {
  return to_toml(scenario_of_trial(toml, trial));
}

Scenario load_scenario(const std::string& name_or_file, const Scenario& missing) {
  const std::string path = scenario_path(name_or_file);
  return parse_scenario(read_scenario_file(path), path, missing);
}

void check(const Scenario& scenario, std::string_view where) {
  check(scenario, where, {});
}

void set(Scenario& scenario, std::string_view assignment) {
  set(scenario, assignment, brief(assignment));
}

void set(Scenario& scenario, std::string_view assignment, std::string_view where) {
  set(scenario, {{std::string(assignment), std::string(where)}});
}

void set(Scenario& scenario, const std::vector<Assignment>& assignments) {
  std::vector<ScenarioText> in_doubt;  // they may fit the values that follow
  for (const auto& [assignment, where] : assignments) {
    ScenarioText text{.where = where, .one_line = true};
    const Scenario before = scenario;
    read_assignment(scenario, assignment, text);
    if (!fits(scenario, text, before)) in_doubt.push_back(std::move(text));
  }
  for (const ScenarioText& text : in_doubt) {
    take_meshes(scenario, text, {});  // a hash that is there now was given, or is of this file
    check(scenario, text);
  }
}

}  // namespace headpin::scene
