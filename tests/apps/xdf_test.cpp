// Trials and recordings as XDF: there and back, and read by Debian's libxdf.

#include <fmt/format.h>
#include <xdf.h>

#include "tests/apps/rewritten.h"
#include "tests/apps/trial_commands.h"
#include "tests/support/csv_rows.h"
#include "tests/support/xdf_bytes.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class XdfCommands : public TrialCommands {
 protected:
  XdfCommands() {
    EXPECT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
    EXPECT_EQ(headpin("export game.lcmlog --xdf game.xdf").code, 0);
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
};

void expect_same_sample(const devices::Sample& a, const devices::Sample& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const auto* s = std::get_if<devices::TrackerSample>(&a)) {
    const auto& t = std::get<devices::TrackerSample>(b);
    EXPECT_EQ(
        std::tie(s->device_time, s->host_time, s->session_time, s->sequence, s->station, s->status,
                 s->buttons, s->sent_time, s->position_estimated, s->orientation_estimated),
        std::tie(t.device_time, t.host_time, t.session_time, t.sequence, t.station, t.status,
                 t.buttons, t.sent_time, t.position_estimated, t.orientation_estimated));
    EXPECT_EQ(s->X_TS.p, t.X_TS.p);
    EXPECT_EQ(s->X_TS.q.coeffs(), t.X_TS.q.coeffs());
  } else {
    const auto& m = std::get<devices::MouseSample>(a);
    const auto& n = std::get<devices::MouseSample>(b);
    EXPECT_EQ(std::tie(m.device_time, m.host_time, m.session_time, m.left_thumb, m.right_thumb,
                       m.trigger),
              std::tie(n.device_time, n.host_time, n.session_time, n.left_thumb, n.right_thumb,
                       n.trigger));
  }
}

TEST_F(XdfCommands, ATrialComesBackWithEverySampleAndTheSameGame) {
  EXPECT_EQ(headpin("import game.xdf -o back.lcmlog").code, 0);
  const scene::Trial before = trial("game.lcmlog"), after = trial("back.lcmlog");
  ASSERT_EQ(after.samples.size(), before.samples.size());
  for (std::size_t i = 0; i < before.samples.size(); ++i)
    expect_same_sample(before.samples[i], after.samples[i]);
  EXPECT_EQ(after.header.scenario, before.header.scenario);
  EXPECT_EQ(after.header.participant, before.header.participant);
  EXPECT_EQ(after.header.seed, before.header.seed);
  const nlohmann::json game = json("replay game.lcmlog --json"),
                       back = json("replay back.lcmlog --json");
  EXPECT_EQ(back["state_hash"], game["state_hash"]);
  EXPECT_EQ(back["game_hash"], game["game_hash"]);
}

// Written before samples said when they were told and what is estimated.
TEST_F(XdfCommands, AnOlderFileIsRead) {
  const std::string trials = HEADPIN_SOURCE_DIR "/tests/scene/trials/";
  EXPECT_EQ(headpin("import " + trials + "older.xdf -o back.lcmlog").code, 0);
  const scene::Trial before = scene::read_trial(trials + "rules-1.lcmlog"),
                     after = trial("back.lcmlog");
  ASSERT_EQ(after.samples.size(), before.samples.size());
  for (std::size_t i = 0; i < before.samples.size(); ++i)
    expect_same_sample(before.samples[i], after.samples[i]);
}

TEST_F(XdfCommands, EventsOutsideTheSimulationComeBack) {
  EXPECT_EQ(headpin("import " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o throw.lcmlog").code,
            0);
  EXPECT_EQ(headpin("export throw.lcmlog --xdf throw.xdf").code, 0);
  EXPECT_EQ(headpin("import throw.xdf -o back.lcmlog").code, 0);
  const auto before = trial("throw.lcmlog").events, after = trial("back.lcmlog").events;
  ASSERT_EQ(before.size(), 3u);  // imported; grab and release, found
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].kind, before[i].kind);
    EXPECT_EQ(after[i].time, before[i].time);
    EXPECT_EQ(after[i].bodies, before[i].bodies);
    EXPECT_EQ(after[i].p_W, before[i].p_W);
    EXPECT_EQ(after[i].value, before[i].value);
    EXPECT_EQ(after[i].detail.text(), before[i].detail.text());
  }
}

// They have the ticks at which a live session told them; a replay makes only the others again.
TEST_F(XdfCommands, EventsOfALiveSessionComeBackFromXdfAndFromTables) {
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "live.lcmlog", add_told_live);
  EXPECT_EQ(headpin("export live.lcmlog --xdf live.xdf").code, 0);
  EXPECT_EQ(headpin("export live.lcmlog -o live").code, 0);
  EXPECT_EQ(headpin("import live.xdf -o from-xdf.lcmlog").code, 0);
  EXPECT_EQ(headpin("import live -o from-tables.lcmlog").code, 0);
  for (const char* name : {"from-xdf.lcmlog", "from-tables.lcmlog"}) {
    const auto events = trial(name).events;
    ASSERT_EQ(events.size(), 2u) << name;
    EXPECT_EQ(events[0].kind, "drawn_by") << name;
    EXPECT_EQ(events[0].time, Time{}) << name;
    EXPECT_EQ(events[1].kind, "source_amiss") << name;
    EXPECT_EQ(events[1].time, Time{2'500'000}) << name;
  }
}

const Xdf::Stream& stream_called(const Xdf& file, const std::string& name) {
  const auto found = std::ranges::find_if(
      file.streams, [&](const Xdf::Stream& stream) { return stream.info.name == name; });
  EXPECT_NE(found, file.streams.end()) << name;
  return *found;
}

/// Every sample of a stream is a row of the table: its times to the last bit, its numbers as floats, which
/// are all that libxdf keeps.
void expect_rows(const Xdf::Stream& stream,
                 const std::vector<std::map<std::string, std::string>>& rows,
                 const std::string& time) {
  ASSERT_EQ(stream.time_stamps.size(), rows.size()) << stream.info.name;
  ASSERT_EQ(stream.time_series.size(), stream.info.channels.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(stream.time_stamps[i], std::stod(rows[i].at(time))) << stream.info.name << i;
    for (std::size_t c = 0; c < stream.info.channels.size(); ++c) {
      const std::string& label = stream.info.channels[c].at("label");
      if (!rows[i].contains(label) || label == "status") continue;
      EXPECT_EQ(stream.time_series[c][i], static_cast<float>(std::stod(rows[i].at(label))))
          << stream.info.name << " " << label << " " << i;
      ++compared;
    }
  }
  EXPECT_GE(compared, 4 * rows.size());
}

TEST_F(XdfCommands, LibxdfReadsEverySampleOfTheTables) {
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "libxdf 0.99.8 takes headers, which have no end, for strings of C";
#endif
  EXPECT_EQ(headpin("export game.lcmlog -o tables").code, 0);
  Xdf file;
  testing::internal::CaptureStdout();  // it reports there
  EXPECT_EQ(file.load_xdf((folder_ / "game.xdf").string()), 0);
  testing::internal::GetCapturedStdout();
  ASSERT_EQ(file.streams.size(), 7u);
  EXPECT_EQ(file.version, 1.0f);
  auto trackers = csv_rows(slurp(folder_ / "tables/trackers.csv"));
  const auto of_station = [&](const std::string& station) {
    auto rows = trackers;
    std::erase_if(rows, [&](auto& row) { return row.at("station") != station; });
    return rows;
  };
  expect_rows(stream_called(file, "head"), of_station("1"), "device_time_s");
  expect_rows(stream_called(file, "right hand"), of_station("2"), "device_time_s");
  expect_rows(stream_called(file, "3D mouse"), csv_rows(slurp(folder_ / "tables/buttons.csv")),
              "device_time_s");
  const auto events = trial("game.lcmlog").events;
  ASSERT_EQ(stream_called(file, "event values").time_stamps.size(), events.size());
  std::vector<std::pair<std::string, double>> kinds;
  for (const auto& [event, stream] : file.eventMap) {
    if (file.streams[static_cast<std::size_t>(stream)].info.name == "events")
      kinds.push_back(event);
  }
  ASSERT_EQ(kinds.size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(kinds[i].first, events[i].kind);
    EXPECT_EQ(kinds[i].second, nearest_seconds(events[i].time));
  }
  const Xdf::Stream& head = stream_called(file, "head");
  EXPECT_EQ(head.info.type, "MoCap");
  EXPECT_EQ(head.info.channels[3].at("type"), "OrientationA");
  EXPECT_EQ(head.info.channels[0].at("unit"), "meters");
  EXPECT_EQ(head.info.sample_count, 421);
  ASSERT_EQ(head.clock_times.size(), 2u);  // every 5 s of the 7 s
  EXPECT_EQ(head.clock_values[1], 0.0);
}

TEST_F(XdfCommands, ACutTrialIsReadToWhereItIsWhole) {
  const std::string whole = slurp(folder_ / "game.xdf");
  write("cut.xdf", whole.substr(0, whole.size() * 3 / 5));
  const Result result = headpin("import cut.xdf -o cut.lcmlog");
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.err, HasSubstr("the file ends inside a chunk"));
  EXPECT_THAT(result.err, HasSubstr("7 of 7 streams have no footer"));
  const scene::Trial before = trial("game.lcmlog"), after = trial("cut.lcmlog");
  ASSERT_GT(after.samples.size(), before.samples.size() / 3);
  ASSERT_LT(after.samples.size(), before.samples.size());
  const auto in_half_seconds = [](const devices::Sample& sample) {
    return devices::device_time(sample) / Time{500'000};
  };
  for (std::size_t i = 0; i < after.samples.size(); ++i) {
    // Of the last half second, some streams may have nothing.
    if (in_half_seconds(after.samples[i]) + 1 >= in_half_seconds(after.samples.back())) break;
    expect_same_sample(before.samples[i], after.samples[i]);
  }
  write("header.xdf", whole.substr(0, 100));
  expect_refusal("import header.xdf -o OUT.lcmlog", 1, "header.xdf");
}

/// The catalogue's throw as another program would record it: one stream in centimetres, on a clock that is
/// 37.5 s ahead of the recorder's, under names that say nothing or something.
std::string recorded_throw(const std::string& head, const std::string& left,
                           const std::string& right) {
  xdf::Channels channels;
  std::vector<std::string> columns;
  for (const auto& [part, name] :
       {std::pair{"head", head}, {"left_hand", left}, {"right_hand", right}}) {
    for (const std::string component :
         {"pos_x", "pos_y", "pos_z", "rot_w", "rot_x", "rot_y", "rot_z"}) {
      channels.push_back(
          {name + "_" + component, component.starts_with("pos") ? "<unit>cm</unit>" : ""});
      columns.push_back(part + ("_" + component));
    }
  }
  std::string file = xdf::begin() + xdf::stream(9, "Rig", "Motion", "double64", 72.0, channels) +
                     xdf::stream(4, "Amp", "EEG", "float32", 500.0, {{"Fz", ""}, {"Pz", ""}});
  int row_number = 0;
  for (auto& row : csv_rows(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"))) {
    const double t = 5000.0 + 1e-3 * std::stod(row.at("delta_time_ms"));
    if (row_number++ % 100 == 0) file += xdf::offset(9, t + 37.5, -37.5) + xdf::boundary();
    std::string values;
    for (const std::string& column : columns) values += xdf::bytes(std::stod(row.at(column)));
    file += xdf::samples(9, 1, xdf::sample(t + 37.5, values));
    file += xdf::samples(4, 1, xdf::sample(t, xdf::bytes(1.f) + xdf::bytes(2.f)));
  }
  return file;
}

TEST_F(XdfCommands, AnotherProgramsRecordingIsTheSameThrowAsItsTable) {
  const nlohmann::json table =
      json("import " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o table.lcmlog --json");
  const auto expect_same_throw = [&](const nlohmann::json& read) {
    for (const char* key : {"samples", "hand", "duration_s"})
      EXPECT_EQ(read[key], table[key]) << key;
    for (const char* key : {"release_speed_mps", "peak_hand_speed_mps"}) {
      EXPECT_NEAR(read[key].get<double>(), table[key].get<double>(), 1e-9) << key;
    }
    // The table's times count from its start, 1 ms before its first row.
    EXPECT_NEAR(read["release_s"].get<double>() + 0.001, table["release_s"].get<double>(), 1e-9);
  };
  const std::string named = recorded_throw("HMD", "LeftController", "RightController");
  write("named.xdf", named + xdf::footer(9) + xdf::footer(4));
  const nlohmann::json read = json("import named.xdf -o named.lcmlog --json");
  expect_same_throw(read);
  EXPECT_EQ(read["notes"].at(0), "streams without motion are ignored: 'Amp' (EEG, 2 channels)");

  write("unnamed.xdf", recorded_throw("a", "b", "c") + xdf::footer(9) + xdf::footer(4));
  expect_refusal("import unnamed.xdf -o OUT.lcmlog", 1, "no head was found");
  const std::string columns = " --columns 'head=Rig a_*, left=Rig b_*, right=Rig c_*'";
  expect_same_throw(json("import unnamed.xdf -o told.lcmlog --json" + columns));
  const Result explained = headpin("import unnamed.xdf --explain" + columns);
  EXPECT_THAT(explained.out, HasSubstr("Rig c_rot_w  right hand, quaternion w"));
  EXPECT_THAT(explained.out, HasSubstr("--units cm --time-unit s --axes RSP --rotations wxyz"));
  EXPECT_THAT(explained.out, HasSubstr("can be imported"));
  EXPECT_EQ(headpin("import unnamed.xdf --explain -o map.toml" + columns).code, 0);
  expect_same_throw(json("import unnamed.xdf -o mapped.lcmlog --json --columns map.toml"));

  // LabRecorder was killed: the last chunk is incomplete, and there are no footers.
  write("killed.xdf", named.substr(0, named.size() * 9 / 10));
  const nlohmann::json killed = json("import killed.xdf -o killed.lcmlog --json");
  EXPECT_NEAR(killed["release_speed_mps"].get<double>(), table["release_speed_mps"].get<double>(),
              1e-9);
  EXPECT_THAT(killed["notes"].dump(), HasSubstr("the file ends inside a chunk"));
}

TEST_F(XdfCommands, ATrialIsReadAsAnyRecordingWithOptionsThatSayHow) {
  // The transmitter of the bundled trial: its x points ahead, y to the right, z down.
  const nlohmann::json read =
      json("import game.xdf -o again.lcmlog --json --axes ARI --transmitter 0.4,1.1,2.2");
  EXPECT_TRUE(read["by_trigger"].get<bool>());
  // The same hand lets go at the same sample; the ball is held elsewhere than by the trial's rig, in a fist.
  const nlohmann::json game = json("replay game.lcmlog --json");
  EXPECT_NEAR(read["release_speed_mps"].get<double>(), game["release_speed_mps"].get<double>(),
              0.7);
}

TEST_F(XdfCommands, OneOutputIsAskedForAndNothingIsOverwritten) {
  expect_refusal("export game.lcmlog -o OUT --xdf OUT.xdf", 2, "expected one of");
  expect_refusal("export game.lcmlog --xdf game.xdf", 1, "game.xdf: exists already");
  const std::string before = slurp(folder_ / "game.xdf");
  EXPECT_EQ(headpin("export game.lcmlog --xdf -").out, before);
  EXPECT_EQ(headpin("export game.lcmlog --xdf again.xdf").code, 0);
  EXPECT_EQ(slurp(folder_ / "again.xdf"), before);
}

// Publishers of others count stations from 0, and send a status that no Fastrak has. What cannot be printed is an x.
TEST_F(XdfCommands, AnyStationAndStatusComesBackFromXdfAndFromTablesAlike) {
  const std::vector<std::int32_t> stations = {0, -3, 2'000'000'000};
  const std::string sent = {'k', '"', ',', ';', '0', '~', '\x01', '\x7f', '\xe9', '\0'};
  const std::string kept = "k\",;0~xxxx";
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "odd.lcmlog", [&](scene::Trial& odd) {
    const auto first = std::ranges::find_if(odd.samples, [](const devices::Sample& sample) {
      return std::holds_alternative<devices::TrackerSample>(sample);
    });
    const auto model = std::get<devices::TrackerSample>(*first);
    std::vector<devices::Sample> more;
    for (const std::int32_t station : stations) {
      for (std::size_t i = 0; i < sent.size(); ++i) {
        devices::TrackerSample sample = model;
        sample.station = station;
        sample.sequence = static_cast<std::int64_t>(i);
        sample.status = sent[i];
        more.emplace_back(sample);
      }
    }
    odd.samples.insert(first, more.begin(), more.end());
  });
  EXPECT_EQ(headpin("export odd.lcmlog --xdf odd.xdf").code, 0);
  EXPECT_EQ(headpin("export odd.lcmlog -o odd").code, 0);
  for (const char* from : {"odd.xdf", "odd"}) {
    const Result made = headpin(fmt::format("import {} -o back.lcmlog --force", from));
    ASSERT_EQ(made.code, 0) << from << made.err;
    for (const std::int32_t station : stations) {
      std::string statuses;
      for (const devices::Sample& sample : trial("back.lcmlog").samples) {
        const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
        if (tracker && tracker->station == station) statuses += tracker->status;
      }
      EXPECT_EQ(statuses, kept) << from << " " << station;
    }
  }
}

}  // namespace
}  // namespace headpin
