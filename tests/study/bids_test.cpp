// Sessions as Motion-BIDS and back.

#include "study/bids.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "base/random.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "study/bids_read.h"
#include "tests/support/folder.h"

namespace headpin::study {
namespace {

/// Any samples, also such as no device sends.
std::vector<devices::Sample> any_samples(std::uint64_t seed) {
  Random random(seed);
  std::vector<devices::Sample> samples;
  for (int i = 0; i < 200; ++i) {
    const Time time{static_cast<std::int64_t>(random.next() % 4'000'000'000) - 1'000'000};
    if (random.next() % 5 == 0) {
      devices::MouseSample mouse;
      mouse.device_time = mouse.host_time = time;
      mouse.left_thumb = random.next() % 2 == 0;
      mouse.trigger = random.next() % 2 == 0;
      samples.emplace_back(mouse);
      continue;
    }
    devices::TrackerSample tracker;
    tracker.device_time = time;
    tracker.host_time = time + Time{static_cast<std::int64_t>(random.next() % 90'000)};
    tracker.session_time = time + Time{4166};
    tracker.sequence = static_cast<std::int64_t>(random.next() >> 8);
    tracker.station = 1 + static_cast<std::int32_t>(random.next() % 4);
    tracker.X_TS.p = random.normal3();
    tracker.X_TS.q = Quat(random.normal(), random.normal(), 1e-300, random.normal()).normalized();
    tracker.status = random.next() % 4 == 0 ? 'C' : ' ';
    tracker.buttons = random.next() % 2;
    tracker.sent_time = time - Time{static_cast<std::int64_t>(random.next() % 90'000)};
    tracker.position_estimated = random.next() % 2 == 0;
    tracker.orientation_estimated = random.next() % 2 == 0;
    samples.emplace_back(tracker);
  }
  return samples;
}

bool equal(const devices::Sample& a, const devices::Sample& b) {
  if (a.index() != b.index()) return false;
  if (const auto* s = std::get_if<devices::TrackerSample>(&a)) {
    const auto& t = std::get<devices::TrackerSample>(b);
    return s->device_time == t.device_time && s->host_time == t.host_time &&
           s->session_time == t.session_time && s->sequence == t.sequence &&
           s->station == t.station && s->X_TS.p == t.X_TS.p &&
           s->X_TS.q.coeffs() == t.X_TS.q.coeffs() && s->status == t.status &&
           s->buttons == t.buttons && s->sent_time == t.sent_time &&
           s->position_estimated == t.position_estimated &&
           s->orientation_estimated == t.orientation_estimated;
  }
  const auto& s = std::get<devices::MouseSample>(a);
  const auto& t = std::get<devices::MouseSample>(b);
  return s.device_time == t.device_time && s.host_time == t.host_time &&
         s.session_time == t.session_time && s.left_thumb == t.left_thumb &&
         s.right_thumb == t.right_thumb && s.trigger == t.trigger;
}

class MotionBids : public testing::Test {
 protected:
  MotionBids() {
    header_.participant = "p001";
    header_.seed = 18446744073709551615u;
    header_.scenario = "name = 'a \"room\"'\n[lane]\n";
    scene::Event event;
    event.kind = "version";
    event.detail = "{\"with\":\ta tab\nand a line}";
    event.bodies = {"ball", "skittle 1"};
    const BidsSession session{"p001", "01", &header_, any_samples(7), {event}};
    for (const auto& [name, text] : session_files(session)) {
      texts_[name.substr(name.rfind('/') + 1)] = text;
    }
  }
  scene::TrialHeader header_;
  std::map<std::string, std::string> texts_;
};

TEST_F(MotionBids, EveryFieldOfEverySampleComesBackInItsOrder) {
  const BidsTrial back = session_of(texts_);
  const std::vector<devices::Sample> samples = any_samples(7);
  ASSERT_EQ(back.samples.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_TRUE(equal(back.samples[i], samples[i])) << i;
  }
  EXPECT_EQ(back.header.participant, "p001");
  EXPECT_EQ(back.header.seed, header_.seed);
  EXPECT_EQ(back.header.scenario, header_.scenario);
}

TEST_F(MotionBids, EachStationIsATrackingSystemOfItsOwn) {
  std::set<std::string> systems;
  for (const auto& [name, text] : texts_) {
    if (!name.ends_with("_motion.tsv")) continue;
    const std::size_t from = name.find("_tracksys-") + std::string("_tracksys-").size();
    systems.insert(name.substr(from, name.find('_', from) - from));
  }
  EXPECT_THAT(systems, testing::IsSupersetOf({"head", "hand", "station3", "station4"}));
}

// "RAS": x to the right, y to the front, z up.
TEST_F(MotionBids, AxesOfATrackerAreThoseOfItsTransmitterInTheRoom) {
  const auto axes_with = [&](const Quat& q_WT) {
    BidsSession session{"p001", "01", &header_, any_samples(7), {}};
    session.rig.X_WT.q = q_WT;
    for (const auto& [name, text] : session_files(session)) {
      if (!name.ends_with("_tracksys-hand_run-01_channels.json")) continue;
      const auto frame = nlohmann::json::parse(text)["reference_frame"];
      return frame["Levels"]["global"]["SpatialAxes"].get<std::string>();
    }
    return std::string();
  };
  EXPECT_EQ(axes_with(Quat::Identity()), "RAS");
  EXPECT_EQ(axes_with(Quat(0.0, std::sqrt(0.5), -std::sqrt(0.5), 0.0)), "PLI");
  EXPECT_EQ(axes_with(Quat(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0)), "RSP");  // y up, z back
}

// No trial tells whose tracker it was.
TEST_F(MotionBids, SaysNoMakerAndTheRateThatWasMeasured) {
  std::vector<devices::Sample> samples;
  for (int i = 0; i < 91; ++i) {
    devices::TrackerSample sample;
    sample.station = devices::kHandStation;
    sample.device_time = tick_time(i, 90);
    samples.emplace_back(sample);
  }
  scene::Event imported;
  imported.kind = scene::kind::imported;
  for (const std::vector<scene::Event>& events : {{imported}, std::vector<scene::Event>()}) {
    int tables = 0;
    for (const auto& [name, text] : session_files({"p001", "01", &header_, samples, events})) {
      if (!name.ends_with("_tracksys-hand_run-01_motion.json")) continue;
      const nlohmann::json hand = nlohmann::json::parse(text);
      EXPECT_FALSE(hand.contains("Manufacturer"));
      EXPECT_EQ(hand["SamplingFrequency"], 90.0);
      EXPECT_EQ(hand["TrackingSystemName"], "receiver hand");
      ++tables;
    }
    EXPECT_EQ(tables, 1);
  }
}

/// A table without its last columns.
std::string without_last(const std::string& text, int columns) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    for (int i = 0; i < columns; ++i) line.resize(line.rfind('\t'));
    rest += line + "\n";
  }
  return rest;
}

TEST_F(MotionBids, OfOlderVersionsHasNoTimesOfSendingAndNoEstimates) {
  for (auto& [name, text] : texts_) {
    if (name.ends_with("_motion.tsv") && name.find("simulated") == std::string::npos) {
      text = without_last(text, 3);
    }
  }
  std::vector<devices::Sample> expected = any_samples(7);
  for (devices::Sample& sample : expected) {
    if (auto* tracker = std::get_if<devices::TrackerSample>(&sample)) {
      tracker->sent_time = Time{};
      tracker->position_estimated = tracker->orientation_estimated = false;
    }
  }
  const BidsTrial back = session_of(texts_);
  ASSERT_EQ(back.samples.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_TRUE(equal(back.samples[i], expected[i])) << i;
  }
}

// A tab or a line within a text would be another cell or row.
TEST_F(MotionBids, EveryRowOfTheEventsHasACellAColumn) {
  std::istringstream lines(texts_.at("sub-p001_task-bowling_run-01_events.tsv"));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(std::count(line.begin(), line.end(), '\t'), 14) << line;
  }
}

TEST_F(MotionBids, DamageIsSaidOrReadAndNothingElse) {
  Random random(3);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    auto damaged = texts_;
    auto at = damaged.begin();
    std::advance(at, static_cast<long>(random.next() % damaged.size()));
    if (at->second.empty()) continue;
    for (int hit = 0; hit < 3; ++hit) {
      at->second[random.next() % at->second.size()] = static_cast<char>(random.next());
    }
    if (random.next() % 4 == 0) at->second.resize(random.next() % at->second.size());
    try {
      session_of(damaged);
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

// The rig says where head and hand are.
TEST_F(MotionBids, NamesOfTrackingSystemsAreThoseOfTheRig) {
  BidsSession session{"p001", "01", &header_, any_samples(7), {}};
  const auto texts_with = [&](std::int64_t head, std::int64_t hand) {
    session.rig.head_station = head;
    session.rig.hand_station = hand;
    std::map<std::string, std::string> texts;
    for (const auto& [name, text] : session_files(session)) {
      texts[name.substr(name.rfind('/') + 1)] = text;
    }
    return texts;
  };
  const std::string stem = "sub-p001_task-bowling_tracksys-", end = "_run-01_motion.tsv";
  const auto usual = texts_with(1, 2), other = texts_with(2, 1), left = texts_with(1, 3);
  for (const auto& [name, station] : {std::pair("hand", "head"), {"head", "hand"}}) {
    EXPECT_EQ(other.at(stem + name + end), usual.at(stem + station + end));
  }
  EXPECT_EQ(left.at(stem + "lefthand" + end), usual.at(stem + "station3" + end));
  EXPECT_EQ(left.at(stem + "station2" + end), usual.at(stem + "hand" + end));
  for (const auto& texts : {usual, other, left}) {
    const BidsTrial back = session_of(texts);
    ASSERT_EQ(back.samples.size(), session.samples.size());
    for (std::size_t i = 0; i < back.samples.size(); ++i) {
      EXPECT_TRUE(equal(back.samples[i], session.samples[i])) << i;
    }
  }
}

// They did not say which stations they are of.
TEST_F(MotionBids, OfOlderVersionsNamesAreThoseOfStations1To3) {
  for (auto& [name, text] : texts_) {
    if (!name.ends_with("_events.json")) continue;
    nlohmann::json events = nlohmann::json::parse(text);
    EXPECT_EQ(events["HeadpinTrial"].erase("stations"), 1u);
    text = events.dump();
  }
  auto table = texts_.extract("sub-p001_task-bowling_tracksys-station3_run-01_motion.tsv");
  table.key() = "sub-p001_task-bowling_tracksys-lefthand_run-01_motion.tsv";
  texts_.insert(std::move(table));
  const BidsTrial back = session_of(texts_);
  const std::vector<devices::Sample> samples = any_samples(7);
  ASSERT_EQ(back.samples.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_TRUE(equal(back.samples[i], samples[i])) << i;
  }
}

TEST_F(MotionBids, WithoutOneOfItsTablesIsNoSession) {
  const std::string hand = "sub-p001_task-bowling_tracksys-hand_run-01_motion.tsv";
  const std::string events = "sub-p001_task-bowling_run-01_events.tsv";
  auto texts = texts_;
  texts.erase(hand);
  EXPECT_THAT(complaint([&] { session_of(texts); }),
              testing::StartsWith("sub-p001_task-bowling_run-01_events.json: expected a table of "
                                  "tracksys-hand, found none"));
  texts = texts_;
  texts.erase(events);
  EXPECT_THAT(complaint([&] { session_of(texts); }),
              testing::MatchesRegex("sub-p001_task-bowling_run-01_events.json: samples [0-9, ]+, "
                                    "... missing: a session is read with every row of .*"));
  texts = texts_;
  texts[hand] += texts[hand].substr(0, texts[hand].find('\n') + 1);
  EXPECT_THAT(complaint([&] { session_of(texts); }), testing::HasSubstr(" twice"));
}

// An axis by itself would take a direction that another one has: of the letters R and L, A and P, S and I, there is
// one each, and they are right-handed.
TEST_F(MotionBids, AxesOfAnyTransmitterAreARightHandedFrame) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    BidsSession session{"p001", "01", &header_, any_samples(7), {}};
    session.samples.resize(40);
    session.rig.X_WT.q =
        Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    for (const auto& [name, text] : session_files(session)) {
      if (!name.ends_with("_tracksys-hand_run-01_channels.json")) continue;
      const auto frame = nlohmann::json::parse(text)["reference_frame"];
      const std::string axes = frame["Levels"]["global"]["SpatialAxes"].get<std::string>();
      Mat3 R = Mat3::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        const auto place =
            static_cast<int>(std::string("RLAPSI").find(axes.at(static_cast<std::size_t>(axis))));
        R(place / 2, axis) = place % 2 == 0 ? 1.0 : -1.0;
      }
      EXPECT_EQ(R.determinant(), 1.0) << axes;
      EXPECT_GT((session.rig.X_WT.q.toRotationMatrix().transpose() * R).trace(), 1.5) << axes;
    }
  }
}

/// Head, buttons and hand, whose samples come one after the other.
std::map<std::string, std::string> one_after_the_other(const std::vector<int>& kinds) {
  std::vector<devices::Sample> samples;
  for (const int kind : kinds) {
    for (int i = 0; i < 5; ++i) {
      devices::TrackerSample tracker;
      tracker.station = kind;
      if (kind == 0) {
        samples.emplace_back(devices::MouseSample{});
      } else {
        samples.emplace_back(tracker);
      }
    }
  }
  scene::TrialHeader header;
  std::map<std::string, std::string> texts;
  for (const auto& [name, text] : session_files({"p001", "01", &header, samples, {}})) {
    texts[name.substr(name.rfind('/') + 1)] = text;
  }
  return texts;
}

// No later sample shows that they are missing.
TEST(MotionBidsTables, WhoseSamplesAllComeLastAreMissedToo) {
  const std::string hand = "sub-p001_task-bowling_tracksys-hand_run-01_motion.tsv";
  const std::string events = "sub-p001_task-bowling_run-01_events";
  auto texts = one_after_the_other({1, 0, 2});
  EXPECT_EQ(session_of(texts).samples.size(), 15u);
  std::string& rows = texts.at(hand);
  rows.erase(rows.rfind('\n', rows.size() - 2) + 1);
  EXPECT_THAT(complaint([&] { session_of(texts); }), testing::HasSubstr(": samples 14 missing"));
  texts.erase(hand);
  EXPECT_THAT(complaint([&] { session_of(texts); }),
              testing::HasSubstr("expected a table of tracksys-hand, found none"));
  texts = one_after_the_other({1, 2, 0});
  texts.erase(events + ".tsv");
  EXPECT_THAT(complaint([&] { session_of(texts); }),
              testing::HasSubstr(": samples 10, 11, 12, ... missing"));
  // Of an older version.
  nlohmann::json sidecar = nlohmann::json::parse(texts.at(events + ".json"));
  EXPECT_EQ(sidecar["HeadpinTrial"].erase("samples"), 1u);
  texts.at(events + ".json") = sidecar.dump();
  EXPECT_EQ(session_of(texts).samples.size(), 10u);
  sidecar["HeadpinTrial"]["samples"] = 9;
  texts.at(events + ".json") = sidecar.dump();
  EXPECT_THAT(complaint([&] { session_of(texts); }),
              testing::HasSubstr("expected 9 samples, found one of log_index 9"));
}

// A sampling frequency of 0 would say that nothing was sampled.
TEST(MotionBidsTables, OfSlowTrackersHaveTheirRateAndOfOneSampleNone) {
  const auto sidecar_of = [](int count) {
    std::vector<devices::Sample> samples;
    for (int i = 0; i < count; ++i) {
      devices::TrackerSample tracker;
      tracker.station = devices::kHandStation;
      tracker.device_time = Time{4'000'000} * i;
      samples.emplace_back(tracker);
    }
    scene::TrialHeader header;
    for (const auto& [name, text] : session_files({"p001", "01", &header, samples, {}})) {
      if (name.ends_with("_tracksys-hand_run-01_motion.json")) return nlohmann::json::parse(text);
    }
    return nlohmann::json();
  };
  EXPECT_EQ(sidecar_of(6)["SamplingFrequency"], 0.25);
  EXPECT_EQ(sidecar_of(6)["SamplingFrequencyEffective"], 0.25);
  const nlohmann::json one = sidecar_of(1);
  EXPECT_EQ(one["RecordingDuration"], 0.0);
  EXPECT_FALSE(one.contains("SamplingFrequency"));
  EXPECT_FALSE(one.contains("SamplingFrequencyEffective"));
}

// Their poses are no places in the room: a hand below the floor, a skittle behind the wall.
TEST(MotionBidsTables, OfTheSimulationHaveNoPosesOfBodiesThatAreNotInPlay) {
  scene::Session session = scene::make_session(scene::Scenario{});
  ASSERT_TRUE(session.stage->hand);
  const engine::BodyId hand = *session.stage->hand, skittle = session.stage->skittles.at(2);
  std::string table;
  SimulatedSystem simulated([&](const std::string& row) { table += row; });
  simulated.start(session);
  const auto seven_of = [&](engine::BodyId body) {
    table.clear();
    session.tick += 4;
    simulated.tick(session);
    std::vector<std::string> cells;
    std::istringstream row(table.substr(0, table.find('\n')));
    for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
    EXPECT_EQ(cells.size(), 1 + 7 * session.world.states.size());
    const auto first = cells.begin() + 1 + 7 * static_cast<std::ptrdiff_t>(body);
    return std::vector<std::string>(first, first + 7);
  };
  EXPECT_THAT(seven_of(hand), testing::Each("n/a"));
  EXPECT_THAT(seven_of(skittle), testing::Each(testing::Ne("n/a")));
  session.world.states[skittle].X_WB = scene::away_pose(*session.stage, skittle);
  session.world.states[hand].X_WB.p = Vec3(0.25, -1.0, 1.0);
  EXPECT_THAT(seven_of(skittle), testing::Each("n/a"));
  EXPECT_THAT(seven_of(hand), testing::ElementsAre("0.25", "-1", "1", "1", "0", "0", "0"));
  scene::TrialHeader header;
  for (const auto& [name, text] : simulated.files({"p001", "01", &header, {}, {}})) {
    if (!name.ends_with("_motion.json")) continue;
    EXPECT_THAT(nlohmann::json::parse(text)["TaskDescription"].get<std::string>(),
                testing::HasSubstr("n/a is the pose of a body that is not in play"));
  }
}

/// The sidecar of a hand that was measured at these ticks.
/// @param unit  of its stamps
nlohmann::json sidecar_of_ticks(const std::vector<int>& ticks, std::int64_t rate_hz,
                                Time unit = Time{1}) {
  std::vector<devices::Sample> samples;
  for (const int tick : ticks) {
    devices::TrackerSample tracker;
    tracker.station = devices::kHandStation;
    tracker.device_time = unit * (tick_time(tick, rate_hz) / unit);
    samples.emplace_back(tracker);
  }
  scene::TrialHeader header;
  for (const auto& [name, text] : session_files({"p001", "01", &header, samples, {}})) {
    if (name.ends_with("_tracksys-hand_run-01_motion.json")) return nlohmann::json::parse(text);
  }
  return {};
}

// A device of 60 Hz is one of 60 Hz too where a fifth of its samples are lost and the hand was away for 10 s. Its
// steps are 16666 or 16667 us.
TEST(MotionBidsTables, HaveTheRateOfTheDeviceWhateverIsLost) {
  std::vector<int> ticks;
  for (int i = 0; i < 2000; ++i) {
    if (i % 5 != 3 && (i < 500 || i >= 1100)) ticks.push_back(i);
  }
  for (const std::int64_t rate_hz : {60, 72, 90, 120, 240, 1000}) {
    const nlohmann::json hand = sidecar_of_ticks(ticks, rate_hz);
    EXPECT_EQ(hand["SamplingFrequency"], static_cast<double>(rate_hz));
    const double lasts = 1999.0 / static_cast<double>(rate_hz);
    EXPECT_NEAR(hand["SamplingFrequencyEffective"].get<double>(),
                static_cast<double>(ticks.size() - 1) / lasts, 1e-3);
  }
  // Far from a whole number of hertz it stays as it is: 40 / 3 Hz, every third tick of 40 Hz.
  std::vector<int> thirds;
  for (int i = 0; i < 100; ++i) thirds.push_back(3 * i);
  EXPECT_NEAR(sidecar_of_ticks(thirds, 40)["SamplingFrequency"].get<double>(), 40.0 / 3.0, 1e-9);
}

// In whole milliseconds the steps of 60 Hz are 16 and 17 ms, and those of 120 Hz 8 and 9 ms.
TEST(MotionBidsTables, HaveTheRateOfADeviceWithCoarseStamps) {
  std::vector<int> ticks;
  for (int i = 0; i < 2000; ++i) {
    if (i % 50 != 3 && (i < 500 || i >= 1100)) ticks.push_back(i);
  }
  for (const std::int64_t rate_hz : {60, 72, 90, 120, 144}) {
    EXPECT_EQ(sidecar_of_ticks(ticks, rate_hz, Time{1000})["SamplingFrequency"],
              static_cast<double>(rate_hz));
  }
}

}  // namespace
}  // namespace headpin::study
