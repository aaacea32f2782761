#include "apps/reference.h"

#include <fmt/format.h>

#include "apps/json_keys.h"
#include "devices/base/version.h"
#include "devices/trial/tables.h"
#include "scene/play/events.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

namespace {

constexpr const char* kWritten =
    "<!-- Written by the program (`./dev docs`): change what it says in the sources. -->\n\n";

/// A cell of a table: what would end it is masked.
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
