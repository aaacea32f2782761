#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "scene/play/session.h"
#include "scene/sound/ears.h"
#include "scene/sound/modal.h"
#include "scene/sound/modes.h"
#include "scene/sound/rolling.h"

/// What the participant hears of a session.
namespace headpin::scene {

/// Sound pressure of the largest sample [Pa]: 120 dB.
inline constexpr double kFullScale = 20.0;

/// The two samples of a moment, left first.
using StereoSample = std::array<std::int16_t, 2>;

/// A pressure as a sample. It is proportional up to half of the full scale; above, it nears the full
/// scale and never passes it.
std::int16_t limited(double pressure);

/// A ball or a skittle that rings, with the lane below it.
struct SoundingBody {
  engine::BodyId body = 0;
  ContactSurface surface;
  std::vector<Mode> modes;  ///< its own first, then those of the lane where it strikes it
  std::size_t own = 0;
  std::vector<Resonator> resonators = {};    ///< of the modes
  std::optional<RollingNoise> rolling = {};  ///< of a ball
  DelayLine line;
  std::array<Way, 2> ways = {};  ///< at the last tick
  std::array<HeadShadow, 2> shadows = {};
  Vec3 p_W = Vec3::Zero();     ///< at the last tick
  std::int64_t heard_for = 0;  ///< samples that may still come to the ears after it fell silent
};

/// Makes the sound of a session, tick by tick: 48000 samples a second for each ear.
///
/// The impulses of all impacts strike the modes of the two bodies (modes.h) and of the lane. A body
/// rings once, however often it is struck: the cost grows with the number of bodies and not with that
/// of impacts. A sound begins at its impact's tick and comes to the ears on its straight way
/// (ears.h). The room has no echo. Equal sessions have equal samples.
class Hearing {
 public:
  /// @param X_WD  pose of the head until a sample of it has come; none: nothing is heard until then
  explicit Hearing(const Session& session, std::optional<Pose> X_WD = std::nullopt);

  /// Appends the samples between the last tick and this one.
  void tick(const Session& session, std::vector<StereoSample>& out);

 private:
  void take_bodies(const Session& session);
  void sound(SoundingBody& source, const Session& session, const Pose& X_WD);
  void ring(SoundingBody& source, double speed);
  void hear(SoundingBody& source, Way way, std::size_t ear);
  void strike(const Session& session);
  void strike(SoundingBody& source, const ContactSurface& other, bool on_lane, double impulse,
              double mass, double speed);
  SoundingBody* source_of(engine::BodyId body);

  std::shared_ptr<const Stage> stage_;
  std::vector<SoundingBody> sources_;
  std::optional<Pose> X_WD_;
  std::int64_t samples_ = 0;
  std::vector<std::array<double, 2>> mix_;  ///< of this tick [Pa]
  std::vector<Resonator*> ringing_;         ///< of the body that is sounded now
  std::vector<double> pressures_;           ///< of it at 1 m, in each sample of this tick [Pa]
  std::vector<double> impulses_;            ///< of its rolling, before each of them [N s]
};

}  // namespace headpin::scene
