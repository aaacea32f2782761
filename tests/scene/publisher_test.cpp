#include "scene/record/publisher.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

// Who listens in later finds the header within a second, and with it what draws.
TEST(TrialPublisher, SaysTheHeaderEverySecond) {
  const std::filesystem::path path = fresh_folder("link") / "trial.log";
  {
    devices::LcmLink log("file://" + path.string() + "?mode=w");
    TrialPublisher trial(log, TrialHeader{});
    Event drawn;
    drawn.time = Time{50'000};
    drawn.kind = kDrawnByEvent;
    trial.write(drawn);
    for (int i = 1; i <= 35; ++i) {
      TickState state;
      state.time = Time{100'000 * i};
      state.tick = i;
      state.bodies.resize(1);
      trial.write(state);
    }
    trial.close();
  }
  const Trial heard = read_log(path.string());
  std::int64_t headers = 0, events = 0;
  for (const auto& [name, channel] : heard.channels) {
    if (name.ends_with(kTrialChannel)) headers += channel.messages;
    if (name.ends_with(kEventChannel)) events += channel.messages;
  }
  EXPECT_EQ(headers, 1 + 3);  // at 1, 2 and 3 s
  EXPECT_EQ(events, 1 + 3 + 1);
}

}  // namespace
}  // namespace headpin::scene
