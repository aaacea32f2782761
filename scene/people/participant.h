#pragma once

#include <optional>
#include <vector>

#include "scene/people/participant_body.h"
#include "scene/people/swing.h"
#include "scene/play/run.h"

/// A virtual participant who plays a whole session: walks up, touches a button, throws, touches the
/// other, throws.
namespace headpin::scene {

struct ParticipantPlan {
  Person person;
  int throws = 10;          ///< of each version: ten is ours, the paper says no number
  bool blue_first = false;  ///< else the red button is touched first
};

/// What is remembered of a throw that is under way.
struct Thrown {
  Vec3 from_W = Vec3::Zero(), target_W = Vec3::Zero();
  std::optional<double> miss;  ///< to the right, where it passed the target [m]
  bool felled = false;
};

/// Plays as device samples only: it is the source of a session and, as an observer, sees what comes
/// of them. After every tick it decides what to do next; what it says is measured after that.
///
/// Its gaze follows ball and skittles; a miss is made good by the next throw, in part; what comes
/// flying it draws back from, a reaction time later. It stands in the tracked space with its feet
/// within `kStepsAside` of where they began and walks the rest by the thumbs, looking where it goes.
///
/// A function of person, plan and session: no clock, and the same bits on every machine.
class Participant : public devices::Source, public Observer {
 public:
  /// @param scenario  as of the session, after set_up()
  Participant(const ParticipantPlan& plan, const Scenario& scenario);

  void poll(Time now, std::vector<devices::Sample>& out) override { body_.sense(now, out); }
  bool exhausted() const override { return finished(); }
  void tick(const Session& session) override;

  /// It has played all it was asked to, or given up: a ball that does not come back, a button that is
  /// out of reach.
  bool finished() const { return doing_ == Doing::nothing; }
  bool gave_up() const { return gave_up_; }
  int throws() const { return all_throws_; }
  /// Of all versions; a game that ends sooner, or is none, leaves some.
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
  void act(const Session& session, double now);
  void look(const Session& session, double now);

  void touch(const Session& session, double now);
  void wait_for_ball(const Session& session, double now);
  void take(const Session& session, double now);
  void address(const Session& session, double now);
  void swing(double now);
  void watch(const Session& session, double now);
  void mend();

  bool walk_to(const Session& session, const Vec2& spot_W, double now);
  void walk_by_thumbs(const Session& session, const Vec2& way, double now);
  void draw_back(const Session& session, double now);
  Posture at_rest(double now) const;

  const Vec3& next_button(const Session& session) const;
  Vec2 button_spot(const Session& session) const;
  Vec2 ball_spot(const Session& session) const;
  Vec2 throwing_spot() const;

  ParticipantPlan plan_;
  Scenario scenario_;
  ParticipantBody body_;
  devices::Random chance_;
  Vec2 home_P_;                           ///< of the feet
  double throw_x_ = 0.0, throw_y_ = 0.0;  ///< where the ball is let go, in the world

  Doing doing_ = Doing::arrives;
  double since_ = 0.0;  ///< of what it does
  int tries_ = 0;       ///< of that
  bool gave_up_ = false;
  std::size_t version_ = 0, versions_ = 1;
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

/// Feet stay so near to where they began: the tracker is good near its transmitter [m].
inline constexpr double kStepsAside = 0.3;

/// Sets up what a scenario leaves at its defaults as virtual participants want it: a rig whose
/// transmitter stands ahead of them, where its noise is least as the ball is let go.
void set_up_for_participants(Scenario& scenario);

}  // namespace headpin::scene
