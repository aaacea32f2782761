// What `stream` sends of a participant who walks with the thumb buttons.

#include <bit>
#include <cmath>

#include "devices/log/event_log.h"
#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "tests/apps/trial_commands.h"
#include "tests/support/csv_rows.h"

namespace headpin {
namespace {

TEST_F(TrialCommands, AStreamedHeadWalksAsInTheSession) {
  scene::Scenario scenario;
  scene::TrialHeader header;
  header.scenario = scene::to_toml(scenario);
  {
    scene::Recorder recorder(folder_ / "walk.lcmlog", header);
    for (int i = 0; i <= 180; ++i) {  // looks along y; the left thumb is down for a second
      devices::TrackerSample head;
      head.device_time = tick_time(i, 60);
      head.sequence = i;
      head.X_TS = {Quat(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0), Vec3(0.5, -2.0, 1.7)};
      recorder.write(head);
      if (i == 30 || i == 90) {
        recorder.write(
            devices::MouseSample{.device_time = head.device_time, .left_thumb = i == 30});
      }
    }
    recorder.close();
  }
  ASSERT_EQ(headpin("stream walk.lcmlog --lcm 'file://out.lcmlog?mode=w' --speed 0").code, 0);
  std::vector<double> y;  // of each rigid_transform_t: fingerprint, utime, then the place
  devices::FileWindow log((folder_ / "out.lcmlog").string());
  devices::LogReader reader(log);
  while (const auto event = reader.next()) {
    if (event->channel != "HEAD_POSE") continue;
    std::uint64_t bits = 0;
    for (std::size_t k = 24; k < 32; ++k) bits = bits << 8 | event->data[k];
    y.push_back(std::bit_cast<double>(bits));
  }
  ASSERT_EQ(y.size(), 181u);
  EXPECT_EQ(y[29], -2.0);
  EXPECT_NEAR(y.back(), -2.0 + scenario.walk.speed, 2.0 * scenario.walk.speed / 240.0);
  EXPECT_EQ(y[170], y.back());

  // A sample that comes at the time of a tick is used by that tick: the walk is that of its row in the table.
  ASSERT_EQ(headpin("export walk.lcmlog -o tables").code, 0);
  const auto rows = csv_rows(slurp(folder_ / "tables/trackers.csv"));
  ASSERT_EQ(rows.size(), y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    EXPECT_NEAR(y[i] - y[0], std::stod(rows[i].at("walk_y_m")), 1e-12) << i;
  }
}

}  // namespace
}  // namespace headpin
