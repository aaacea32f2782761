#pragma once

#include <optional>
#include <vector>

#include "scene/people/participant_body.h"
#include "scene/people/swing.h"
#include "scene/play/run.h"
#include "scene/record/details.h"

/// A virtual participant who plays a whole session: walks to the buttons, touches one, throws,
/// touches the other, throws.
namespace headpin::scene {

struct ParticipantPlan {
  Person person;
  /// Throws with each version; ten is our choice, the paper has no number.
  int throws = 10;
  bool blue_first = false;  ///< else the red button is touched first
};

/// The current throw.
struct Thrown {
  Vec3 from_W = Vec3::Zero(), target_W = Vec3::Zero();
  std::optional<double> miss;  ///< to the right, where it passed the target [m]
  bool felled = false;
};

/// The participant acts only through device samples: it is the source of a session and, as an
/// observer, sees the result. After every tick it decides what to do next.
///
/// Its gaze follows ball and skittles. The next throw corrects a part of a miss. It moves away from
/// bodies that fly at it, after a reaction time. In the tracked space its feet stay within
/// `kStepsAside` of their first place; for longer ways it walks with the thumb buttons and looks
/// ahead. If it touches the button of the other version by accident, it goes back to that of the
/// version that is to be played, and begins that one again.
///
/// It depends only on person, plan and session: it uses no clock, and has the same bits on every
/// computer.
class Participant : public devices::Source, public Observer {
 public:
  /// @param scenario  as of the session, after set_up()
  Participant(const ParticipantPlan& plan, const Scenario& scenario);

  void poll(Time now, std::vector<devices::Sample>& out) override { body_.sense(now, out); }
  bool exhausted() const override { return finished(); }
  void tick(const Session& session) override;

  /// True when it has played all throws, or has given up: a ball did not come back, a button is out
  /// of reach, or the other version began too often.
  bool finished() const { return doing_ == Doing::nothing; }
  bool gave_up() const { return gave_up_; }
  int throws() const { return all_throws_; }
  /// Throws of all versions; fewer than planned if a game ends earlier.
  int throws_asked() const { return plan_.throws * static_cast<int>(versions_); }

  const ParticipantBody& body() const { return body_; }

 private:
  enum class Doing {
    arrives,
    walks_to_button,
    touches,
    walks_to_ball,
    takes,
    carries,
    addresses,
    swings,
    watches,
    leaves,
    nothing
  };

  void begin(Doing next, double now);
  void give_up(double now);
  void notice(const Session& session, double now);
  void go_back(const Session& session, double now, bool began_again);
  void end_version(double now);
  void act(const Session& session, double now);
  void turn_gaze(const Session& session, double now);

  void touch(const Session& session, double now);
  void wait_for_ball(const Session& session, double now);
  void take(const Session& session, double now);
  void address(const Session& session, double now);
  void throw_ball(double now);
  void watch(const Session& session, double now);
  void mend();

  bool walk_to(const Session& session, const Vec2& spot_W, double now);
  void walk_by_thumbs(const Session& session, const Vec2& way, double now);
  void draw_back(const Session& session, double now);
  Posture at_rest(double now) const;

  /// Of the version that is played, or that is to be begun.
  Colour next_colour() const;
  const Vec3& next_button(const Session& session) const;
  Vec2 button_spot(const Session& session) const;
  Vec2 ball_spot(const Session& session) const;
  Vec2 throwing_spot() const;

  ParticipantPlan plan_;
  Scenario scenario_;
  ParticipantBody body_;
  Random chance_;
  Vec2 home_P_;                           ///< of the feet
  double throw_x_ = 0.0, throw_y_ = 0.0;  ///< where the ball is let go, in the world

  Doing doing_ = Doing::arrives;
  double since_ = 0.0;  ///< of what it does
  int tries_ = 0;       ///< of that
  bool gave_up_ = false;
  std::size_t version_ = 0, versions_ = 1;
  int astray_ = 0;          ///< times that another version began by accident before it was over
  bool game_over_ = false;  ///< of the version
  int throws_ = 0, all_throws_ = 0;  ///< of the version, of the session

  int thumbs_ = 0;
  bool backward_ = false;
  double stepping_until_ = 0.0;
  bool trigger_ = false;
  double acted_ = 0.0;  ///< when what is waited for was seen or done; 0: not yet

  Swing swing_;
  double mended_ = 0.0;  ///< of the aim, to the left [rad]
  std::optional<Thrown> thrown_;
  std::optional<engine::BodyId> ball_;

  Vec3 gaze_W_ = Vec3::UnitY();
  std::optional<engine::BodyId> threat_;
  double threatened_since_ = 0.0, drawn_until_ = 0.0;
};

/// Largest distance of the feet from their first place; the tracker is accurate only near its
/// transmitter [m].
inline constexpr double kStepsAside = 0.3;

/// Replaces default values of a scenario for virtual participants: the transmitter is ahead of
/// them, where its noise is smallest at the release.
void set_up_for_participants(Scenario& scenario);

/// Gives the hand of a left-handed person station 3, if the scenario has the usual stations.
void set_up_hand(Scenario& scenario, const Person& person);

}  // namespace headpin::scene
