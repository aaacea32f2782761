#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <nlohmann/json_fwd.hpp>

#include "base/math.h"
#include "render/data/fingerprint.h"
#include "scene/scenario/choices.h"

/// What an event says besides its time, its place and its number: a value of the type that belongs to
/// its kind.
namespace headpin::scene {

/// How the velocity of a hand at a time is known.
enum class Known : std::uint8_t {
  tracked,       ///< there are samples before and after
  extrapolated,  ///< the motion is extrapolated from the nearest sample
  impossible     ///< no plausible sample is near enough
};
template <>
inline constexpr auto kNames<Known> =
    std::to_array<Named<Known>>({{Known::tracked, "tracked"},
                                 {Known::extrapolated, "extrapolated"},
                                 {Known::impossible, "impossible"}});

struct Motion {
  Twist V_WB;  ///< [m/s], [rad/s]; zero if impossible
  Known known = Known::impossible;
  Time extrapolated{};  ///< time of the extrapolation
  int left_out = 0;     ///< samples that disagree with the others
  /// The hand at that time, as if the samples that are left out had not come. An event does not have it.
  std::optional<Pose> X_PH = {};
};

/// "tracked"; "extrapolated by 12 ms, 1 sample left out".
std::string in_words(const Motion& motion);

/// Of a release: when, where and how the body left the hand. Older trials lack some of it.
struct Released {
  std::optional<double> trigger_s;       ///< time of the trigger, from its device
  std::optional<Vec3> p_WB, v_WB, w_WB;  ///< [m], [m/s], [rad/s]
  std::optional<Known> known;            ///< how its velocity is known
  std::optional<Time> extrapolated;
  std::optional<int> left_out;
  std::string other_known = {};  ///< the word in place of a Known, which is then `impossible`

  bool operator==(const Released&) const = default;
};
/// How its velocity is known, in the word of the text; empty where nothing tells.
std::string known_word(const Released& released);
/// Puts a motion in place of the velocities, and says how it is known.
void set_motion(Released& released, const Motion& motion);

/// Of a first contact.
struct FirstContact {
  Vec3 v_WB = Vec3::Zero();  ///< velocity of the ball just before it [m/s]

  bool operator==(const FirstContact&) const = default;
};

// The way of a thrown ball, in the words of coaches. Boards count from the right gutter, 1 to 39; 20 is
// the middle of the lane. Distances are from the foul line [m], angles to the right of the lane's axis.

/// How a ball moves at a place.
struct Delivered {
  double board = 0.0;         ///< of its centre
  double angle_deg = 0.0;     ///< of its level velocity
  double speed = 0.0;         ///< level [m/s]
  double revs_per_min = 0.0;  ///< of its spin about any axis
  /// Of the spin's level part: 0 rolls ahead, 90 hooks to the left with all of it, -90 to the right.
  double rotation_deg = 0.0;
  double tilt_deg = 0.0;  ///< of the spin's axis out of the level: 90 spins like a top

  bool operator==(const Delivered&) const = default;
};

/// A place on the lane.
struct LanePlace {
  double board = 0.0, distance = 0.0;

  bool operator==(const LanePlace&) const = default;
};

/// What is not there did not happen.
struct BallPath {
  Delivered release;
  std::optional<double> loft_end;  ///< distance at which it first touches the lane
  /// Distance at which its direction has changed by a degree since then: until here it skids, and
  /// then hooks.
  std::optional<double> skid_end;
  /// Distance at which its lowest point slips by less than a fiftieth of its speed: from here it rolls.
  std::optional<double> hook_end;
  std::optional<LanePlace> breakpoint;  ///< where its velocity turns to the other side of the lane
  /// Before its first skittle, or, if it touches none on its way ahead, where it passes the head pin.
  std::optional<Delivered> entry;
  std::optional<double> exit_board;  ///< where it leaves the lane behind the skittles
  std::optional<double> gutter;  ///< distance at which it leaves the lane sideways before its entry
  /// Track flare: largest distance on the ball between its first ring of oil and a later one.
  std::optional<double> flare_mm;

  bool operator==(const BallPath&) const = default;
};

/// Of a skittle that fell: what set it in motion.
enum class By : std::uint8_t {
  nobody,
  ball,       ///< one that was thrown
  hand,       ///< or what it carries
  stray_ball  ///< left the lane before the skittles, or came back from behind them
};
template <>
inline constexpr auto kNames<By> = std::to_array<Named<By>>(
    {{By::nobody, ""}, {By::ball, "ball"}, {By::hand, "hand"}, {By::stray_ball, "stray ball"}});

/// Of a version that begins: the colour of its button.
enum class Colour : std::uint8_t { red, blue };
template <>
inline constexpr auto kNames<Colour> = std::to_array<Named<Colour>>({{Colour::red, "red"},
                                                                     {Colour::blue, "blue"}});

/// Of a ball that was counted: its numbers, from 1.
struct BallOfFrame {
  std::size_t frame = 0, ball = 0;

  bool operator==(const BallOfFrame&) const = default;
};

/// Of a body that flew at the player: what was foreseen, and how the player moved out of its way.
struct PassedPlayer {
  double noticed_s = 0.0;
  double time_to_contact_s = 0.0, foreseen_m = 0.0;  ///< when it was noticed
  bool at_hand = false;                              ///< foreseen_m is from the hand
  double head_away_mps2 = 0.0, hand_away_mps2 = 0.0;
  bool moved = false;

  bool operator==(const PassedPlayer&) const = default;
};

/// Of tracking that was lost, or is back: whose.
enum class TrackedPart : std::uint8_t { head, hand };
template <>
inline constexpr auto kNames<TrackedPart> =
    std::to_array<Named<TrackedPart>>({{TrackedPart::head, "head"}, {TrackedPart::hand, "hand"}});

/// Of the ledger after the last tick: energy that each phase of the steps has added [J].
struct PhaseEnergies {
  double gravity_j = 0.0, hand_j = 0.0, impact_j = 0.0, sustained_j = 0.0, correction_j = 0.0;

  bool operator==(const PhaseEnergies&) const = default;
};
nlohmann::json to_json(const PhaseEnergies& energies);

/// Of a live session that ended: how well it kept up with real time.
struct KeptPace {
  std::int64_t ticks = 0, overruns = 0;
  std::int64_t frames = 0, late_frames = 0, drawing_failures = 0;

  bool operator==(const KeptPace&) const = default;
};

/// The value of one event. A trial stores it as text; these texts are written by `text()` and read
/// by `read()`, and by nothing else.
///
///     event.detail = Released{...};
///     if (const auto* told = event.detail.get_if<Released>()) ...
class Detail {
 public:
  /// It is text where it is for people (a score sheet, a reason), where it is a hash, which is only
  /// shown and compared, and where a trial has a text that its kind does not know: a damaged one, or
  /// a foreign one.
  using Value = std::variant<std::string, By, Colour, GameKind, TrackedPart, BallOfFrame, Released,
                             FirstContact, BallPath, PassedPlayer, PhaseEnergies, KeptPace,
                             render::Fingerprint>;

  Detail() = default;  ///< says nothing
  template <typename T>
  requires std::constructible_from<Value, T> Detail(T&& value) : value_(std::forward<T>(value)) {}

  /// @param text  of an event of this kind in a trial
  static Detail read(std::string_view kind, std::string text);

  /// What a trial stores: of a detail that was read, the very bytes.
  std::string text() const;

  /// Nothing if it is of another type.
  template <typename T>
  const T* get_if() const {
    return std::get_if<T>(&value_);
  }
  template <typename T>
  T value_or(T otherwise) const {
    const T* const value = get_if<T>();
    return value ? *value : otherwise;
  }

  bool operator==(const Detail&) const = default;

 private:
  Value value_;
  std::string as_read_;  ///< where the value alone would be written otherwise; else empty
};

/// Of a release that tells all of it; else nothing.
std::optional<Motion> motion_of(const Detail& detail);

/// The JSON that a trial stores of it; `is_discarded()` where its text is none.
template <typename Json>
Json stored_json(const Detail& detail) {
  return Json::parse(detail.text(), nullptr, false);
}

}  // namespace headpin::scene
