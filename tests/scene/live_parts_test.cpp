// The parts of a live session, each by itself: what it hears, where its trial goes, what it notices.

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/emulated/unit.h"
#include "devices/lcm/link.h"
#include "devices/log/sample_messages.h"
#include "scene/live/lcm_views.h"
#include "scene/live/monitor.h"
#include "scene/live/played.h"
#include "scene/live/sources.h"
#include "scene/live/trial_outputs.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "scene/record/publisher.h"
#include "scene/record/source.h"
#include "scene/watch/trial_writer.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

const std::string kDemoTrial = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

/// A source whose state the test sets.
struct TestSource : devices::LiveSource {
  void start() override { ++started; }
  void poll(Time, std::vector<devices::Sample>&) override {}
  bool exhausted() const override { return over; }
  devices::SourceStatus status(Time) const override { return state; }
  devices::SourceStatus state;
  int started = 0;
  bool over = false;
};

/// Keeps the events that are written, or refuses them.
struct TestSink : TrialSink {
  struct Got {
    std::vector<Event> events;
    int frames = 0, states = 0, closed = 0;
    bool refuses = false, lost = false;
  };
  explicit TestSink(Got& kept) : got(kept) {}
  void write(const devices::Sample&) override {}
  void write(const Event& event) override {
    if (got.refuses) throw std::runtime_error("nothing more can be written");
    got.events.push_back(event);
  }
  void write(const TickState&) override { ++got.states; }
  void write(const FrameRecord&) override { ++got.frames; }
  void close() override { ++got.closed; }
  void require_kept() const override {
    if (got.lost) throw std::runtime_error("session.lcmlog: was deleted");
  }
  Got& got;
};

/// Fails at its first frame, and draws the others.
struct UnsteadyDrawer : FrameDrawer {
  const render::Fingerprint& drawn_by() const override { return who; }
  std::optional<DrawnFrame> draw(const FrameJob&) override {
    if (asked++ == 0) throw DrawingFailed("it fell over");
    return DrawnFrame{};
  }
  render::Fingerprint who;
  int asked = 0;
};

devices::OpenSource open_as(const std::string& name, std::unique_ptr<devices::LiveSource> source) {
  devices::OpenSource opened;
  opened.name = name;
  opened.source = std::move(source);
  return opened;
}

// The time is what the polls say, however long the machine takes.
TEST(LiveSourcesTest, ThePressedSwitchOfAFastrakIsTheTrigger) {
  devices::FastrakEmulatorOptions options;
  options.receivers = 1;
  devices::Feed feed;
  feed.motion = devices::still_motion;
  devices::EmulatedUnit unit(options, feed);
  devices::PseudoTerminal terminal;
  devices::Clocks clocks;
  std::vector<devices::OpenSource> opened;
  opened.push_back(open_source("fastrak:" + terminal.name(), clocks, {}));
  LiveSources sources(std::move(opened));
  sources.start();
  std::vector<devices::Sample> samples;
  const auto trigger = [&]() -> const devices::MouseSample* {
    for (const devices::Sample& sample : samples) {
      if (const auto* mouse = std::get_if<devices::MouseSample>(&sample)) return mouse;
    }
    return nullptr;
  };
  bool pressed = false;
  for (Time now{}; !trigger() && now < Time{60'000'000}; now += Time{1000}) {
    unit.step(now, terminal);
    sources.poll(now, samples);
    if (samples.size() > 40 && !pressed) pressed = unit.obey("press", now);
  }
  EXPECT_TRUE(pressed);
  ASSERT_TRUE(trigger());
  EXPECT_TRUE(trigger()->trigger);
}

TEST(LiveSourcesTest, StartTogetherAndEndWithTheLastOne) {
  std::vector<devices::OpenSource> opened;
  std::vector<TestSource*> each;
  for (const char* name : {"a", "b"}) {
    auto source = std::make_unique<TestSource>();
    each.push_back(source.get());
    opened.push_back(open_as(name, std::move(source)));
  }
  LiveSources sources(std::move(opened));
  for (const TestSource* one : each) EXPECT_EQ(one->started, 0);
  sources.start();
  for (const TestSource* one : each) EXPECT_EQ(one->started, 1);
  each[0]->over = true;
  EXPECT_FALSE(sources.exhausted());
  each[1]->over = true;
  EXPECT_TRUE(sources.exhausted());
}

TEST(PlayedTrials, GiveTheSessionTheirScenarioAndWhoTookPart) {
  devices::Clocks clocks;
  std::vector<devices::OpenSource> opened;
  opened.push_back(open_as("fastrak:here", std::make_unique<TestSource>()));
  opened.push_back(open_source(kDemoTrial, clocks, {}));
  const LiveSources sources(std::move(opened));
  const std::vector<PlayedTrial> played = played_by(sources);
  ASSERT_EQ(played.size(), 1u);
  EXPECT_EQ(played[0].path, kDemoTrial);
  const TrialHeader recorded = read_trial(kDemoTrial).header;
  const TrialHeader header = header_from(played);
  EXPECT_EQ(header.participant, recorded.participant);
  EXPECT_EQ(header.condition, recorded.condition);
  EXPECT_EQ(header.seed, recorded.seed);
  EXPECT_EQ(header_from({}).participant, "");

  Scenario scenario = scenario_of(played[0]);
  EXPECT_FALSE(is_of_another(played[0], scenario));
  scenario.look.samples = scenario.look.samples == 1 ? 2 : 1;  // is not counted
  EXPECT_FALSE(is_of_another(played[0], scenario));
  scenario.lane.width += 0.1;
  EXPECT_TRUE(is_of_another(played[0], scenario));
}

TEST(TrialOutputsTest, GiveTheFileAndTheListenersTheSameTrial) {
  const fs::path folder = fresh_folder("outputs");
  const fs::path file = folder / "trial.lcmlog", heard = folder / "heard.log";
  Session session = make_session(Scenario{});
  const TrialHeader header = header_of({}, session);
  {
    devices::LcmLink link("file://" + heard.string() + "?mode=w", kSessionPrefix);
    TrialOutputs outputs;
    outputs.publish(std::make_unique<TrialPublisher>(link, header));
    outputs.record(std::make_unique<Recorder>(file, header));
    devices::ReplaySource source(test::straight_throw(session.scenario()));
    for (int tick = 0; tick < 100; ++tick) {
      advance(session, source);
      outputs.tick(session);
    }
    outputs.write(FrameRecord{});
    Event last;
    last.time = session.now();
    last.kind = kind::kept_pace;
    last.detail = KeptPace{.ticks = session.tick};
    outputs.close(session, last);
  }
  const Trial recorded = read_trial(file);
  EXPECT_EQ(recorded.states.size(), 100u);
  EXPECT_EQ(recorded.frames.size(), 1u);
  EXPECT_TRUE(recorded.complete);
  const auto pace = std::ranges::find(recorded.events, kind::kept_pace, &Event::kind);
  ASSERT_NE(pace, recorded.events.end());
  EXPECT_EQ(pace->detail.value_or(KeptPace{}).ticks, 100);
  const auto sent = read_log(heard).channels;
  const auto stored = read_log(file).channels;
  for (const std::string_view channel :
       {kStateChannel, devices::kTrackerChannel, devices::kMouseChannel, kFrameChannel}) {
    const std::string name(channel);
    EXPECT_EQ(sent.at(std::string(kSessionPrefix) + name).messages, stored.at(name).messages)
        << name;
  }
}

TEST(TrialOutputsTest, CloseTheOtherOneAfterOneHasFailed) {
  TestSink::Got file, listeners;
  TrialOutputs outputs;
  outputs.record(std::make_unique<TestSink>(file));
  outputs.publish(std::make_unique<TestSink>(listeners));
  file.refuses = true;
  const Session session = make_session(Scenario{});
  Event last;
  last.kind = kind::kept_pace;
  EXPECT_THROW(outputs.write(last), std::runtime_error);
  outputs.close_after_failure(session, last);
  EXPECT_EQ(file.closed, 0);
  EXPECT_EQ(listeners.closed, 1);
  ASSERT_FALSE(listeners.events.empty());
  EXPECT_EQ(listeners.events.front().kind, kind::kept_pace);
}

/// A session of one test source, whose trial the test looks at.
struct OneSource {
  OneSource() {
    auto own = std::make_unique<TestSource>();
    source = own.get();
    std::vector<devices::OpenSource> opened;
    opened.push_back(open_as("the source", std::move(own)));
    sources.emplace(std::move(opened));
    trial.record(std::make_unique<TestSink>(file));
    monitor.emplace(*sources, pace, eyes, trial);
  }
  /// The news of the next tick, as text.
  std::vector<std::string> next(std::int64_t ticks = 1) {
    session.tick += ticks;
    monitor->tick(session);
    std::vector<std::string> texts;
    for (const LiveNews& news : monitor->take_news()) {
      EXPECT_EQ(news.time, session.now());
      texts.push_back(news.text);
    }
    return texts;
  }
  Session session = make_session(Scenario{});
  RealTime pace;
  FramesBeside eyes{[] { return std::make_unique<UnsteadyDrawer>(); }};
  TestSink::Got file;
  TrialOutputs trial;
  TestSource* source = nullptr;
  std::optional<LiveSources> sources;
  std::optional<LiveMonitor> monitor;
};

TEST(LiveMonitorTest, TellsOnceThatASourceIsInTroubleAndThatItIsBack) {
  OneSource live;
  EXPECT_THAT(live.next(), IsEmpty());
  live.source->state.trouble = "the line is cut";
  EXPECT_THAT(live.next(), ElementsAre("the line is cut"));
  EXPECT_THAT(live.next(), IsEmpty());
  live.source->state.trouble = "";
  EXPECT_THAT(live.next(), ElementsAre("the source is back"));
  EXPECT_TRUE(live.file.events.empty());
}

TEST(LiveMonitorTest, WritesFaultsOfASourceIntoTheTrialAlsoTheLastOnes) {
  OneSource live;
  live.source->state.faults = {{1, "1 sample left out"}};
  EXPECT_THAT(live.next(), ElementsAre("from the source, 1 sample left out"));
  live.source->state.faults = {{2, "2 samples left out"}};
  EXPECT_THAT(live.next(), IsEmpty());  // within ten seconds
  live.monitor->finish(live.session);
  ASSERT_EQ(live.file.events.size(), 2u);
  EXPECT_EQ(live.file.events[0].kind, kind::source_amiss);
  EXPECT_EQ(live.file.events[0].tick, 1);
  EXPECT_EQ(live.file.events[1].detail.text(), "from the source, 2 samples left out");
  EXPECT_EQ(live.monitor->take_news().size(), 1u);
}

TEST(LiveMonitorTest, TellsOnceThatTheRecordingIsLost) {
  OneSource live;
  const std::int64_t second = live.session.scenario().rates.physics_hz;
  EXPECT_THAT(live.next(), IsEmpty());
  live.file.lost = true;
  EXPECT_THAT(live.next(second), ElementsAre("session.lcmlog: was deleted; the session continues "
                                             "without a recording"));
  EXPECT_THAT(live.next(second), IsEmpty());
}

TEST(LiveMonitorTest, CountsSamplesAndPictures) {
  OneSource live;
  devices::TrackerSample head, bad;
  head.station = bad.station = devices::kHeadStation;
  head.X_TS.p = Vec3(0.0, -0.4, 1.7);
  bad.status = 'l';
  devices::ReplaySource source({head});
  while (!head_pose(live.session)) advance(live.session, source);
  live.session.samples = {head, bad, devices::MouseSample{}};
  std::vector<std::string> told;
  for (int frame = 0; frame < 2; ++frame) {
    live.eyes.tick(live.session);
    live.eyes.finish();
    for (const std::string& news : live.next(8)) told.push_back(news);  // two frames on
  }
  EXPECT_THAT(told, ElementsAre("it fell over"));
  EXPECT_EQ(live.file.frames, 1);
  ASSERT_EQ(live.file.events.size(), 1u);
  EXPECT_EQ(live.file.events[0].kind, kind::drawing_failed);
  const LiveState state = live.monitor->state(live.session);
  EXPECT_EQ(state.samples, 6);
  EXPECT_EQ(state.bad_samples, 2);
  EXPECT_EQ(state.frames, 1);
  EXPECT_EQ(state.drawing_failures, 1);
  EXPECT_EQ(state.now, live.session.now());
  ASSERT_EQ(state.sources.size(), 1u);
  EXPECT_EQ(state.sources[0].name, "the source");
  const auto pace = live.monitor->kept_pace(live.session).detail.value_or(KeptPace{});
  EXPECT_EQ(pace.ticks, live.session.tick);
  EXPECT_EQ(pace.frames, 1);
  EXPECT_EQ(pace.drawing_failures, 1);
}

// The whole scene at the start, with frame 0 and every five seconds; its poses with each frame.
TEST(LcmViewsTest, LaterViewersGetTheWholeScene) {
  const fs::path log = fresh_folder("views") / "viewer.log";
  Session session = make_session(Scenario{});
  const Rates rates = session.scenario().rates;
  {
    devices::LcmLink link("file://" + log.string() + "?mode=w");
    LcmScene view(link);
    view.start(session);
    for (; session.tick < 6 * rates.physics_hz; ++session.tick) view.tick(session);
  }
  auto channels = read_log(log).channels;
  EXPECT_EQ(channels["DRAKE_VIEWER_LOAD_ROBOT"].messages, 1 + 2);
  EXPECT_EQ(channels["DRAKE_VIEWER_DRAW"].messages, 1 + 6 * rates.frame_hz);
}

TEST(LcmViewsTest, PicturesArePublishedRawAndAsPng) {
  const fs::path log = fresh_folder("views") / "eyes.log";
  EyeFrame frame;
  for (render::Image& image : frame.images) image = {4, 2, std::vector<std::uint8_t>(24, 128)};
  std::map<bool, std::string> bytes;
  for (const bool png : {false, true}) {
    {
      LcmEyes eyes("file://" + log.string() + "?mode=w", png, 1.0);
      eyes.add(frame);
    }
    EXPECT_EQ(read_log(log).channels.at("HEADPIN_EYES").messages, 1);
    bytes[png] = slurp(log);
    fs::remove(log);
  }
  EXPECT_NE(bytes[false].find(std::string(24, '\x80')), std::string::npos);
  EXPECT_EQ(bytes[false].find("PNG"), std::string::npos);
  EXPECT_NE(bytes[true].find("\x89PNG"), std::string::npos);
}

/// Keeps the jobs that it gets.
struct ListingDrawer : FrameDrawer {
  explicit ListingDrawer(std::vector<FrameJob>& list) : jobs(list) {}
  const render::Fingerprint& drawn_by() const override { return who; }
  std::optional<DrawnFrame> draw(const FrameJob& job) override {
    jobs.push_back(job);
    return DrawnFrame{};
  }
  std::vector<FrameJob>& jobs;
  render::Fingerprint who;
};

TEST(FramesBesideTest, MoreFramesThanTicksAreDrawnOrLateAndKeepUpWithTime) {
  Scenario scenario;
  scenario.rates.frame_hz = 1000;
  Session session = make_session(scenario);
  devices::TrackerSample head;
  head.station = devices::kHeadStation;
  head.X_TS.p = Vec3(0.0, -0.4, 1.7);
  devices::ReplaySource source({head});
  std::vector<FrameJob> jobs;
  std::int64_t late = 0;
  {
    FramesBeside eyes{[&] { return std::make_unique<ListingDrawer>(jobs); }};
    while (session.now() < Time{1'000'000}) {
      advance(session, source);
      eyes.tick(session);
      eyes.finish();  // no frame is late because another is drawn
    }
    late = eyes.late();
  }
  ASSERT_EQ(jobs.size(), static_cast<std::size_t>(scenario.rates.physics_hz)) << "one a tick";
  EXPECT_EQ(static_cast<std::int64_t>(jobs.size()) + late, 1001) << "0 to 1000";
  for (const FrameJob& job : jobs) {
    EXPECT_EQ(job.frame, job.time.count() / 1000) << "the newest that is due";
  }
}

}  // namespace
}  // namespace headpin::scene
