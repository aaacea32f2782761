#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/looks/eyes.h"
#include "scene/play/session.h"
#include "sweep/thresholds.h"

/// Visible differences between two sessions with the same motion of the head.
namespace headpin::sweep {

/// Where a ball or skittle is: a ball's centre twice, or the middle of a skittle's foot and of its
/// head; in the world [m].
using Place = std::array<Vec3, 2>;

/// Where all balls and skittles are.
struct Places {
  std::size_t balls = 0;                 ///< the first of `of`; skittles follow
  std::vector<std::optional<Place>> of;  ///< nothing for a skittle that was swept away

  bool operator==(const Places&) const = default;
};

/// Balls, then skittles, in the order of the stage.
Places places_of(const scene::Session& session);
std::vector<std::string> names_of_places(const scene::Stage& stage);

/// The angle between two points as an eye sees them [arcmin].
double arcmin_between(const Vec3& p_WE, const Vec3& a_W, const Vec3& b_W);
/// The larger angle of the two points of a place.
double arcmin_between(const Vec3& p_WE, const Place& a, const Place& b);

/// The frame of a display of these rates that a tick is the first one of; nothing for other ticks.
std::optional<std::int64_t> frame_of(std::int64_t tick, const scene::Rates& rates);

/// Places at each frame of the display.
using Frames = std::vector<Places>;

/// The largest angle, on either retina, between the places of a body in two frames, of bodies within
/// the view [arcmin]. A skittle that was swept away in one of them does not count.
///
/// @param session  at one of the frames; its head looks
/// @param other    places in the other one
/// @return  nothing without a head, or with another number of balls or of skittles
std::optional<double> arcmin_in_view(const scene::Session& session, const Places& other);

/// A difference that is largest at some time.
struct Difference {
  double a = 0.0, b = 0.0;  ///< of both sessions
  double size = 0.0;        ///< how much they differ
  double times = 0.0;       ///< `size` by its threshold
  Time at{};
  std::optional<Time> first{};  ///< when it was first above the threshold
};

/// How one body differs between two sessions, while at least one eye sees it in one of them.
struct BodyApart {
  std::string body;
  std::array<double, 2>
      arcmin{};               ///< largest angle between its places, on the left and right retina
  Difference place;           ///< of the eye with the larger angle; `size` in arcmin
  double off_view_deg = 0.0;  ///< from the middle of the view when the place was first above
                              ///< the threshold, else when it differed most
  std::optional<Difference> speed;    ///< of its direction from the head [deg/s]; `size` a share
  std::optional<Difference> contact;  ///< first contact after the start [s]; `size` in ms
  std::optional<Difference> bounce;   ///< height of a ball's first bounce [m], 0 where it does not
                                      ///< rise; `size`: difference of its square root, the
                                      ///< restitution, as a share. Nothing where `a` would be 0
};

/// Compares two sessions that run side by side.
///
/// Angles are measured at the rate of the display from the places of the bodies, not from pixels. A
/// body counts in frames in which the display has at least one pixel of it; a contact or bounce if the
/// next frame has one, after it happened in either session. Its speed is the turn of
/// its direction from the point between the eyes over the last 100 ms, in the world: as for eyes
/// that follow the room while the head turns. The limit for an angle is a pixel of the display or
/// `kDetail`, whichever is larger.
class Apart {
 public:
  /// The names of both sessions, for messages.
  using Names = std::array<std::string, 2>;

  /// @param a, b  at their start, with the same tick rate and names of bodies
  /// @param gl    as render::open_context; both sessions are drawn with it
  /// @throws std::invalid_argument  for other bodies, another tick rate or another display
  /// @throws std::runtime_error     when no OpenGL context works
  Apart(const scene::Session& a, const scene::Session& b, std::string_view gl = {},
        Names names = {"one trial", "another trial"});

  /// After each tick of both.
  /// @throws std::runtime_error  where the two heads are not at the same pose
  void tick(const scene::Session& a, const scene::Session& b);

  /// The limit for angles: the larger of a pixel and `kDetail` [arcmin].
  double limit_arcmin() const { return limit_; }
  double pixel_arcmin() const { return pixel_; }
  std::int64_t frames() const { return frames_; }

  const std::vector<BodyApart>& bodies() const { return bodies_; }

  /// That skittles are drawn otherwise in the second session, which no body's difference has: a sentence; empty
  /// if they are drawn alike.
  const std::string& drawn() const { return drawn_; }

 private:
  /// Measures one frame.
  void measure_frame(const scene::Session& a, const scene::Session& b, const Pose& X_WD);
  void note_events(const scene::Session& session, bool is_b);
  void note_bounces(const scene::Session& session, bool is_b);
  void compare_moments();
  std::array<std::vector<bool>, 2> seen(const scene::Session& a, const scene::Session& b,
                                        const Pose& X_WD);

  /// When something first happened to a body in one session.
  struct Moment {
    Time at{};
    std::optional<bool> shown =
        {};  ///< whether the first frame from then on has a pixel of the body
  };
  /// Of a ball since its release: where its centre was as it first landed, and how far it rose from
  /// there.
  struct Bounce {
    std::optional<double> from = {}, height = {};  ///< [m]
    std::optional<Moment> over = {};               ///< at its highest point
    double z = 0.0, v = 0.0;                       ///< of the tick before [m, m/s]
  };
  template <typename See>
  void each_moment(const See& see);
  /// Directions from the head in the last 100 ms, oldest first.
  struct Directions {
    Time time{};
    std::vector<std::optional<Vec3>> towards_a, towards_b;  ///< nothing without a place
  };

  scene::Eyes eyes_a_, eyes_b_;
  Names names_;
  std::string drawn_;
  double pixel_ = 0.0, limit_ = 0.0;
  std::int64_t frames_ = 0;
  std::size_t balls_ = 0;
  std::vector<BodyApart> bodies_;
  std::array<std::vector<std::optional<Moment>>, 2> contacts_;
  std::array<std::vector<Bounce>, 2> bounces_;
  std::vector<Directions> recent_;
};

/// A number that is not negative, with that many digits and no exponent: 7280, 0.063; below a
/// thousandth "<0.001".
std::string in_digits(double value, int digits);

/// How many times as large as what is seen.
std::string times_in_words(double times);

/// The first difference above its threshold and the largest one, a sentence each; one sentence where
/// nothing is above. Then that skittles are drawn otherwise, where they are.
std::vector<std::string> in_sentences(const Apart& apart);

}  // namespace headpin::sweep
