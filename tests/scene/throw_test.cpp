#include "scene/people/throw.h"

#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/resample.h"
#include "devices/recordings/motion_files.h"
#include "devices/recordings/table_motion.h"
#include "scene/people/arm_model.h"
#include "scene/people/throw_checks.h"
#include "scene/people/throw_readings.h"
#include "scene/play/hand.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// A file of the motion catalogue as a table, to be spoilt.
struct Csv {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;

  std::size_t column(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }

  /// Calls change(row, first column) for the columns that end in `suffix` of each tracked thing.
  void each(const std::string& suffix,
            const std::function<void(std::vector<double>&, std::size_t)>& change) {
    for (const char* thing : {"head", "left_hand", "right_hand"}) {
      for (auto& row : rows) change(row, column(thing + suffix));
    }
  }

  std::string text() const {
    std::string out = fmt::format("{}\n", fmt::join(names, ","));
    for (const auto& row : rows) out += fmt::format("{}\n", fmt::join(row, ","));
    return out;
  }
};

Csv parse(const std::string& text) {
  Csv csv;
  std::istringstream lines(text);
  std::string line, field;
  for (bool first = true; std::getline(lines, line); first = false) {
    std::istringstream fields(line);
    if (!first) csv.rows.emplace_back();
    while (std::getline(fields, field, ',')) {
      if (first) csv.names.push_back(field);
      if (!first) csv.rows.back().push_back(std::stod(field));
    }
  }
  return csv;
}

devices::MotionRecording read_csv(const std::string& text, double unit_m) {
  const devices::MotionOptions options{.reading = {.unit_m = unit_m}};
  return devices::recording_of(devices::parse_motion_table(text, "throw.csv", options), options,
                               "throw.csv");
}

/// The recording of a modelled throw as a file, in centimetres.
std::string synthesized() {
  const ThrowMotion motion({.seed = 3}, Hand{});
  const devices::MotionRecording r = record(motion, 3);
  std::string text = "delta_time_ms";
  for (const char* thing : {"head", "left_hand", "right_hand"}) {
    for (const char* field : {"pos_x", "pos_y", "pos_z", "rot_w", "rot_x", "rot_y", "rot_z"}) {
      text += fmt::format(",{}_{}", thing, field);
    }
  }
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    text += fmt::format("\n{}", r.times[i].count() / 1000);
    for (const auto* track : {&r.head, &r.left_hand, &r.right_hand}) {
      const Pose& X = (*track)[i];
      text += fmt::format(",{},{},{},{},{},{},{}", 100.0 * X.p.x(), 100.0 * X.p.y(),
                          100.0 * X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z());
    }
  }
  return text + "\n";
}

const char* const kRecorded = HEADPIN_SHARED_DIR "/throws/liebers_labstudy21_bowling.csv";

/// Each test runs on a modelled throw, and on a recorded one where that is at hand.
class ThrowTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (GetParam() == std::string("Synthesized")) {
      good_ = synthesized();
      return;
    }
    std::ifstream file(kRecorded);
    if (!file) GTEST_SKIP() << "no recorded throw at " << kRecorded;
    good_.assign(std::istreambuf_iterator<char>(file), {});
  }

  devices::MotionRecording good() const { return read_csv(good_, 0.01); }

  /// What is said of the good file, spoilt.
  std::string complaint(const std::function<void(Csv&)>& spoil, double unit_m = 0.01) const {
    Csv csv = parse(good_);
    spoil(csv);
    return complaint_about(csv.text(), unit_m);
  }

  std::string complaint_about(const std::string& text, double unit_m = 0.01) const {
    try {
      require_throw(read_csv(text, unit_m), Hand{}, "throw.csv");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  std::string good_;
};

INSTANTIATE_TEST_SUITE_P(Of, ThrowTest, testing::Values("Synthesized", "Recorded"),
                         [](const auto& throws) { return std::string(throws.param); });

TEST_P(ThrowTest, AGoodOneIsAccepted) {
  EXPECT_EQ(complaint([](Csv&) {}), "accepted");
}

TEST_P(ThrowTest, RefusesAnotherSizeThanAPersons) {
  EXPECT_THAT(complaint([](Csv&) {}, 1.0),
              AllOf(HasSubstr("the head is up 1"), HasSubstr("it would be one in centimetres")));
  const auto scaled = [&](double factor) {
    return complaint([&](Csv& csv) {
      csv.each("_pos_x", [&](auto& row, std::size_t c) {
        for (std::size_t i = c; i < c + 3; ++i) row[i] *= factor;
      });
    });
  };
  EXPECT_THAT(scaled(0.01), HasSubstr("it would be one in metres"));
  EXPECT_THAT(scaled(10.0), HasSubstr("it would be one in millimetres"));
  EXPECT_THAT(scaled(3.0), HasSubstr("it would be one at a third of the size"));
  EXPECT_THAT(scaled(1.0 / 3.0), HasSubstr("it would be one in inches"));
}

TEST_P(ThrowTest, RefusesAnotherPaceThanAPersons) {
  const auto scaled = [&](double factor) {
    return complaint([&](Csv& csv) {
      for (auto& row : csv.rows) row[csv.column("delta_time_ms")] *= factor;
    });
  };
  EXPECT_THAT(scaled(2.0), AllOf(HasSubstr("samples a second, expected 45 to 250"),
                                 HasSubstr("it would be one at twice the speed")));
  EXPECT_THAT(scaled(0.5), AllOf(HasSubstr("the right hand's fastest is 1"),
                                 HasSubstr("it would be one at half the speed")));
  EXPECT_THAT(scaled(10.0), HasSubstr("it would be one at ten times the speed"));
  EXPECT_THAT(scaled(0.1), HasSubstr("it would be one at a tenth of the speed"));
  EXPECT_THAT(scaled(1000.0), HasSubstr("it would be one with time in microseconds"));
  EXPECT_THAT(scaled(0.001), HasSubstr(" s, expected at least 100 in 2 s"));
}

TEST_P(ThrowTest, RefusesMirroredAxes) {
  const auto mirrored = [&](const char* axis) {
    return complaint(
        [&](Csv& csv) { csv.each(axis, [](auto& row, std::size_t c) { row[c] = -row[c]; }); });
  };
  // Heads are not turned along, and a head that follows the hand looks away from it then.
  EXPECT_THAT(mirrored("_pos_x"),
              AllOf(AnyOf(HasSubstr("the right hand is not on the right"),
                          HasSubstr("the head does not look at the ball")),
                    HasSubstr("it would be one with +x left, +y up and +z back")));
  EXPECT_THAT(mirrored("_pos_y"),
              AllOf(HasSubstr("the head is up -1."),
                    HasSubstr("it would be one with +x right, +y down and +z back")));
  EXPECT_THAT(mirrored("_pos_z"),
              AllOf(HasSubstr("not along the throw"),
                    HasSubstr("it would be one with +x right, +y up and +z ahead")));
}

TEST_P(ThrowTest, RefusesAMirroredPersonEvenWhenRotationsAgree) {
  EXPECT_THAT(complaint([](Csv& csv) {
                csv.each("_pos_x", [](auto& row, std::size_t c) { row[c] = -row[c]; });
                csv.each("_rot_y", [](auto& row, std::size_t c) { row[c] = -row[c]; });
                csv.each("_rot_z", [](auto& row, std::size_t c) { row[c] = -row[c]; });
              }),
              HasSubstr("the right hand is not on the right"));
}

/// The same throw by a left-hander: everything mirrored, the hands exchanged.
devices::MotionRecording left_handed(devices::MotionRecording r) {
  std::swap(r.left_hand, r.right_hand);
  for (auto* track : {&r.head, &r.left_hand, &r.right_hand}) {
    for (Pose& pose : *track) {
      pose.p.x() = -pose.p.x();
      pose.q = Quat(pose.q.w(), pose.q.x(), -pose.q.y(), -pose.q.z());
    }
  }
  return r;
}

TEST_P(ThrowTest, ALeftHandersIsOneByTheLeftHand) {
  const devices::MotionRecording right = good(), left = left_handed(right);
  EXPECT_EQ(throwing_side(right, Hand{}), Side::right);
  EXPECT_EQ(throwing_side(left, Hand{}), Side::left);
  EXPECT_NO_THROW(require_throw(left, Hand{}, "throw.csv", Side::left));
  try {
    require_throw(left, Hand{}, "throw.csv", Side::right);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("it would be one by the left hand"));
  }
  // The mirror of the right-hander's, in all that is found, and thrown by the session's hand.
  const Throw a = find_throw(right, Hand{}), b = find_throw(left, Hand{}, Side::left);
  EXPECT_EQ(a.grab, b.grab);
  EXPECT_EQ(a.release, b.release);
  EXPECT_LT((a.V_TB.v - Vec3(-b.V_TB.v.x(), b.V_TB.v.y(), b.V_TB.v.z())).norm(), 1e-9);
  const Scenario s = stand_thrower(Scenario{}, left, b, Heading::release);
  const Vec3 p_WB = s.rig.X_WT * (left.left_hand[b.release] * s.hand.grip);
  EXPECT_NEAR(p_WB.x(), 0.0, 1e-12);
  const auto hand = std::get<devices::TrackerSample>(to_samples(left, b)[1]);
  EXPECT_EQ(hand.station, devices::kLeftHandStation);
  EXPECT_EQ(s.rig.hand_station, devices::kLeftHandStation);
  EXPECT_EQ(hand.X_TS.p, left.left_hand[0].p);
}

TEST_P(ThrowTest, SeveralThrowsInAFileAreTakenApart) {
  const devices::MotionRecording one = good();
  devices::MotionRecording all = one;
  constexpr int kBack = 72;  // samples on the way back to the ball
  for (int k = 1; k <= kBack; ++k) {
    const double part = static_cast<double>(k) / (kBack + 1);
    all.times.push_back(one.times.back() + Time{14'000 * k});
    for (auto track : {&devices::MotionRecording::head, &devices::MotionRecording::left_hand,
                       &devices::MotionRecording::right_hand}) {
      const Pose &a = (one.*track).back(), &b = (one.*track).front();
      (all.*track).push_back({a.q.slerp(part, b.q), (1.0 - part) * a.p + part * b.p});
    }
  }
  const Time later = all.times.back() + Time{14'000} - one.times.front();
  for (std::size_t i = 0; i < one.times.size(); ++i) {
    all.times.push_back(one.times[i] + later);
    all.head.push_back(one.head[i]);
    all.left_hand.push_back(one.left_hand[i]);
    all.right_hand.push_back(one.right_hand[i]);
  }
  EXPECT_EQ(split_throws(one, Side::right).size(), 1u);
  const std::vector<devices::MotionRecording> apart = split_throws(all, Side::right);
  ASSERT_EQ(apart.size(), 2u);
  const double speed = find_throw(one, Hand{}).V_TB.v.norm();
  for (const devices::MotionRecording& r : apart) {
    EXPECT_NO_THROW(require_throw(r, Hand{}, "throw.csv"));
    EXPECT_EQ(r.times.front(), Time{});
    EXPECT_NEAR(find_throw(r, Hand{}).V_TB.v.norm(), speed, 1e-9);
  }
  // The first one's ball has until the next swing to reach the skittles.
  const Time next_release = later + find_throw(one, Hand{}).release_time;
  EXPECT_GT(apart[0].times.back(), next_release - Time{1'900'000});
  EXPECT_LT(apart[0].times.back(), next_release - Time{1'100'000});
  EXPECT_LT(apart[1].start, apart[0].times.back());
  // A gap on the way back stops neither.
  const std::size_t gap = one.times.size() + kBack / 2;
  for (std::size_t i = gap; i < all.times.size(); ++i) all.times[i] += Time{3'000'000};
  const std::vector<devices::MotionRecording> around_gap = split_throws(all, Side::right);
  ASSERT_EQ(around_gap.size(), 2u);
  for (const devices::MotionRecording& r : around_gap) {
    EXPECT_NO_THROW(require_throw(r, Hand{}, "throw.csv"));
    EXPECT_NEAR(find_throw(r, Hand{}).V_TB.v.norm(), speed, 1e-9);
  }
  EXPECT_EQ(around_gap[0].times.size(), gap);
  devices::MotionRecording alone = one;  // also beside the only throw
  for (const int later_us : {2'000'000, 2'014'000}) {
    alone.times.push_back(one.times.back() + Time{later_us});
    for (auto track : {&devices::MotionRecording::head, &devices::MotionRecording::left_hand,
                       &devices::MotionRecording::right_hand}) {
      (alone.*track).push_back((one.*track).back());
    }
  }
  EXPECT_EQ(split_throws(alone, Side::right).at(0).times.size(), one.times.size());
  EXPECT_EQ(around_gap[1].start, all.start + all.times[gap]);
}

TEST_P(ThrowTest, FewSamplesAndShortHolesAreTakenWithAWord) {
  const auto doubts_of = [](const auto& r) { return doubts(r, find_throw(r, Hand{})); };
  EXPECT_THAT(doubts_of(good()), testing::IsEmpty());
  Csv csv = parse(good_);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    if (i % 3 != 2) rows.push_back(csv.rows[i]);  // 72 a second become 48
  }
  csv.rows = rows;
  EXPECT_EQ(complaint_about(csv.text()), "accepted");
  EXPECT_THAT(doubts_of(read_csv(csv.text(), 0.01)),
              testing::Contains(HasSubstr("samples per second: below")));
  csv = parse(good_);
  csv.rows.erase(csv.rows.begin() + 40, csv.rows.begin() + 45);
  EXPECT_EQ(complaint_about(csv.text()), "accepted");
  EXPECT_THAT(doubts_of(read_csv(csv.text(), 0.01)),
              testing::ElementsAre(HasSubstr("the motion there is interpolated")));
  // A tracker of half the rate: each pose twice.
  devices::MotionRecording held = good();
  for (std::size_t i = 1; i < held.times.size(); i += 2)
    held.right_hand[i] = held.right_hand[i - 1];
  EXPECT_THAT(doubts_of(held), testing::Contains(HasSubstr("the right hand repeats its pose in ")));
  // Some programs end each line with a comma.
  std::string text = good_;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, ",");
  }
  EXPECT_EQ(complaint_about(text), "accepted");
}

TEST_P(ThrowTest, RefusesExchangedAxes) {
  EXPECT_THAT(complaint([](Csv& csv) {
                csv.each("_pos_y", [](auto& row, std::size_t c) { std::swap(row[c], row[c + 1]); });
              }),
              AllOf(HasSubstr("the head is up"),
                    HasSubstr("it would be one with +x right, +y back and +z up")));
}

TEST_P(ThrowTest, RefusesAnyOtherOrderOfTheQuaternion) {
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  while (std::next_permutation(order.begin(), order.end())) {
    // The modelled head turns too little for an exchange of x, y and z to show.
    if (order[0] == 0 && GetParam() == std::string("Synthesized")) continue;
    if (!kThorough && order[0] + 1 != order[1]) continue;
    const std::string found = complaint([&](Csv& csv) {
      csv.each("_rot_w", [&](auto& row, std::size_t c) {
        const std::array q = {row[c], row[c + 1], row[c + 2], row[c + 3]};
        for (std::size_t i = 0; i < 4; ++i) row[c + i] = q[order[i]];
      });
    });
    EXPECT_THAT(found, HasSubstr("not a person's throw"))
        << order[0] << order[1] << order[2] << order[3];
    if (order == std::array<std::size_t, 4>{1, 2, 3, 0}) {
      EXPECT_THAT(found, HasSubstr("with its quaternions read as x, y, z, w"));
    }
  }
}

TEST_P(ThrowTest, RefusesInvertedQuaternions) {
  EXPECT_THAT(complaint([](Csv& csv) {
                csv.each("_rot_w", [](auto& row, std::size_t c) { row[c] = -row[c]; });
              }),
              HasSubstr("it would be one with its quaternions inverted"));
}

TEST_P(ThrowTest, RefusesWhatIsNoRecording) {
  EXPECT_THAT(complaint([](Csv& csv) {
                csv.each("_rot_w", [](auto& row, std::size_t c) { row[c] *= 1.1; });
              }),
              HasSubstr("quaternions of length 1"));
  std::string text = good_;
  EXPECT_THAT(complaint_about(text.replace(text.find("right_hand_pos_x"), 16, "right_hand")),
              HasSubstr("not a person's throw"));  // the left hand is one
}

TEST_P(ThrowTest, ExchangedRowsAndAHoleOfOneCellAreMended) {
  EXPECT_EQ(complaint([](Csv& csv) { std::swap(csv.rows[200], csv.rows[201]); }), "accepted");
  EXPECT_EQ(complaint([](Csv& csv) { csv.rows[300][5] = std::nan(""); }), "accepted");
}

TEST_P(ThrowTest, RefusesAFileTooShortForAThrow) {
  const devices::MotionRecording recording = good();
  const Throw found = find_throw(recording, Hand{});
  const auto first = [&](std::size_t samples) {
    return complaint([&](Csv& csv) { csv.rows.resize(samples); });
  };
  EXPECT_THAT(first(0), HasSubstr("has column names but no rows; expected at least 100 samples"));
  EXPECT_THAT(first(1), HasSubstr("1 samples"));
  EXPECT_THAT(first(99), HasSubstr("99 samples"));
  for (const std::size_t samples : {std::size_t{150}, found.release - 30, found.release - 5,
                                    found.release, found.release + 2, found.release + 5}) {
    EXPECT_THAT(first(samples), HasSubstr("not a person's throw")) << samples;
  }
}

TEST_P(ThrowTest, RefusesAHoleInIt) {
  EXPECT_THAT(
      complaint([](Csv& csv) { csv.rows.erase(csv.rows.begin() + 100, csv.rows.begin() + 120); }),
      HasSubstr("expected no gap above 0.1"));
}

TEST_P(ThrowTest, TheBallLeavesLevelJustBeforeTheHandIsFastest) {
  const devices::MotionRecording r = good();
  const Throw found = find_throw(r, Hand{});
  EXPECT_LT(found.grab, found.release);
  double fastest = 0.0;
  std::size_t peak = 0;
  for (std::size_t i = 1; i + 1 < r.times.size(); ++i) {
    const Vec3 v =
        (r.right_hand[i + 1].p - r.right_hand[i - 1].p) / seconds(r.times[i + 1] - r.times[i - 1]);
    if (v.norm() > fastest) {
      fastest = v.norm();
      peak = i;
    }
  }
  EXPECT_EQ(found.peak_hand_speed, fastest);
  EXPECT_LE(found.release, peak);
  EXPECT_LT(r.times[peak] - r.times[found.release], Time{150'000});
}

TEST_P(ThrowTest, EveryHeadingPutsTheBallOverTheFoulLineOnALevelFloor) {
  const devices::MotionRecording r = good();
  const Throw found = find_throw(r, Hand{});
  for (const Heading heading : {Heading::release, Heading::gaze, Heading::keep}) {
    const Scenario s = stand_thrower(Scenario{}, r, found, heading);
    const Vec3 p_WB = s.rig.X_WT * (r.right_hand[found.release] * s.hand.grip);
    EXPECT_NEAR(p_WB.x(), 0.0, 1e-12);
    EXPECT_NEAR(p_WB.y(), 0.0, 1e-12);
    // Heights stay what they were: up is y there and z here, both from the floor.
    EXPECT_NEAR(p_WB.z(), (r.right_hand[found.release] * s.hand.grip).y(), 1e-12);
    const Vec3 home = s.rig.X_WT * (r.right_hand[found.grab] * s.hand.grip);
    EXPECT_LT((s.ball.home - home).norm(), 1e-12);
  }
}

TEST_P(ThrowTest, EachHeadingSendsDownTheLaneWhatItNames) {
  const devices::MotionRecording r = good();
  const Throw found = find_throw(r, Hand{});
  const auto q_WT = [&](Heading heading) {
    return stand_thrower(Scenario{}, r, found, heading).rig.X_WT.q;
  };
  const Vec3 v_WB = q_WT(Heading::release) * found.V_TB.v;
  EXPECT_NEAR(v_WB.x(), 0.0, 1e-12);
  EXPECT_GT(v_WB.y(), 3.0);
  const Vec3 kept = q_WT(Heading::keep) * -Vec3::UnitZ();
  EXPECT_TRUE(kept.isApprox(Vec3::UnitY(), 1e-12));
  Vec3 look = Vec3::Zero();
  for (std::size_t i = 0; i <= found.release; ++i) {
    if (r.times[i] < r.times[found.release] - Time{1'000'000}) continue;
    look += q_WT(Heading::gaze) * r.head[i].q * -Vec3::UnitZ();
  }
  EXPECT_NEAR(look.x() / look.y(), 0.0, 1e-12);
  EXPECT_GT(look.y(), 0.0);
}

TEST_P(ThrowTest, SamplesKeepEveryStampAndPose) {
  const devices::MotionRecording r = good();
  const Throw found = find_throw(r, Hand{});
  std::size_t i = 0;
  std::vector<std::pair<Time, bool>> trigger;
  for (const devices::Sample& sample : to_samples(r, found)) {
    if (const auto* mouse = std::get_if<devices::MouseSample>(&sample)) {
      trigger.emplace_back(mouse->device_time, mouse->trigger);
      continue;
    }
    const auto& tracker = std::get<devices::TrackerSample>(sample);
    if (tracker.station != devices::kHandStation) continue;
    EXPECT_EQ(tracker.device_time, r.times[i]);
    EXPECT_EQ(tracker.X_TS.p, r.right_hand[i].p);
    EXPECT_EQ(tracker.X_TS.q.coeffs(), r.right_hand[i].q.coeffs());
    ++i;
  }
  EXPECT_EQ(i, r.times.size());
  EXPECT_EQ(trigger, (std::vector<std::pair<Time, bool>>{{r.times[found.grab], true},
                                                         {r.times[found.release], false}}));
}

TEST(RecordedThrowTest, IsFoundAsMeasuredByHand) {
  std::ifstream file(kRecorded);
  if (!file) GTEST_SKIP() << "no recorded throw at " << kRecorded;
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const devices::MotionRecording r = read_csv(text, 0.01);
  const Throw found = find_throw(r, Hand{});
  EXPECT_EQ(r.times.size(), 517u);
  EXPECT_EQ(r.times.back(), Time{7'185'000});
  // Read off a plot, to a sample or two.
  EXPECT_NEAR(seconds(r.times[found.release]), 3.03, 0.015);
  EXPECT_NEAR(seconds(r.times[found.grab]), 0.6, 0.03);
  EXPECT_NEAR(found.peak_hand_speed, 7.7, 0.05);
}

/// Of a throw as one stands, and of balls that are laid down from a height.
class SynthesizedThrowTest : public testing::TestWithParam<std::optional<double>> {};

INSTANTIATE_TEST_SUITE_P(From, SynthesizedThrowTest,
                         testing::Values(std::nullopt, 0.4, 0.27, 0.14));

TEST_P(SynthesizedThrowTest, IsFoundWhereTheModelLetGo) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ThrowMotion motion({.seed = seed, .height = GetParam()}, Hand{});
    const devices::MotionRecording r = record(motion, seed);
    EXPECT_EQ(why_no_throw(r, Hand{}), std::vector<std::string>{}) << "seed " << seed;
    const Throw found = find_throw(r, Hand{});
    // Found from the motion alone, so only about where the trigger was let go.
    EXPECT_NEAR(seconds(r.times[found.release] - motion.release()), 0.0, 0.04) << "seed " << seed;
    EXPECT_NEAR(seconds(r.times[found.grab] - motion.grab()), 0.0, 0.3) << "seed " << seed;
    EXPECT_NEAR(found.V_TB.v.norm(), motion.ball_speed(), 0.5) << "seed " << seed;
  }
}

}  // namespace
}  // namespace headpin::scene
