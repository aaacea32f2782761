#include "apps/reference.h"

#include <fmt/format.h>

#include "apps/json_keys.h"
#include "devices/base/version.h"
#include "scene/record/events.h"
#include "scene/record/tables.h"
#include "scene/scenario/keys.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

namespace {

constexpr const char* kWritten =
    "<!-- Written by the program (`./dev docs`): change what it says in the sources. -->\n\n";

/// A cell of a table; the character that would end it is escaped.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string code(const std::string& text) {
  return text.empty() ? "" : "`" + text + "`";
}

std::string scenario_page() {
  std::string out = fmt::format(
      "# Every key of a scenario\n\n{}Units are metre, kilogram and second, unless a name says "
      "otherwise. A key that a scenario does not have gets its default value, from\nthe paper's "
      "room, [paper-room.toml](../assets/scenarios/paper-room.toml). Unknown keys, wrong types and "
      "values out of range are refused with\nfile and line. `[]` is an entry of a list. `--set "
      "KEY=VALUE` changes one value.\n\n"
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
      "# Every column of `headpin export`\n\n{}The tables are CSV files as in RFC 4180: one line "
      "of names, then one row per observation. Numbers have the fewest digits that read\nback to "
      "the same bits; times are exact. `yes/no` is 1 or 0, a `hash` has 16 hexadecimal digits. "
      "Every export has this list as `columns.csv`.\n\nStates, events and frames are those of the "
      "session, which uses poses and buttons `rig.delay_s` after they were measured (0.025 s in "
      "trials\nof `synthesize`, 0.028 s in imported throws). Add it to the times of trackers.csv "
      "before you compare their rows with those of states.csv.\n",
      kWritten);
  std::string table;
  for (const scene::TableColumn& c : scene::table_columns()) {
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
      "# LCM channels and types\n\n{}A trial is one LCM event log; a live session publishes the "
      "same messages. The types belong to `headpin`, unless they are\nwire-compatible with another "
      "project's. The `.lcm` files are in `devices/lcm/types`, in `share/headpin/types` after "
      "installation, and in\nthe header of every trial. [lcm-spy](guides/spy.md) shows the "
      "channels of a session.\n\n| channel | type | when |\n|---|---|---|\n",
      kWritten);
  for (const ChannelUse& use : channel_uses()) {
    out += fmt::format("| `{}` | `{}` | {} |\n", use.channel, use.type, use.when);
  }
  return out + "\n```text\n" + devices::schema_text() + "```\n";
}

std::string json_page() {
  std::string out = fmt::format(
      "# Every key of `--json`\n\n{}A command prints one object on standard output, also when it "
      "fails. Where standard output is the command's output (`-o -`), the object is on\nstandard error "
      "from the moment in which the output begins; `plot` refuses `--json` with `-o -`. "
      "The end of a name is the unit: `_s` seconds, `_m` metres,\n`_j` joules, `_hz` per "
      "second, `_mps` metres per second. A missing value is `null`. A name has the same meaning in "
      "all commands.\n\n| key | meaning |\n|---|---|\n",
      kWritten);
  for (const JsonKey& key : json_keys()) {
    out += fmt::format("| `{}` | {} |\n", key.key, cell(key.meaning));
  }
  return out;
}

std::string events_page() {
  std::string out = fmt::format(
      "# Every kind of event\n\n{}Events are messages on the channel `EVENT`; `info` and "
      "`events.csv` have all of them except `end`. `bodies` are the bodies of the event;\nthe "
      "impulse acts on the first of them.\n\n"
      "| kind | when | point (in W) | value |\n|---|---|---|---|\n",
      kWritten);
  for (const scene::EventKind& kind : scene::kEventKinds) {
    out += fmt::format("| `{}` | {} | {} | {} |\n", kind.name, kind.when, kind.point, kind.value);
  }
  return out;
}

}  // namespace

std::vector<ChannelUse> channel_uses() {
  return {
      {"HEADPIN_TRIAL", "trial_t", "first message of every trial"},
      {"TRACKER", "tracked_device_t",
       "each sample of each receiver; `live` receives them from others"},
      {"MOUSE3D", "mouse3d_t",
       "each change of a button, and from `emulate` also ten times per second; `live` receives "
       "them from others"},
      {"EVENT", "event_t", "each event"},
      {"STATE", "state_t", "every tick of a simulation; in a file about once per second"},
      {"STATE_CHANGE", "state_change_t",
       "in a file: the ticks between two STATE messages (format 2; not with `--states all`)"},
      {"SNAPSHOT", "snapshot_t",
       "in a file, every ten seconds of a simulation: the session as it is then, for replays that "
       "start there"},
      {"FRAME", "frame_t", "each frame that was drawn"},
      {"SESSION_...", "the same six",
       "`live`: the session's own trial while it runs, with the header every second, so that a "
       "recording by a logger is a trial"},
      {"HEAD_POSE", "rigid_transform_t",
       "`stream`: pose of the display in the world, each good sample, walked as its row of "
       "`trackers.csv` says"},
      {"HAND_POSE", "rigid_transform_t",
       "`stream`: pose of the virtual hand in the world, each good sample, walked likewise"},
      {"HEADPIN_EYES", "image_array_t", "`live`: pictures of both eyes, each frame"},
      {"DRAKE_VIEWER_LOAD_ROBOT", "viewer_load_robot_t", "`live`: the bodies, every five seconds"},
      {"DRAKE_VIEWER_DRAW", "viewer_draw_t", "`live`: poses of the bodies, each frame"},
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
