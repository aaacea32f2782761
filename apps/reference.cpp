#include "apps/reference.h"

#include <fmt/format.h>

#include "devices/base/version.h"
#include "devices/trial/tables.h"
#include "scene/play/events.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

namespace {

constexpr const char* kWritten =
    "<!-- Written by the program (`./dev docs`): change what it says in the sources. -->\n\n";

/// A cell of a table: what would end it is masked.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string code(const std::string& text) {
  return text.empty() ? "" : "`" + text + "`";
}

std::string scenario_page() {
  std::string out = fmt::format(
      "# Every key of a scenario\n\n{}Metre, kilogram, second unless a name says otherwise. What a "
      "scenario leaves out has the default: the paper's\nroom, "
      "[paper-room.toml](../assets/scenarios/paper-room.toml). Unknown keys, wrong types and "
      "values "
      "out of range are refused with\nfile and line. `[]` is an entry of a list. One value is "
      "changed by `--set KEY=VALUE`.\n\n"
      "| key | value | allowed | default | meaning | source of the default "
      "|\n|---|---|---|---|---|---|\n",
      kWritten);
  for (const scene::ScenarioKey& key : scene::scenario_keys()) {
    out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.key, key.kind, cell(key.allowed),
                       key.kind.starts_with("list") ? "as in the file" : code(key.fallback),
                       cell(key.meaning), cell(key.source));
  }
  return out;
}

std::string tables_page() {
  std::string out = fmt::format(
      "# Every column of `headpin export`\n\n{}CSV after RFC 4180: one line of names, then a row "
      "an "
      "observation. Numbers are the shortest that read back to the\nsame bits; times are exact. "
      "`yes/no` is 1 or 0, a `hash` 16 hexadecimal digits. The same list is in `columns.csv` of "
      "every export.\n",
      kWritten);
  std::string table;
  for (const devices::TableColumn& c : devices::table_columns()) {
    if (c.table != table) {
      table = c.table;
      out += fmt::format("\n## {}.csv\n\n| column | kind | unit | meaning |\n|---|---|---|---|\n",
                         table);
    }
    out += fmt::format("| `{}` | {} | {} | {} |\n", c.name, c.kind, c.unit, cell(c.meaning));
  }
  return out;
}

std::string channels_page() {
  std::string out = fmt::format(
      "# LCM channels and types\n\n{}A trial is one LCM event log; a live session speaks the same "
      "messages. Types of `headpin` unless they are said to be\nwire-compatible with another's; "
      "the "
      "`.lcm` files are in `devices/lcm/types`, in `share/headpin/types` once installed, and whole "
      "in "
      "the\nheader of every trial.\n\n| channel | type | when |\n|---|---|---|\n",
      kWritten);
  for (const ChannelUse& use : channel_uses()) {
    out += fmt::format("| `{}` | `{}` | {} |\n", use.channel, use.type, use.when);
  }
  return out + "\n```text\n" + devices::schema_text() + "```\n";
}

std::string json_page() {
  std::string out = fmt::format(
      "# Every key of `--json`\n\n{}One object on standard output, a failure too. The unit is the "
      "end of the name: `_s` seconds, `_m` metres, `_j` joules, `_hz`\nper second, `_mps` metres a "
      "second. A value that there is none of is `null`. A name means one thing, whichever command "
      "prints it.\n\n| key | meaning |\n|---|---|\n",
      kWritten);
  for (const JsonKey& key : json_keys()) {
    out += fmt::format("| `{}` | {} |\n", key.key, cell(key.meaning));
  }
  return out;
}

std::string events_page() {
  std::string out = fmt::format(
      "# Every kind of event\n\n{}On the channel `EVENT`; all but `end` in `info` and in "
      "`events.csv` too. `bodies` "
      "are those it happened to, the impulse is on the first of them.\n\n"
      "| kind | when | point (in W) | value |\n|---|---|---|---|\n",
      kWritten);
  for (const scene::EventKind& kind : scene::kEventKinds) {
    out += fmt::format("| `{}` | {} | {} | {} |\n", kind.name, kind.when, kind.point, kind.value);
  }
  return out;
}

}  // namespace

std::vector<JsonKey> json_keys() {
  return {
      {"activity", "what a source is doing"},
      {"a", "the first of two trials that are compared"},
      {"astray", "samples alone in a place that no hand gets to and back from so fast"},
      {"b", "the second"},
      {"backwards", "samples not later than the one before of the same device; kept"},
      {"bad", "samples that the device itself calls bad"},
      {"ball_diameter_m", "of a scenario's ball, across"},
      {"ball_mass_kg", "of a scenario's ball"},
      {"ball", "of a frame, from 1; null where it was not counted"},
      {"baseless", "states told by what is new since one that is not known"},
      {"bodies", "names of the bodies an event happened to"},
      {"bytes", "in messages of a channel; skipped, those that belong to no event"},
      {"capped_queries", "queries that stopped at the cap"},
      {"channels", "of a log, by name"},
      {"clock_jumps", "times that a publisher's clock jumped against the session's"},
      {"command", "that failed"},
      {"commands", "understood by the emulated unit"},
      {"commit", "that the program was built from, with + for changes on top"},
      {"complete", "all there, to the end event"},
      {"condition", "its name, as given"},
      {"contacts", "contact points, summed over all ticks"},
      {"counted", "skittles in the sheet for a throw; null without a game"},
      {"correction_j", "entry of the ledger: pushing overlaps apart"},
      {"cut_bytes", "of an event the file ends in"},
      {"damaged", "records sent with a fault in them"},
      {"deepest_overlap_m", "of any two bodies at any time"},
      {"detail", "text that belongs to an event"},
      {"detection", "`converged` or `paper`"},
      {"device", "head, right hand, left hand, 3D mouse"},
      {"devices", "of a trial"},
      {"dropped", "records left out whole because nobody read"},
      {"dropped_samples", "samples that came faster than the session took them, and were left out"},
      {"drawing_failures",
       "times that the process which draws a live session's frames ended or failed"},
      {"drawn_by", "of frames: what decides about their bits beside what is drawn"},
      {"drawn_s", "stage of the latency: until both pictures are drawn"},
      {"duration_s", "of the trial, or of the session"},
      {"elasticity", "by object; null where the versions of a game differ in it"},
      {"entry_angle_deg", "of a ball as it met its first skittle, to the right of straight on"},
      {"entry_s", "when it met that"},
      {"environment", "variables that Mesa looks at: LP_*, GALLIUM_*, MESA_*"},
      {"error", "why it failed"},
      {"events", "of a trial"},
      {"exit_code", "of a failure"},
      {"extrapolated_s", "of a release: by so long from the nearest sample of the hand"},
      {"fastest_mps", "speed with which a ball would have left the hand then"},
      {"fastest_s", "when, within half a second of its release, that is most"},
      {"felled_by_ball", "skittles, by the ball of a throw"},
      {"felled_by_hand", "skittles, by the hand or what it carried: they are in no sheet"},
      {"file", "of a scenario"},
      {"final_energy_j", "of balls and skittles after the last tick"},
      {"first_difference_body", "body that differs first; empty where one trial has no such tick"},
      {"first_difference_lacking", "the trial that has no such tick; null where both have it"},
      {"first_difference_s", "when"},
      {"first_difference_tick", "tick of the first difference; null where there is none"},
      {"foreign", "samples in another frame than the transmitter's"},
      {"format_version", "of the trial"},
      {"foul", "a ball was let go beyond the foul line; null where nothing tells"},
      {"fps", "frames a second"},
      {"frame", "of a game, from 1; null where the throw was not counted"},
      {"frames", "frames drawn, or in the trial"},
      {"from_s", "where a stretch of time begins"},
      {"frames_there_already", "of those: drawn before this began, with --resume"},
      {"friction", "by object; null where the versions of a game differ in it"},
      {"games", "score sheets, in their order"},
      {"garbage_bytes", "sent by an emulated unit for want of anything better"},
      {"grab_s", "when the ball was taken"},
      {"gravity_j", "entry of the ledger: free motion"},
      {"hand", "that threw: left or right"},
      {"hand_j", "entry of the ledger: what was put, taken, thrown or let go"},
      {"height_m", "of a skittle, of a virtual participant"},
      {"height", "of a picture, in pixels"},
      {"highest_energy_j", "of balls and skittles in any tick"},
      {"impact_j", "entry of the ledger: impulses"},
      {"impact_speed_mps",
       "of the ball of a throw, or of the first one, just before its first skittle"},
      {"impacts", "impulses given"},
      {"implausible", "messages with numbers that cannot be"},
      {"kept_pace", "how a live session kept up with time"},
      {"key", "of a scenario"},
      {"kind", "of an event, or of what is amiss"},
      {"known",
       "how a release was known: tracked, extrapolated or impossible; empty where nothing tells"},
      {"lane_m", "foul line to head pin"},
      {"largest_residual_mps", "largest change of a velocity in a solver's last pass"},
      {"late", "samples that the session got more than 50 ms later than when they arrived"},
      {"late_frames",
       "frames not drawn because another was being drawn, or because drawing failed"},
      {"latency_mean_s", "from a head's sample to its frame: the sum of its stages"},
      {"latency_median_s", "from a head's sample to its frame"},
      {"latency_p99_s", "likewise, for 99 of 100"},
      {"latency_stages", "what the mean consists of"},
      {"lateness_max_s", "how late a sample was sent, at most"},
      {"lateness_median_s", "likewise, the median"},
      {"lateness_p99_s", "likewise, for 99 of 100"},
      {"ledger", "energy that each phase added (docs/hash-and-ledger.md)"},
      {"line", "terminal or port of an emulated unit"},
      {"longest_gap", "longest stretch of a log without a sample of anything"},
      {"longest_gap_s", "between two samples of a device"},
      {"lost", "samples missing from a device's count; records lost by an emulated fault"},
      {"lost_samples", "samples that did not come, by their stations' sequences"},
      {"marks", "of a score sheet: fouls, and what the hand felled"},
      {"mass_kg", "of a skittle"},
      {"messages", "on a channel"},
      {"misdated",
       "samples and states whose time, unlike those around them, is another than the log's"},
      {"missed", "records that did not come whole"},
      {"other_publishers_samples", "samples left out, as another publisher sends that station"},
      {"other_trials", "messages of another trial in the same file"},
      {"name", "of a version of the game: red, blue, or empty where there are none"},
      {"over", "played to its end"},
      {"not_drawn", "what mesh files have that is not drawn: textures, alpha"},
      {"output", "what was written: a file or a folder; null without one"},
      {"overruns", "ticks that began more than a tick late"},
      {"position_m", "centre of a ball as it was let go, in the world"},
      {"pairs", "pairs of bodies whose bounds met, summed over all ticks"},
      {"participant", "as given"},
      {"peak_hand_speed_mps", "of the right hand"},
      {"primitives", "of a skittle"},
      {"points", "of a game, under its rules"},
      {"processor", "features that Mesa finds"},
      {"planned_speed_mps",
       "of the ball, by the throw that was asked for; what a session makes of its samples is "
       "release_speed_mps"},
      {"pulling_impulses", "impulses that would have pulled, and were replaced"},
      {"published_s", "stage of the latency: until they are encoded and sent"},
      {"queries", "detection queries of parts"},
      {"query_iterations", "their iterations"},
      {"rate_hz", "samples a second"},
      {"realtime_factor", "simulated time over the time it took"},
      {"records", "of a Fastrak, sent or received"},
      {"refused", "commands the emulated unit did not take"},
      {"release_s", "when the ball was let go"},
      {"release_speed_mps", "of the ball of a throw, or of the first one, as it left the hand"},
      {"remedy", "what to type where something does not work"},
      {"renderer", "what drew the pictures"},
      {"response", "of the collisions, by name"},
      {"releases", "of a trial: when, and when it would have been fastest"},
      {"restarts", "times the driver began anew"},
      {"result", "what a simulated trial came to"},
      {"rows", "of each table that was written"},
      {"rolls", "skittles down by each ball, by frame"},
      {"rules", "of a game"},
      {"samples", "of devices"},
      {"says", "what the doctor found"},
      {"seed", "of what is by chance"},
      {"scenario", "its name, as it calls itself"},
      {"samples_left_out", "of a release: they lie off what those around them say of the hand"},
      {"scenarios", "that come with the program"},
      {"scenario_differences", "keys of the scenario whose values differ, and both, as TOML"},
      {"set", "keys of the scenario given on the command line"},
      {"shape",
       "what skittles collide as: `true` or `ellipsoid`; null where versions differ in it"},
      {"sheet", "a score sheet in words"},
      {"simulated_s", "simulated time"},
      {"skipped", "what was passed over in a log"},
      {"skipped_bytes", "bytes of a line that belong to no record"},
      {"skittles", "of the rack"},
      {"skittles_down", "that balls felled; of games, what their sheets count"},
      {"source", "by its name, as `live` takes it"},
      {"sources", "of a live session"},
      {"solver_iterations", "passes over lasting contacts, summed"},
      {"state_hash", "after the last tick (docs/hash-and-ledger.md)"},
      {"statistics", "counts of the engine"},
      {"sustained_j", "entry of the ledger: lasting contacts, friction, rest"},
      {"tick", "of an event; -1 outside the simulation"},
      {"approaches",
       "what flew at the player: closest approach, and whether head or hand got out of its way"},
      {"at_hand", "it was to come nearest to the hand, not to head or body"},
      {"as_it_was", "what a throw on its own came to under the condition of its trial"},
      {"other_condition", "what a throw on its own came to under the condition that was given"},
      {"each_throw", "every throw on its own (`replay --each-throw`)"},
      {"felled", "by a ball, as the rules count; null where they counted nothing"},
      {"throw", "its number in the session, from 1"},
      {"throws_without_counterpart",
       "throws of the recording, or of this trial, that the replay, or the other trial, has not"},
      {"new_throws", "throws of a replay that the recording has not"},
      {"unstamped_samples",
       "samples without a time of their own, taken to be measured when they came"},
      {"why", "why a throw has no counterpart"},
      {"bodies_only_in_a", "by name; none where both trials have the same bodies"},
      {"bodies_only_in_b", "likewise"},
      {"blue", "of two versions of a game: the blue one"},
      {"red", "of two versions of a game: the red one"},
      {"body", "that flew at the player, that was thrown"},
      {"closest_m", "its closest approach to the player"},
      {"foreseen_m", "the closest approach that was to be expected as it was noticed"},
      {"game_hash",
       "of all ticks and the version played in each; null where states are missing "
       "(docs/hash-and-ledger.md)"},
      {"answers", "that a participant has given"},
      {"counted", "participants whom the tables of a study are of"},
      {"degrees_of_freedom", "of a fitted model"},
      {"deviance",
       "of a fitted model: minus twice its log-likelihood ratio to the data themselves"},
      {"endless_terms", "whose estimate goes to infinity: separation"},
      {"eyes_m", "height of a participant's display while standing"},
      {"found", "share of simulated studies in which dropping the term is significant at 5 %"},
      {"found_without", "likewise where the term has no effect: false alarms"},
      {"new_answers", "that were added"},
      {"not_counted", "participants whom the tables are not of"},
      {"of_virtual", "yes: tables of virtual participants; no: of people; mixed: of both"},
      {"people", "in a simulated study"},
      {"power", "of a study, by its number of people"},
      {"reach_m", "largest distance from a participant's display to the hand"},
      {"script_changed", "the study's model.R is another than headpin wrote"},
      {"separated", "share of simulated studies with an estimate that goes to infinity"},
      {"studies", "that were simulated for each number of people"},
      {"term", "of a model"},
      {"terms", "of a model, each"},
      {"why_not", "why a participant does not count"},
      {"cell", "of an experiment's design: a digit a factor"},
      {"changed", "the parameter that changes between a participant's two versions"},
      {"new_participants", "that were added to a plan"},
      {"next", "the command to type next; empty when all is done"},
      {"participants", "of a study: how many, or each"},
      {"replaced_by", "who got the conditions of a participant who dropped out; empty for nobody"},
      {"run", "the recording of a session that counts; null where none does"},
      {"runs", "recordings of a participant's session"},
      {"sessions", "that were played"},
      {"virtual", "no person played it"},
      {"gave_up",
       "the virtual participant ended early: a button out of reach, a ball that did not come back"},
      {"hand_away_mps2", "largest acceleration of the hand out of its way"},
      {"head_away_mps2", "likewise, of the head"},
      {"left_handed", "the virtual participant throws with the left hand"},
      {"moved", "head or hand accelerated out of its way by 4 m/s2 or more"},
      {"noticed_s", "when it began to fly at the player"},
      {"skill", "of a virtual participant: 0 has never thrown, 1 throws every week"},
      {"time_to_contact_s", "from then until it was to be nearest"},
      {"test_picture", "hash of a fixed picture: where it is equal, those of frames are to be"},
      {"throws", "a row each: see throws.csv"},
      {"throw_count", "how many throws there are"},
      {"throws_asked", "of it; a game that is over sooner leaves some"},
      {"ticked_s",
       "stage of the latency: until the session has taken the sample in and made its tick"},
      {"ticks", "simulated"},
      {"time_s", "of an event"},
      {"to_s", "where it ends"},
      {"touches", "pairs of bodies that met, one of them a skittle"},
      {"trial", "its file"},
      {"trouble",
       "which messages were undecodable, implausible, foreign, baseless, misdated, late, lost or "
       "astray: "
       "runs of "
       "them"},
      {"trigger_s", "when the trigger was let go, as its device tells it"},
      {"undecodable", "messages with another type or size"},
      {"unfinished_impacts", "steps that still had impacts after the last pass"},
      {"unsolved_islands", "groups of bodies the solver stopped at its last pass"},
      {"unverified_ticks",
       "ticks that were simulated and that an incomplete recording has no state of"},
      {"velocity_mps", "velocity of a ball as it was let go, in the world"},
      {"value", "what the kind of event says (docs/events.md)"},
      {"verified_frames", "frames found equal to the recording"},
      {"verified_ticks", "ticks found equal to the recording"},
      {"y4m", "the raw video that was written; null without one"},
      {"version", "of the program that wrote it"},
      {"versions",
       "of a game, red and blue: the elasticity, friction and shape of each; null without them"},
      {"video", "the video that was written; null without one"},
      {"spin_radps", "angular velocity of a ball as it was let go, in the world"},
      {"waited_s", "stage of the latency: until the tick at which a frame is due"},
      {"why_nothing_fell", "in words, of a trial in which nothing did; not there in others"},
      {"width", "of a picture, in pixels"},
      {"works", "whether it does"},
  };
}

std::vector<ChannelUse> channel_uses() {
  return {
      {"HEADPIN_TRIAL", "trial_t", "first message of every trial"},
      {"TRACKER", "tracked_device_t",
       "each sample of each receiver; `live` takes them from others"},
      {"MOUSE3D", "mouse3d_t",
       "each change of a button, from `emulate` ten times a second too; `live` takes them from "
       "others"},
      {"EVENT", "event_t", "as things happen"},
      {"STATE", "state_t", "every tick of a simulation, in a file about every second"},
      {"STATE_CHANGE", "state_change_t",
       "the ticks between, in a file (format 2; not with `--states all`)"},
      {"FRAME", "frame_t", "each frame that was drawn"},
      {"SESSION_...", "the same six",
       "`live`: its own trial as it comes about, the header every second: what a logger keeps is "
       "a trial"},
      {"HEAD_POSE", "rigid_transform_t", "`stream`: the display in the world, each good sample"},
      {"HAND_POSE", "rigid_transform_t", "`stream`: the virtual hand in the world, likewise"},
      {"HEADPIN_EYES", "image_array_t", "`live`: both eyes, each frame"},
      {"DRAKE_VIEWER_LOAD_ROBOT", "viewer_load_robot_t", "`live`: the bodies, every five seconds"},
      {"DRAKE_VIEWER_DRAW", "viewer_draw_t", "`live`: where they are, each frame"},
  };
}

std::map<std::string, std::string> reference_pages() {
  return {{"scenario.md", scenario_page()},
          {"tables.md", tables_page()},
          {"channels.md", channels_page()},
          {"events.md", events_page()},
          {"json.md", json_page()}};
}

}  // namespace headpin::apps
