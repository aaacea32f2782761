#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/non_colliding.h"
#include "render/data/quality.h"

/// The values of a scenario that are one of a few, each with the name by which texts know it.
///
/// The reader, the writer, the documents and JSON take the names from here, and nothing else
/// compares them. `collision.response` is none of these: its names are those of the engine's laws
/// (engine::responses()).
namespace headpin::scene {

template <typename T>
struct Named {
  T value;
  std::string_view name;
};

/// All values of a choice, in the order in which errors and documents list them; empty for a type
/// that is no choice.
template <typename T>
inline constexpr std::array<Named<T>, 0> kNames{};

template <typename T>
concept Choice = !kNames<T>.empty();

template <Choice T>
constexpr std::string_view name_of(T value) {
  for (const Named<T>& one : kNames<T>) {
    if (one.value == value) return one.name;
  }
  return {};
}

/// @return  nothing if no value has this name
template <Choice T>
constexpr std::optional<T> value_named(std::string_view name) {
  for (const Named<T>& one : kNames<T>) {
    if (one.name == name) return one.value;
  }
  return std::nullopt;
}

template <Choice T>
std::vector<std::string_view> names_of() {
  std::vector<std::string_view> names;
  for (const Named<T>& one : kNames<T>) names.push_back(one.name);
  return names;
}

/// The collision shape of a skittle (Uno & Slater 1997, table 1).
enum class SkittleShape : std::uint8_t {
  parts,     ///< the true shape: the compound of its parts
  ellipsoid  ///< the one ellipsoid of its height and largest width
};
template <>
inline constexpr auto kNames<SkittleShape> = std::to_array<Named<SkittleShape>>(
    {{SkittleShape::parts, "true"}, {SkittleShape::ellipsoid, "ellipsoid"}});

/// What is drawn of a skittle.
enum class SeenSkittle : std::uint8_t { profile, collider };
template <>
inline constexpr auto kNames<SeenSkittle> = std::to_array<Named<SeenSkittle>>(
    {{SeenSkittle::profile, "true"}, {SeenSkittle::collider, "collider"}});

/// What a skittle's mass properties are of.
enum class Weighed : std::uint8_t { profile, parts };
template <>
inline constexpr auto kNames<Weighed> =
    std::to_array<Named<Weighed>>({{Weighed::profile, "profile"}, {Weighed::parts, "parts"}});

/// The mass properties of a skittle that collides as an ellipsoid.
enum class WeighedEllipsoid : std::uint8_t {
  alike,  ///< those of the true shape
  itself  ///< those of the ellipsoid, as in older trials
};
template <>
inline constexpr auto kNames<WeighedEllipsoid> = std::to_array<Named<WeighedEllipsoid>>(
    {{WeighedEllipsoid::alike, "alike"}, {WeighedEllipsoid::itself, "itself"}});

enum class PartShape : std::uint8_t { ellipsoid, cylinder, cone, polyhedron };
template <>
inline constexpr auto kNames<PartShape> =
    std::to_array<Named<PartShape>>({{PartShape::ellipsoid, "ellipsoid"},
                                     {PartShape::cylinder, "cylinder"},
                                     {PartShape::cone, "cone"},
                                     {PartShape::polyhedron, "polyhedron"}});

using Detection = engine::Query::Mode;
template <>
inline constexpr auto kNames<Detection> = std::to_array<Named<Detection>>(
    {{Detection::converged, "converged"}, {Detection::paper, "paper"}});
/// That of a version: nothing for the one of the whole scenario, `collision.detection`.
template <>
inline constexpr auto kNames<std::optional<Detection>> =
    std::to_array<Named<std::optional<Detection>>>({{std::nullopt, "collision"},
                                                    {Detection::converged, "converged"},
                                                    {Detection::paper, "paper"}});

/// The plane that a query of paper detection gives at its cap.
enum class PlaneAtCap : std::uint8_t {
  best,  ///< of those that it tested
  last   ///< as in older trials
};
template <>
inline constexpr auto kNames<PlaneAtCap> =
    std::to_array<Named<PlaneAtCap>>({{PlaneAtCap::best, "best"}, {PlaneAtCap::last, "last"}});

/// The rules of a game (scene/scenario/rules.h).
enum class GameKind : std::uint8_t {
  one_throw,  ///< no game: one ball, and nothing is counted, swept or set again
  plain,      ///< skittles down are counted
  ten_pin,    ///< a strike adds the next two balls, a spare the next one
  ninepins,   ///< all skittles are set before every ball
  skittles    ///< skittles are set again within a frame when none is left
};
template <>
inline constexpr auto kNames<GameKind> =
    std::to_array<Named<GameKind>>({{GameKind::one_throw, "one-throw"},
                                    {GameKind::plain, "plain"},
                                    {GameKind::ten_pin, "ten-pin"},
                                    {GameKind::ninepins, "ninepins"},
                                    {GameKind::skittles, "skittles"}});

/// When a ball ends.
enum class BallEnds : std::uint8_t {
  rest,  ///< when all bodies are at rest and stay so
  slow   ///< at the first tick at which all are slow
};
template <>
inline constexpr auto kNames<BallEnds> = std::to_array<Named<BallEnds>>({{BallEnds::rest, "rest"},
                                                                         {BallEnds::slow, "slow"}});

/// Skittles that the hand, or what it carries, knocks down: dead wood, or counted for the ball.
enum class HandFells : std::uint8_t { apart, counted };
template <>
inline constexpr auto kNames<HandFells> =
    std::to_array<Named<HandFells>>({{HandFells::apart, "apart"}, {HandFells::counted, "counted"}});

/// Skittles that a stray ball knocks down: set up again without counting, or counted.
enum class StrayFells : std::uint8_t { apart, counted };
template <>
inline constexpr auto kNames<StrayFells> = std::to_array<Named<StrayFells>>(
    {{StrayFells::apart, "apart"}, {StrayFells::counted, "counted"}});

/// What a page does with a game that its browser cannot store.
enum class NotStored : std::uint8_t {
  goes_on,  ///< it is kept in memory alone, and the player is told so
  ends      ///< the game ends, or does not begin
};
template <>
inline constexpr auto kNames<NotStored> =
    std::to_array<Named<NotStored>>({{NotStored::goes_on, "goes-on"}, {NotStored::ends, "ends"}});

/// A ball that is released beyond the foul line.
enum class FoulBall : std::uint8_t {
  note,  ///< there is a foul event, and the ball counts
  zero,  ///< there is a foul event, and the ball counts 0
  count  ///< no event, and the ball counts
};
template <>
inline constexpr auto kNames<FoulBall> = std::to_array<Named<FoulBall>>(
    {{FoulBall::note, "note"}, {FoulBall::zero, "zero"}, {FoulBall::count, "count"}});

/// The moment whose velocity and spin a released ball gets.
enum class ReleaseAt : std::uint8_t {
  trigger,  ///< that of the trigger, from samples before and after it
  sample    ///< that of the last sample before it
};
template <>
inline constexpr auto kNames<ReleaseAt> = std::to_array<Named<ReleaseAt>>(
    {{ReleaseAt::trigger, "trigger"}, {ReleaseAt::sample, "sample"}});

/// The direction of walking: of the head or of the hand.
enum class WalkAlong : std::uint8_t { gaze, hand };
template <>
inline constexpr auto kNames<WalkAlong> =
    std::to_array<Named<WalkAlong>>({{WalkAlong::gaze, "gaze"}, {WalkAlong::hand, "hand"}});

template <>
inline constexpr auto kNames<render::LightPer> = std::to_array<Named<render::LightPer>>(
    {{render::LightPer::pixel, "pixel"}, {render::LightPer::vertex, "vertex"}});

}  // namespace headpin::scene
