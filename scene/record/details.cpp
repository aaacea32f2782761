#include "scene/record/details.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace headpin::scene {

namespace {

nlohmann::json as_list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// An object; an empty one for another text.
nlohmann::json object_in(const Event& event) {
  nlohmann::json detail = nlohmann::json::parse(event.detail, nullptr, false);
  return detail.is_object() ? detail : nlohmann::json::object();
}

std::optional<double> number_in(const nlohmann::json& detail, const char* key) {
  const auto found = detail.find(key);
  if (found == detail.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::int64_t count_in(const nlohmann::json& detail, const char* key) {
  const auto found = detail.find(key);
  return found != detail.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

std::optional<Vec3> vector_in(const nlohmann::json& detail, const char* key) {
  const auto found = detail.find(key);
  if (found == detail.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    v[static_cast<Eigen::Index>(i)] = (*found)[i].get<double>();
  }
  return v;
}

void read_known(const nlohmann::json& detail, Released& released) {
  const auto found = detail.find("known");
  if (found == detail.end() || !found->is_string() || *found == "") return;
  released.known = Known::impossible;
  for (const Known one : {Known::tracked, Known::extrapolated, Known::impossible}) {
    if (*found == name_of(one)) {
      released.known = one;
      return;
    }
  }
  released.other_known = found->get<std::string>();
}

}  // namespace

std::string_view name_of(Known known) {
  switch (known) {
    case Known::tracked:
      return "tracked";
    case Known::extrapolated:
      return "extrapolated";
    case Known::impossible:
      break;
  }
  return "impossible";
}

std::string in_words(const Motion& motion) {
  std::string words(name_of(motion.known));
  if (motion.known == Known::extrapolated) {
    words += fmt::format(" by {:.0f} ms", 1e3 * seconds(motion.extrapolated));
  }
  if (motion.left_out > 0) {
    words +=
        fmt::format(", {} sample{} left out", motion.left_out, motion.left_out == 1 ? "" : "s");
  }
  return words;
}

std::string known_word(const Released& released) {
  if (!released.other_known.empty() || !released.known) return released.other_known;
  return std::string(name_of(*released.known));
}

std::string to_detail(const Released& released) {
  nlohmann::json detail = nlohmann::json::object();
  if (released.trigger_s) detail["trigger_s"] = *released.trigger_s;
  if (released.p_WB) detail["position_m"] = as_list(*released.p_WB);
  if (released.v_WB) detail["velocity_mps"] = as_list(*released.v_WB);
  if (released.w_WB) detail["spin_radps"] = as_list(*released.w_WB);
  if (released.known) detail["known"] = known_word(released);
  if (released.extrapolated) detail["extrapolated_s"] = nearest_seconds(*released.extrapolated);
  if (released.left_out) detail["left_out"] = *released.left_out;
  return detail.dump();
}

Released released(const Event& event) {
  const nlohmann::json detail = object_in(event);
  Released found{.trigger_s = number_in(detail, "trigger_s"),
                 .p_WB = vector_in(detail, "position_m"),
                 .v_WB = vector_in(detail, "velocity_mps"),
                 .w_WB = vector_in(detail, "spin_radps"),
                 .known = std::nullopt,
                 .extrapolated = std::nullopt,
                 .left_out = std::nullopt};
  read_known(detail, found);
  if (const auto seconds = number_in(detail, "extrapolated_s")) {
    found.extrapolated = microseconds(*seconds);
  }
  if (number_in(detail, "left_out")) found.left_out = detail["left_out"].get<int>();
  return found;
}

void set_motion(Released& released, const Motion& motion) {
  released.v_WB = motion.V_WB.v;
  released.w_WB = motion.V_WB.w;
  released.known = motion.known;
  released.other_known.clear();
  released.extrapolated = motion.extrapolated;
  released.left_out = motion.left_out;
}

std::optional<Motion> motion_of(const Event& event) {
  const Released r = released(event);
  if (!r.v_WB || !r.w_WB || !r.known || !r.extrapolated || !r.left_out) return std::nullopt;
  return Motion{{*r.v_WB, *r.w_WB}, *r.known, *r.extrapolated, *r.left_out};
}

std::string contact_detail(const Vec3& v_WB) {
  return nlohmann::json{{"velocity_mps", as_list(v_WB)}}.dump();
}

std::optional<Vec3> contact_velocity(const Event& event) {
  return vector_in(object_in(event), "velocity_mps");
}

namespace {

/// The keys of a Delivered, each with its member.
constexpr std::pair<const char*, double Delivered::*> kDelivered[] = {
    {"board", &Delivered::board},
    {"angle_deg", &Delivered::angle_deg},
    {"speed_mps", &Delivered::speed},
    {"revs_per_min", &Delivered::revs_per_min},
    {"rotation_deg", &Delivered::rotation_deg},
    {"tilt_deg", &Delivered::tilt_deg}};

/// The keys of single numbers of a way.
constexpr std::pair<const char*, std::optional<double> BallPath::*> kOfPath[] = {
    {"loft_end_m", &BallPath::loft_end},
    {"skid_end_m", &BallPath::skid_end},
    {"hook_end_m", &BallPath::hook_end},
    {"exit_board", &BallPath::exit_board},
    {"gutter_m", &BallPath::gutter}};

nlohmann::json to_json(const Delivered& delivered) {
  nlohmann::json all;
  for (const auto& [key, member] : kDelivered) all[key] = delivered.*member;
  return all;
}

std::optional<Delivered> delivered_in(const nlohmann::json& detail, const char* key) {
  const auto found = detail.find(key);
  if (found == detail.end() || !found->is_object()) return std::nullopt;
  Delivered delivered;
  for (const auto& [name, member] : kDelivered) {
    const std::optional<double> value = number_in(*found, name);
    if (!value) return std::nullopt;
    delivered.*member = *value;
  }
  return delivered;
}

}  // namespace

std::string to_detail(const BallPath& path) {
  nlohmann::json detail{{"release", to_json(path.release)}};
  for (const auto& [key, member] : kOfPath) {
    if (path.*member) detail[key] = *(path.*member);
  }
  if (path.breakpoint) {
    detail["breakpoint_board"] = path.breakpoint->board;
    detail["breakpoint_m"] = path.breakpoint->distance;
  }
  if (path.entry) detail["entry"] = to_json(*path.entry);
  return detail.dump();
}

std::optional<BallPath> ball_path(const Event& event) {
  const nlohmann::json detail = object_in(event);
  const std::optional<Delivered> release = delivered_in(detail, "release");
  if (!release) return std::nullopt;
  BallPath path;
  path.release = *release;
  for (const auto& [key, member] : kOfPath) path.*member = number_in(detail, key);
  const auto board = number_in(detail, "breakpoint_board"), at = number_in(detail, "breakpoint_m");
  if (board && at) path.breakpoint = LanePlace{*board, *at};
  path.entry = delivered_in(detail, "entry");
  return path;
}

std::string to_detail(By by) {
  if (by == By::nobody) return "";
  return by == By::hand ? "hand" : "ball";
}

By felled_by(const Event& event) {
  for (const By by : {By::hand, By::ball}) {
    if (event.detail == to_detail(by)) return by;
  }
  return By::nobody;
}

std::string to_detail(const KeptPace& pace) {
  return nlohmann::json{{"ticks", pace.ticks},
                        {"overruns", pace.overruns},
                        {"frames", pace.frames},
                        {"late_frames", pace.late_frames},
                        {"drawing_failures", pace.drawing_failures}}
      .dump();
}

KeptPace kept_pace(const Event& event) {
  const nlohmann::json detail = object_in(event);
  return {.ticks = count_in(detail, "ticks"),
          .overruns = count_in(detail, "overruns"),
          .frames = count_in(detail, "frames"),
          .late_frames = count_in(detail, "late_frames"),
          .drawing_failures = count_in(detail, "drawing_failures")};
}

}  // namespace headpin::scene
