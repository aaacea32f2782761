#pragma once

#include <array>
#include <string_view>

#include "scene/record/trial.h"

/// What can happen in a session: the kinds of Event, with their meanings.
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
inline constexpr std::string_view set_again = "set_again";
inline constexpr std::string_view delivery = "delivery";
inline constexpr std::string_view ball_path = "ball_path";
inline constexpr std::string_view frame = "frame";
inline constexpr std::string_view game_over = "game_over";
inline constexpr std::string_view flies_at_player = "flies_at_player";
inline constexpr std::string_view passed_player = "passed_player";
inline constexpr std::string_view tracking_lost = "tracking_lost";
inline constexpr std::string_view tracking_back = "tracking_back";
inline constexpr std::string_view ledger = "ledger";
inline constexpr std::string_view game_hash = "game_hash";
inline constexpr std::string_view drawn_by = kDrawnByEvent;
inline constexpr std::string_view drawing_failed = "drawing_failed";
inline constexpr std::string_view kept_pace = "kept_pace";
inline constexpr std::string_view played_with = "played_with";
inline constexpr std::string_view recentred = "recentred";
inline constexpr std::string_view paused = "paused";
inline constexpr std::string_view not_stored = "not_stored";
inline constexpr std::string_view source_amiss = "source_amiss";
inline constexpr std::string_view imported = "imported";
inline constexpr std::string_view import_note = "import_note";
inline constexpr std::string_view session_end = "session_end";
inline constexpr std::string_view grab_found = "grab_found";
inline constexpr std::string_view release_found = "release_found";
inline constexpr std::string_view not_measured = "not_measured";
inline constexpr std::string_view incomplete = "incomplete";
}  // namespace kind

/// One kind, for people.
struct EventKind {
  std::string_view name;
  std::string_view when;
  std::string_view point;  ///< what `point` is, in the world; empty where it is not used
  std::string_view value;  ///< what `value` is; empty where it is not used
};

inline constexpr auto kEventKinds = std::to_array<EventKind>({
    {kind::grab, "the hand grabbed a ball or a skittle with the trigger", "its centre", ""},
    {kind::release,
     "the hand released what it held: detail has time, place, velocity, spin and how they are "
     "known (tracked, extrapolated and how long, impossible; samples left out) as JSON",
     "its centre", "speed at the release [m/s]"},
    {kind::first_contact,
     "a ball touched a skittle for the first time since its release or since the skittles were "
     "set; detail has its velocity just before as JSON",
     "of the contact", "the ball's speed just before [m/s]"},
    {kind::touch, "two bodies touched for the first time, at least one of them a skittle",
     "of the contact", "speed they approached each other with [m/s]"},
    {kind::ball_touch, "a ball touched the lane, a wall or a front block for the first time",
     "of the contact", "speed they approached each other with [m/s]"},
    {kind::hand_touch, "the hand touched a ball or a skittle for the first time", "of the contact",
     "speed they approached each other with [m/s]"},
    {kind::missed_grab, "the trigger was pressed, but no body was within the hand's reach",
     "the centre of the nearest body", "distance of its surface from the hand [m]"},
    {kind::skittle_down,
     "a skittle leaned by more than 20 degrees; detail has the cause: ball, hand (or what it carries) "
     "or stray ball",
     "the skittle's centre of mass", "number of skittles down so far"},
    {kind::version, "the hand touched a button: that version begins (detail: red or blue)",
     "the button", ""},
    {kind::game, "a game begins; detail has its rules", "", "number of skittles that are set"},
    {kind::foul, "a ball was released beyond the foul line", "its centre",
     "distance beyond the line [m]"},
    {kind::dead_wood,
     "when a ball was counted, the skittles that the hand or what it carried had knocked down were "
     "removed; bodies has their names",
     "", "their number"},
    {kind::set_again,
     "when a ball was counted, the skittles that it had knocked down as a stray ball were set up "
     "again; bodies has their names",
     "", "their number"},
    {kind::delivery, "a ball was counted; bodies has the skittles that it knocked down", "",
     "number that counts: 0 after a foul if the rules say so"},
    {kind::ball_path,
     "a thrown ball left the lane, came to rest or was counted, or its game or the trial ended; "
     "detail has its way in the words of coaches as JSON: release, end of loft, skid and hook, "
     "breakpoint, entry, exit, track flare; boards count from the right gutter, distances from the "
     "foul line, angles to the right",
     "its centre", ""},
    {kind::ball_back, "a ball came back to its stand", "its stand", ""},
    {kind::frame, "a frame of the game ended", "", "its number, from 1"},
    {kind::game_over, "the last frame ended; detail has the score sheet", "", "points"},
    {kind::flies_at_player,
     "a ball or a skittle began to fly at the player: within a second it would come nearer than "
     "0.4 m to head, hand or body (below the head), at more than 1 m/s",
     "its centre", "time until the closest approach, if both keep their velocities [s]"},
    {kind::passed_player,
     "0.3 s after the body had passed: detail has the approach that was expected, and how head and "
     "hand accelerated away, as JSON",
     "its centre", "closest approach of its surface to head, hand or body [m]"},
    {kind::tracking_lost,
     "head or hand (detail) has had no usable sample for 0.25 s: its last pose stays. If "
     "`rig.away_after_s` is not 0, it is that time for the hand, which then is away",
     "", "time since its last sample [s]"},
    {kind::tracking_back, "head or hand (detail) has a usable sample again", "",
     "time without one [s]"},
    {kind::ledger, "after the last tick: detail has the sources and sinks of energy as JSON", "",
     ""},
    {kind::game_hash,
     "after the last tick: detail has the hash of all ticks (docs/hash-and-ledger.md)", "", ""},
    {kind::drawn_by,
     "before the first tick of a live session: detail has what draws its frames, as JSON: "
     "renderer, processor features, Mesa's environment variables, hash of a test picture",
     "", ""},
    {kind::drawing_failed,
     "the process that draws a live session's frames ended or failed, and was started again; the "
     "session continued; detail has the reason",
     "", ""},
    {kind::played_with,
     "in a session that a browser played: detail has the device, the browser, and of a headset its "
     "name, frame rate and the angles of its views, as JSON",
     "", ""},
    {kind::recentred,
     "in a session that a browser played: from here on, poses count from another place; detail has "
     "its pose in the headset's own space as JSON",
     "", ""},
    {kind::paused,
     "in a session that a browser played: the session's clock stood still here, because the page "
     "was hidden or made no ticks for over 0.25 s",
     "", "its length [s]"},
    {kind::not_stored,
     "in a session that a browser played: from here on the browser could not store the log, which "
     "was kept in memory; detail has the reason",
     "", ""},
    {kind::source_amiss,
     "a live session left out samples of a source, or had to set their times itself: detail has "
     "the source, the reason and the number so far; at most every ten seconds",
     "", ""},
    {kind::kept_pace,
     "after the last tick of a live session: detail says whether it kept up with real time, as "
     "JSON: overruns, ticks, late_frames, frames, drawing_failures",
     "", ""},
    {kind::imported,
     "in an imported recording: detail has the name of the file, and of several throws the number "
     "of this one",
     "", "time in the file that is 0 s of the trial [s]"},
    {kind::import_note, "in an imported recording: detail has a note of the import about its data",
     "", ""},
    {kind::session_end,
     "in an imported session: it went on until this time, after its last sample, and so does a replay",
     "", ""},
    {kind::grab_found,
     "in a recording without buttons: the program found that a hand grabbed the ball here", "", ""},
    {kind::release_found,
     "in a recording without buttons: the program found that the hand released the ball here", "",
     ""},
    {kind::not_measured,
     "in an imported recording: detail says what was not measured, and which value is in its place",
     "", ""},
    {kind::incomplete,
     "after the last tick, in a trial that was simulated from an incomplete one: detail says what is missing of "
     "that one",
     "", ""},
    {kEndEvent, "last message of a finished log", "", "number of messages before it"},
});

}  // namespace headpin::scene
