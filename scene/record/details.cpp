#include "scene/record/details.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/record/events.h"

namespace headpin::scene {

namespace {

using nlohmann::json;

json as_list(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

json to_json(const Released& released) {
  json object = json::object();
  if (released.trigger_s) object["trigger_s"] = *released.trigger_s;
  if (released.p_WB) object["position_m"] = as_list(*released.p_WB);
  if (released.v_WB) object["velocity_mps"] = as_list(*released.v_WB);
  if (released.w_WB) object["spin_radps"] = as_list(*released.w_WB);
  if (released.known) object["known"] = known_word(released);
  if (released.extrapolated) object["extrapolated_s"] = nearest_seconds(*released.extrapolated);
  if (released.left_out) object["left_out"] = *released.left_out;
  return object;
}

json to_json(const FirstContact& contact) {
  return {{"velocity_mps", as_list(contact.v_WB)}};
}

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
    {"loft_end_m", &BallPath::loft_end}, {"skid_end_m", &BallPath::skid_end},
    {"hook_end_m", &BallPath::hook_end}, {"exit_board", &BallPath::exit_board},
    {"gutter_m", &BallPath::gutter},     {"flare_mm", &BallPath::flare_mm}};

json to_json(const Delivered& delivered) {
  json object;
  for (const auto& [key, member] : kDelivered) object[key] = delivered.*member;
  return object;
}

json to_json(const BallPath& path) {
  json object{{"release", to_json(path.release)}};
  for (const auto& [key, member] : kOfPath) {
    if (path.*member) object[key] = *(path.*member);
  }
  if (path.breakpoint) {
    object["breakpoint_board"] = path.breakpoint->board;
    object["breakpoint_m"] = path.breakpoint->distance;
  }
  if (path.entry) object["entry"] = to_json(*path.entry);
  return object;
}

json to_json(const PassedPlayer& passed) {
  return {{"noticed_s", passed.noticed_s},
          {"time_to_contact_s", passed.time_to_contact_s},
          {"foreseen_m", passed.foreseen_m},
          {"at_hand", passed.at_hand},
          {"head_away_mps2", passed.head_away_mps2},
          {"hand_away_mps2", passed.hand_away_mps2},
          {"moved", passed.moved}};
}

json to_json(const KeptPace& pace) {
  return {{"ticks", pace.ticks},
          {"overruns", pace.overruns},
          {"frames", pace.frames},
          {"late_frames", pace.late_frames},
          {"drawing_failures", pace.drawing_failures}};
}

json to_json(const render::Fingerprint& drawn_by) {
  return {{"renderer", drawn_by.renderer},
          {"processor", drawn_by.processor},
          {"environment", drawn_by.environment},
          {"test_picture", fmt::format("{:016x}", drawn_by.picture)}};
}

/// The text that a trial stores of a value.
struct StoredText {
  std::string operator()(const std::string& text) const { return text; }
  std::string operator()(const BallOfFrame& counted) const {
    return fmt::format("frame {} ball {}", counted.frame, counted.ball);
  }
  template <Choice T>
  std::string operator()(const T& value) const {
    return std::string(name_of(value));
  }
  template <typename T>
  std::string operator()(const T& value) const {
    return to_json(value).dump(-1, ' ', false, json::error_handler_t::replace);
  }
};

std::optional<double> number_at(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::int64_t count_at(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

bool is_true_at(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && *found == true;
}

std::optional<Vec3> vector_at(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    v[static_cast<Eigen::Index>(i)] = (*found)[i].get<double>();
  }
  return v;
}

void take_known(const json& object, Released& released) {
  const auto found = object.find("known");
  if (found == object.end() || !found->is_string() || *found == "") return;
  const std::string word = found->get<std::string>();
  released.known = value_named<Known>(word);
  if (released.known) return;
  released.known = Known::impossible;
  released.other_known = word;
}

std::optional<Released> released_in(const json& object) {
  Released found{.trigger_s = number_at(object, "trigger_s"),
                 .p_WB = vector_at(object, "position_m"),
                 .v_WB = vector_at(object, "velocity_mps"),
                 .w_WB = vector_at(object, "spin_radps"),
                 .known = std::nullopt,
                 .extrapolated = std::nullopt,
                 .left_out = std::nullopt};
  take_known(object, found);
  if (const auto seconds = number_at(object, "extrapolated_s")) {
    found.extrapolated = microseconds(*seconds);
  }
  const auto left_out = number_at(object, "left_out");
  if (left_out && std::abs(*left_out) <= std::numeric_limits<int>::max()) {
    found.left_out = static_cast<int>(*left_out);
  }
  return found;
}

std::optional<FirstContact> first_contact_in(const json& object) {
  const std::optional<Vec3> v_WB = vector_at(object, "velocity_mps");
  return v_WB ? std::optional(FirstContact{*v_WB}) : std::nullopt;
}

std::optional<Delivered> delivered_at(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_object()) return std::nullopt;
  Delivered delivered;
  for (const auto& [name, member] : kDelivered) {
    const std::optional<double> value = number_at(*found, name);
    if (!value) return std::nullopt;
    delivered.*member = *value;
  }
  return delivered;
}

std::optional<BallPath> ball_path_in(const json& object) {
  const std::optional<Delivered> release = delivered_at(object, "release");
  if (!release) return std::nullopt;
  BallPath path;
  path.release = *release;
  for (const auto& [key, member] : kOfPath) path.*member = number_at(object, key);
  const auto board = number_at(object, "breakpoint_board");
  const auto distance = number_at(object, "breakpoint_m");
  if (board && distance) path.breakpoint = LanePlace{*board, *distance};
  path.entry = delivered_at(object, "entry");
  return path;
}

std::optional<PassedPlayer> passed_player_in(const json& object) {
  const auto number = [&](const char* key) { return number_at(object, key).value_or(0.0); };
  return PassedPlayer{.noticed_s = number("noticed_s"),
                      .time_to_contact_s = number("time_to_contact_s"),
                      .foreseen_m = number("foreseen_m"),
                      .at_hand = is_true_at(object, "at_hand"),
                      .head_away_mps2 = number("head_away_mps2"),
                      .hand_away_mps2 = number("hand_away_mps2"),
                      .moved = is_true_at(object, "moved")};
}

std::optional<PhaseEnergies> energies_in(const json& object) {
  const auto number = [&](const char* key) { return number_at(object, key).value_or(0.0); };
  return PhaseEnergies{.gravity_j = number("gravity_j"),
                       .hand_j = number("hand_j"),
                       .impact_j = number("impact_j"),
                       .sustained_j = number("sustained_j"),
                       .correction_j = number("correction_j")};
}

std::optional<KeptPace> kept_pace_in(const json& object) {
  return KeptPace{.ticks = count_at(object, "ticks"),
                  .overruns = count_at(object, "overruns"),
                  .frames = count_at(object, "frames"),
                  .late_frames = count_at(object, "late_frames"),
                  .drawing_failures = count_at(object, "drawing_failures")};
}

/// The number that is all of a text.
template <typename T>
std::optional<T> all_of_it(std::string_view text, int base = 10) {
  T number{};
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number, base);
  return error == std::errc{} && end == last ? std::optional(number) : std::nullopt;
}

std::optional<render::Fingerprint> drawn_by_in(const json& object) {
  try {
    const std::string picture = object.at("test_picture");
    const auto hash = all_of_it<std::uint64_t>(picture, 16);
    if (!hash) return std::nullopt;
    return render::Fingerprint{object.at("renderer").get<std::string>(),
                               object.at("processor").get<std::vector<std::string>>(),
                               object.at("environment").get<std::vector<std::string>>(), *hash};
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

using MaybeValue = std::optional<Detail::Value>;

/// @param value_of  reads a JSON object
template <auto value_of>
MaybeValue in_object(const std::string& text) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  return value_of(object);
}

template <Choice T>
MaybeValue in_name(const std::string& text) {
  return value_named<T>(text);
}

/// "frame 2 ball 1".
MaybeValue counted_ball_in(const std::string& text) {
  constexpr std::string_view kFrame = "frame ", kBall = " ball ";
  const std::size_t second = text.find(kBall);
  if (!text.starts_with(kFrame) || second == std::string::npos || second < kFrame.size()) {
    return std::nullopt;
  }
  const std::string_view all = text;
  const auto frame = all_of_it<std::size_t>(all.substr(kFrame.size(), second - kFrame.size()));
  const auto ball = all_of_it<std::size_t>(all.substr(second + kBall.size()));
  if (!frame || !ball) return std::nullopt;
  return BallOfFrame{*frame, *ball};
}

struct DetailKind {
  std::string_view name;
  MaybeValue (*value_in)(const std::string& text);
};

/// The kinds of events whose details are more than text.
constexpr auto kDetailKinds = std::to_array<DetailKind>({
    {kind::release, in_object<released_in>},
    {kind::first_contact, in_object<first_contact_in>},
    {kind::ball_path, in_object<ball_path_in>},
    {kind::skittle_down, in_name<By>},
    {kind::version, in_name<Colour>},
    {kind::game, in_name<GameKind>},
    {kind::delivery, counted_ball_in},
    {kind::dead_wood, counted_ball_in},
    {kind::set_again, counted_ball_in},
    {kind::passed_player, in_object<passed_player_in>},
    {kind::tracking_lost, in_name<TrackedPart>},
    {kind::tracking_back, in_name<TrackedPart>},
    {kind::ledger, in_object<energies_in>},
    {kind::kept_pace, in_object<kept_pace_in>},
    {kind::drawn_by, in_object<drawn_by_in>},
});

}  // namespace

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

void set_motion(Released& released, const Motion& motion) {
  released.v_WB = motion.V_WB.v;
  released.w_WB = motion.V_WB.w;
  released.known = motion.known;
  released.other_known.clear();
  released.extrapolated = motion.extrapolated;
  released.left_out = motion.left_out;
}

nlohmann::json to_json(const PhaseEnergies& energies) {
  return {{"gravity_j", energies.gravity_j},
          {"hand_j", energies.hand_j},
          {"impact_j", energies.impact_j},
          {"sustained_j", energies.sustained_j},
          {"correction_j", energies.correction_j}};
}

Detail Detail::read(std::string_view kind, std::string text) {
  const auto found = std::ranges::find(kDetailKinds, kind, &DetailKind::name);
  MaybeValue value = found != kDetailKinds.end() ? found->value_in(text) : std::nullopt;
  if (!value) return Detail(std::move(text));
  Detail detail(std::move(*value));
  if (detail.text() != text) detail.as_read_ = std::move(text);
  return detail;
}

std::string Detail::text() const {
  return as_read_.empty() ? std::visit(StoredText{}, value_) : as_read_;
}

std::optional<Motion> motion_of(const Detail& detail) {
  const auto* r = detail.get_if<Released>();
  if (!r || !r->v_WB || !r->w_WB || !r->known || !r->extrapolated || !r->left_out) {
    return std::nullopt;
  }
  return Motion{{*r->v_WB, *r->w_WB}, *r->known, *r->extrapolated, *r->left_out};
}

}  // namespace headpin::scene
