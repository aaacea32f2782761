#pragma once

#include <array>
#include <string_view>

#include "devices/trial/trial.h"

/// What can happen in a session: the kinds of devices::Event, each told here and nowhere else.
namespace headpin::scene {

namespace kind {
inline constexpr std::string_view grab = "grab";
inline constexpr std::string_view release = "release";
inline constexpr std::string_view first_contact = "first_contact";
inline constexpr std::string_view touch = "touch";
inline constexpr std::string_view ball_touch = "ball_touch";
inline constexpr std::string_view hand_touch = "hand_touch";
inline constexpr std::string_view missed_grab = "missed_grab";
inline constexpr std::string_view skittle_down = "skittle_down";
inline constexpr std::string_view version = "version";
inline constexpr std::string_view game = "game";
inline constexpr std::string_view ball_back = "ball_back";
inline constexpr std::string_view foul = "foul";
inline constexpr std::string_view dead_wood = "dead_wood";
inline constexpr std::string_view delivery = "delivery";
inline constexpr std::string_view frame = "frame";
inline constexpr std::string_view game_over = "game_over";
inline constexpr std::string_view flies_at_player = "flies_at_player";
inline constexpr std::string_view passed_player = "passed_player";
inline constexpr std::string_view ledger = "ledger";
inline constexpr std::string_view game_hash = "game_hash";
inline constexpr std::string_view drawn_by = devices::kDrawnByEvent;
inline constexpr std::string_view drawing_failed = "drawing_failed";
inline constexpr std::string_view kept_pace = "kept_pace";
inline constexpr std::string_view source_amiss = "source_amiss";
inline constexpr std::string_view grab_found = "grab_found";
inline constexpr std::string_view release_found = "release_found";
}  // namespace kind

/// One kind, for people.
struct EventKind {
  std::string_view name;
  std::string_view when;
  std::string_view point;  ///< what `point` is, in the world; empty where it is not used
  std::string_view value;  ///< what `value` is; empty where it is not used
};

inline constexpr auto kEventKinds = std::to_array<EventKind>({
    {kind::grab, "the trigger took a ball or a skittle", "its centre", ""},
    {kind::release,
     "the trigger let go of what it took: when, where, velocity, spin and how they are known "
     "(tracked, extrapolated by so long, impossible; samples left out) as JSON in detail",
     "its centre", "speed it left the hand with [m/s]"},
    {kind::first_contact,
     "a ball met a skittle for the first time since it was let go or the skittles were set; its "
     "velocity just before as JSON in detail",
     "of the contact", "the ball's speed just before [m/s]"},
    {kind::touch, "two bodies met that had not met before, one of them a skittle", "of the contact",
     "speed they approached each other with [m/s]"},
    {kind::ball_touch, "a ball met the lane, a wall or a front block for the first time",
     "of the contact", "speed they approached each other with [m/s]"},
    {kind::hand_touch, "the hand touched a ball or a skittle for the first time", "of the contact",
     "speed they approached each other with [m/s]"},
    {kind::missed_grab, "the trigger closed on nothing: nothing was within the hand's reach",
     "the centre of what was nearest", "how far its surface was from the hand [m]"},
    {kind::skittle_down,
     "a skittle leaned by more than 20 degrees; by whom in detail: ball, hand or what it carries",
     "the skittle's centre of mass", "skittles down so far"},
    {kind::version, "the hand touched a button: that version begins (red or blue in detail)",
     "the button", ""},
    {kind::game, "a game begins: its rules in detail", "", "skittles that are set"},
    {kind::foul, "a ball was let go beyond the foul line", "its centre", "how far beyond it [m]"},
    {kind::dead_wood,
     "as a ball was counted: the skittles that the hand or what it carried had felled were set "
     "aside, by name",
     "", "how many"},
    {kind::delivery, "a ball was counted: the skittles it felled, by name", "",
     "how many count: none after a foul where that is the rule"},
    {kind::ball_back, "a ball came back to its stand", "its stand", ""},
    {kind::frame, "a frame is over", "", "its number, from 1"},
    {kind::game_over, "the last frame is over: the score sheet in detail", "", "points"},
    {kind::flies_at_player,
     "a ball or a skittle began to fly at the player: nearer than 0.4 m to head, hand or what is "
     "below the head, within a second, at more than 1 m/s",
     "its centre", "when it is nearest if both go on as they do [s]"},
    {kind::passed_player,
     "0.3 s after that was over: what was foreseen and how head and hand accelerated out of its "
     "way, "
     "as JSON in detail",
     "its centre", "closest approach of its surface to head, hand or what is below the head [m]"},
    {kind::ledger, "after the last tick: where the energy came from and went to, as JSON in detail",
     "", ""},
    {kind::game_hash,
     "after the last tick: the hash of all ticks, in detail (docs/hash-and-ledger.md)", "", ""},
    {kind::drawn_by,
     "before the first tick of a live session: who draws its frames, as JSON in detail: renderer, "
     "processor features, Mesa's environment, hash of a test picture",
     "", ""},
    {kind::drawing_failed,
     "what draws a live session's frames ended or failed, and was started again: why in detail; "
     "the "
     "session went on",
     "", ""},
    {kind::source_amiss,
     "what a live session's source sent, and the session left out or had to date itself: the "
     "source, what and how much of it so far in detail; at most every ten seconds",
     "", ""},
    {kind::kept_pace,
     "after the last tick of a live session: how it kept up with time, as JSON in detail: "
     "overruns, ticks, late_frames, frames, drawing_failures",
     "", ""},
    {kind::grab_found, "in a recording without buttons: where a hand took the ball", "", ""},
    {kind::release_found, "in a recording without buttons: where it let the ball go", "", ""},
    {devices::kEndEvent, "last message of a finished log", "", "messages before it"},
});

}  // namespace headpin::scene
