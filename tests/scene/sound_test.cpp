// What is heard: damped oscillators, their way to the ears, and a session that sounds.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "scene/sound/hearing.h"

namespace headpin::scene {
namespace {

constexpr double kRate = static_cast<double>(kSoundRate);
constexpr std::size_t kLeftEar = 0, kRightEar = 1;

TEST(Resonator, IsADampedSine) {
  const Mode mode{.frequency = 1646.0, .decay = 103.0, .pressure = 1.0};
  Resonator resonator(mode);
  resonator.strike(2.0);
  for (int n = 0; n < kSoundRate / 5; ++n) {
    const double t = n / kRate;
    const double law =
        2.0 * std::exp(-mode.decay * t) * std::sin(2.0 * std::numbers::pi * mode.frequency * t);
    ASSERT_NEAR(resonator.next(), law, 1e-10) << n;  // rounding of 9600 steps
  }
}

TEST(Resonator, AddsAStrikeToWhatStillRings) {
  const Mode mode{.frequency = 440.0, .decay = 20.0, .pressure = 1.0};
  Resonator first(mode), second(mode), both(mode);
  first.strike(1.0);
  both.strike(1.0);
  for (int n = 0; n < 400; ++n) {
    if (n == 150) {
      second.strike(-0.3);
      both.strike(-0.3);
    }
    ASSERT_NEAR(both.next(), first.next() + second.next(), 1e-12) << n;
  }
}

TEST(Resonator, IsSilentWhenItHasFaded) {
  Resonator resonator({.frequency = 1000.0, .decay = 200.0, .pressure = 1.0});
  EXPECT_TRUE(resonator.fade());
  resonator.strike(1.0);
  EXPECT_FALSE(resonator.fade());
  // From 1 Pa, 1e-6 Pa is reached after ln(1e6) / 200 = 0.069 s.
  for (int n = 0; n < kSoundRate / 10; ++n) resonator.next();
  EXPECT_TRUE(resonator.fade());
  EXPECT_EQ(resonator.next(), 0.0);
}

/// The same skittle in another size, of the same wood.
Skittle scaled(Skittle skittle, double s) {
  skittle.height *= s;
  skittle.mass *= s * s * s;
  for (Vec2& point : skittle.profile) point *= s;
  return skittle;
}

// Bodies of one shape and one substance: frequency times size is the same (dimensional analysis).
TEST(Modes, OfABodyOfTwiceTheSizeAreAnOctaveLower) {
  const Scenario scenario;
  Ball large = scenario.ball;
  large.radius *= 2.0;
  large.mass *= 8.0;
  const std::array pairs = {std::pair(modes_of_skittle(scenario.skittle),
                                      modes_of_skittle(scaled(scenario.skittle, 2.0))),
                            std::pair(modes_of_ball(scenario.ball), modes_of_ball(large))};
  for (const auto& [one, twice] : pairs) {
    ASSERT_GE(one.size(), 3u);
    for (std::size_t k = 0; k < one.size(); ++k) {
      EXPECT_NEAR(twice[k].frequency, 0.5 * one[k].frequency, 1e-6 * one[k].frequency);
      EXPECT_NEAR(twice[k].decay, 0.5 * one[k].decay, 1e-6 * one[k].decay);  // per period as before
    }
  }
}

// A slender bar: Euler and Bernoulli's first bending mode is 1.028 r c / L^2 with gyration r / 2.
TEST(Modes, OfASlenderSkittleAreThoseOfAThinBar) {
  Skittle stick;
  stick.height = 2.0;
  stick.profile = {Vec2(0.0, 0.01), Vec2(1.0, 0.01), Vec2(2.0, 0.01)};
  const double speed = std::sqrt(12.6e9 / 705.0);
  const double root = 4.73004, law = root * root / (2.0 * std::numbers::pi) * 0.005 * speed / 4.0;
  EXPECT_NEAR(modes_of_skittle(stick).front().frequency, law, 0.002 * law);
}

// m x'' = -k x^(3/2), solved in small steps.
TEST(ContactTime, IsThatOfHertz) {
  const ContactSurface a{.curvature = 1.0 / 0.1, .modulus = 3e9, .poisson = 0.35};
  const ContactSurface b{.curvature = 1.0 / 0.06, .modulus = 1.6e9, .poisson = 0.4};
  const double mass = 1.2, speed = 5.0;
  const double compliance = (1 - 0.35 * 0.35) / 3e9 + (1 - 0.4 * 0.4) / 1.6e9;
  const double stiffness = 4.0 / 3.0 / compliance * std::sqrt(1.0 / (1 / 0.1 + 1 / 0.06));
  constexpr double kStep = 1e-8;
  double x = 0.0, v = speed, t = 0.0;
  do {
    v -= kStep * stiffness / mass * std::pow(std::max(0.0, x), 1.5);
    x += kStep * v;
    t += kStep;
  } while (x > 0.0);
  EXPECT_NEAR(contact_time(a, b, mass, speed), t, 0.005 * t);  // 2.87 has three digits
}

// The spectrum of half a sine of length T is |cos(pi f T) / (1 - (2 f T)^2)|, in parts of its impulse.
TEST(PartOfAnImpulse, IsThatOfHalfASineAtTheMaximaOfItsSpectrum) {
  constexpr double kTouching = 0.001;
  EXPECT_NEAR(part_of_impulse(1.0, kTouching), 1.0, 1e-9);
  for (const double half_waves : {2.0, 4.0, 6.0, 8.0}) {
    const double law = 1.0 / (half_waves * half_waves - 1.0);
    const double part = part_of_impulse(0.5 * half_waves / kTouching, kTouching);
    EXPECT_LT(std::abs(20.0 * std::log10(part / law)), 3.0) << half_waves;
  }
}

TEST(Ears, HearASoundAtTheRightEarlierAndLouderThere) {
  const std::array<Way, 2> ways = ways_to_ears({}, Vec3(3.0, 0.0, kHeadRadius));
  EXPECT_NEAR(ways[kLeftEar].delay - ways[kRightEar].delay,
              2.0 * kHeadRadius / kSpeedOfSound * kRate, 1e-9);
  EXPECT_NEAR(ways[kRightEar].gain, 1.0 / 2.91, 1e-12);
  EXPECT_NEAR(ways[kLeftEar].gain, 1.0 / 3.09, 1e-12);
  EXPECT_NEAR(ways[kRightEar].bright, 2.0, 1e-9);
  EXPECT_LT(ways[kLeftEar].bright, 0.3);
}

TEST(Ears, OfAHeadInAnotherPlaceHearTheSameFromTheSameSide) {
  const Pose X_WD{rotation(Vec3(0.3, -1.1, 0.4)), Vec3(1.0, -2.0, 1.7)};
  const Vec3 p_D(-0.8, 0.5, -2.0);
  const std::array<Way, 2> here = ways_to_ears({}, p_D), there = ways_to_ears(X_WD, X_WD * p_D);
  const std::array<Way, 2> mirrored = ways_to_ears({}, Vec3(0.8, 0.5, -2.0));
  for (const std::size_t ear : {kLeftEar, kRightEar}) {
    EXPECT_NEAR(there[ear].delay, here[ear].delay, 1e-9);
    EXPECT_NEAR(there[ear].bright, here[ear].bright, 1e-9);
    EXPECT_NEAR(mirrored[1 - ear].delay, here[ear].delay, 1e-9);
    EXPECT_NEAR(mirrored[1 - ear].bright, here[ear].bright, 1e-9);
  }
}

TEST(DelayLine, GivesASampleBetweenTwo) {
  DelayLine line(100.0);
  for (double n = 0.0; n <= 250.0; ++n) line.add(std::array{n});
  EXPECT_EQ(line.at(0.0), 250.0);
  EXPECT_NEAR(line.at(40.25), 209.75, 1e-12);
  EXPECT_NEAR(line.at(100.0), 150.0, 1e-12);
  EXPECT_NEAR(line.at(500.0), 150.0, 1e-12);
}

TEST(HeadShadow, LeavesLowFrequenciesAndDimsHighOnes) {
  for (const double bright : {0.1, 1.0, 2.0}) {
    HeadShadow low, high;
    double steady = 0.0, alternating = 0.0;
    for (int n = 0; n < 1000; ++n) {
      steady = low.filter(1.0, bright);
      alternating = high.filter(n % 2 == 0 ? 1.0 : -1.0, bright);
    }
    EXPECT_NEAR(steady, 1.0, 1e-9);
    EXPECT_NEAR(std::abs(alternating), bright, 1e-9);
  }
}

TEST(Limit, IsProportionalThenNearsTheFullScale) {
  EXPECT_EQ(limited(0.0), 0);
  EXPECT_EQ(limited(0.25 * kFullScale), 8192);  // 32767 / 4
  EXPECT_EQ(limited(-0.25 * kFullScale), -8192);
  std::int16_t last = 0;
  for (double pressure = 0.0; pressure < 40.0 * kFullScale; pressure += 0.01 * kFullScale) {
    const std::int16_t now = limited(pressure);
    EXPECT_GE(now, last);
    EXPECT_LE(now, 32767);
    last = now;
  }
  EXPECT_GT(last, 32000);
}

/// Devices that measure nothing.
class NoDevices : public devices::Source {
 public:
  void poll(Time, std::vector<devices::Sample>&) override {}
  bool exhausted() const override { return true; }
};

/// A room in which the ball begins above the lane.
Session with_ball(const Vec3& p_WB, const Vec3& v_WB = Vec3::Zero(),
                  const Vec3& w_WB = Vec3::Zero(), const Scenario& scenario = {}) {
  Session session = make_session(scenario);
  const engine::BodyId ball = session.stage->balls.front();
  engine::set_kind(session.world, ball, engine::Kind::free);
  engine::set_state(session.world, ball, {{Quat::Identity(), p_WB}, v_WB, w_WB});
  return session;
}

/// A head at a place, which looks ahead: as high as the lane, so that a sound there comes level.
Pose head_at(const Vec3& p_WD) {
  return {rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0)), p_WD};
}

struct HeardDrop {
  std::vector<StereoSample> samples;
  std::int64_t struck = -1;  ///< sample at the tick of the first impact
};

/// What a head hears of a session [s].
HeardDrop listen(Session session, const Pose& X_WD, double duration) {
  HeardDrop heard;
  NoDevices none;
  Hearing hearing(session, X_WD);
  while (seconds(session.now()) < duration) {
    advance(session, none);
    hearing.tick(session, heard.samples);
    if (heard.struck < 0 && !session.world.events.empty()) {
      heard.struck = static_cast<std::int64_t>(heard.samples.size());
    }
  }
  return heard;
}

std::int64_t first_heard(const std::vector<StereoSample>& samples, std::size_t ear) {
  const auto found =
      std::ranges::find_if(samples, [&](const StereoSample& both) { return both[ear] != 0; });
  return found == samples.end() ? -1 : found - samples.begin();
}

int loudest(const std::vector<StereoSample>& samples, std::size_t ear) {
  int most = 0;
  for (const StereoSample& both : samples) most = std::max(most, std::abs(both[ear]));
  return most;
}

constexpr double kRadius = 0.1085;
const Vec3 kAboveLane(0.0, 2.0, kRadius + 0.05);

TEST(Hearing, BeginsWhenTheSoundOfAnImpactHasComeToTheEar) {
  const Pose X_WD = head_at(Vec3(1.0, -1.0, 0.2));
  const HeardDrop heard = listen(with_ball(kAboveLane), X_WD, 0.3);
  ASSERT_GT(heard.struck, 0);
  EXPECT_EQ(heard.samples.size(), std::size_t{kSoundRate * 3 / 10});
  const std::array<Way, 2> ways = ways_to_ears(X_WD, Vec3(0.0, 2.0, kRadius));
  for (const std::size_t ear : {kLeftEar, kRightEar}) {
    // A sine begins with 0; half a millisecond later a sample is not rounded to 0 any more.
    const double come = static_cast<double>(heard.struck) + ways[ear].delay;
    EXPECT_NEAR(static_cast<double>(first_heard(heard.samples, ear)), come + 12.0, 12.0);
  }
  EXPECT_LT(first_heard(heard.samples, kLeftEar), first_heard(heard.samples, kRightEar));
}

TEST(Hearing, IsHalfAsLoudAtTwiceTheDistance) {
  const auto at = [](double distance) {  // of the ears, straight behind the ball
    const Pose X_WD = head_at(Vec3(0.0, 2.0 - distance + kHeadRadius, kRadius));
    return loudest(listen(with_ball(kAboveLane), X_WD, 0.2).samples, kLeftEar);
  };
  EXPECT_NEAR(at(4.0), 0.5 * at(2.0), 0.02 * at(2.0));  // the ball rises a little meanwhile
}

/// Amplitude at a frequency.
double amplitude(const std::vector<StereoSample>& samples, double frequency) {
  double cosine = 0.0, sine = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double angle = 2.0 * std::numbers::pi * frequency * static_cast<double>(n) / kRate;
    cosine += samples[n][0] * std::cos(angle);
    sine += samples[n][0] * std::sin(angle);
  }
  return std::hypot(cosine, sine);
}

TEST(Hearing, OfABallThatFallsOnTheLaneHasTheModesOfBoth) {
  const Session session = with_ball(kAboveLane);
  const HeardDrop heard = listen(session, head_at(Vec3(0.0, 1.0, 0.5)), 0.15);
  const double lane = modes_of_lane(session.stage->room).front().frequency,
               ball = modes_of_ball(session.scenario().ball).front().frequency;
  for (const double mode : {lane, ball}) {
    EXPECT_GT(amplitude(heard.samples, mode), 1.5 * amplitude(heard.samples, 1.5 * mode)) << mode;
  }
}

// All modes of a ball of 4 cm are too high for the samples, and what it strikes is not the lane.
TEST(Hearing, OfASmallBallThatMeetsAWallIsNotThatOfTheLane) {
  Scenario scenario;
  scenario.ball.radius = 0.02;
  scenario.ball.mass = 0.03;
  for (const Mode& mode : modes_of_ball(scenario.ball)) ASSERT_GT(mode.frequency, 0.4 * kRate);
  const double wall = 0.5 * scenario.room.width;
  const Session session =
      with_ball(Vec3(wall - 0.07, 1.0, 1.2), Vec3(5.0, 0.0, 0.0), Vec3::Zero(), scenario);
  const HeardDrop heard = listen(session, head_at(Vec3(wall - 1.0, 1.0, 1.2)), 0.1);
  ASSERT_GT(heard.struck, 0);
  EXPECT_EQ(loudest(heard.samples, kLeftEar), 0);
  EXPECT_EQ(loudest(heard.samples, kRightEar), 0);
}

TEST(Hearing, OfEqualSessionsIsEqual) {
  const Pose X_WD = head_at(Vec3(0.3, -1.0, 1.7));
  const Session session = with_ball(kAboveLane, Vec3(0.1, 6.0, 0.0));
  const HeardDrop once = listen(session, X_WD, 1.5), again = listen(session, X_WD, 1.5);
  EXPECT_EQ(once.samples, again.samples);
  EXPECT_GT(loudest(once.samples, kRightEar), 100);
}

TEST(Hearing, IsSilentWithoutAnImpactAndAgainSomeTimeAfterIt) {
  const Pose X_WD = head_at(Vec3(0.0, 0.0, 1.7));
  Session session = with_ball(kAboveLane);
  const HeardDrop heard = listen(session, X_WD, 2.0);
  for (std::int64_t n = 0; n < heard.struck; ++n) {
    ASSERT_EQ(heard.samples[static_cast<std::size_t>(n)], StereoSample{}) << n;
  }
  EXPECT_EQ(heard.samples.back(), StereoSample{});
}

TEST(Hearing, OfARollingBallLasts) {
  const double speed = 6.0;
  const Session session =
      with_ball(Vec3(0.0, 0.0, kRadius), Vec3(0.0, speed, 0.0), Vec3(-speed / kRadius, 0.0, 0.0));
  const HeardDrop heard = listen(session, head_at(Vec3(0.3, 1.0, 0.5)), 0.8);
  // Every 50 ms while it rolls, well before the skittles at 6 m.
  for (std::size_t from = kSoundRate / 5; from + 2400 < heard.samples.size(); from += 2400) {
    const auto begin = heard.samples.begin() + static_cast<std::ptrdiff_t>(from);
    EXPECT_GT(loudest({begin, begin + 2400}, kLeftEar), 1) << from;
  }
}

TEST(Hearing, OfAFloodOfImpactsStaysWithinTheScale) {
  Session session = with_ball(kAboveLane);
  NoDevices none;
  Hearing hearing(session, head_at(Vec3(0.0, 1.0, 0.5)));
  std::vector<StereoSample> samples;
  const engine::BodyId ball = session.stage->balls.front();
  const engine::ContactEvent blow{.a = ball,
                                  .b = session.stage->lane,
                                  .p_W = kAboveLane,
                                  .n_AB_W = -Vec3::UnitZ(),
                                  .impulse_W = Vec3(0.0, 0.0, 50.0),
                                  .approach_speed = 10.0};
  for (int n = 0; n < 24; ++n) {
    advance(session, none);
    session.world.events.assign(5000, blow);
    hearing.tick(session, samples);
  }
  EXPECT_EQ(samples.size(), std::size_t{kSoundRate / 10});
  EXPECT_GT(loudest(samples, kLeftEar), 30000);
  EXPECT_LE(loudest(samples, kLeftEar), 32767);  // none has turned over to -32768
}

/// A head that is seen from some time on.
class LateHead : public devices::Source {
 public:
  LateHead(Time from, const Rig& rig) : from_(from) {
    sample_.station = static_cast<std::int32_t>(rig.head_station);
  }
  void poll(Time now, std::vector<devices::Sample>& out) override {
    if (now < from_) return;
    sample_.device_time = sample_.host_time = now;
    out.emplace_back(sample_);
  }
  bool exhausted() const override { return false; }

 private:
  Time from_;
  devices::TrackerSample sample_;
};

TEST(Hearing, BeginsWithTheHeadAndNotWithWhatRangBefore) {
  Session session = with_ball(kAboveLane);
  LateHead head(Time{600'000}, session.scenario().rig);  // the ball lies still by then
  Hearing hearing(session);
  std::vector<StereoSample> samples;
  while (session.now() < Time{1'000'000}) {
    advance(session, head);
    hearing.tick(session, samples);
  }
  EXPECT_TRUE(head_pose(session).has_value());
  EXPECT_EQ(samples.size(), std::size_t{kSoundRate});
  EXPECT_EQ(loudest(samples, kLeftEar), 0);
}

}  // namespace
}  // namespace headpin::scene
