#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/page/page_parts.h"
#include "scene/play/run.h"
#include "scene/record/file.h"

/// The motion in a session, stored for the page.
namespace headpin::scene {

/// A visible object, with one mesh at a time.
struct Actor {
  std::string name, role;                  ///< role: "ball", "skittle", "hand" or "head"
  std::vector<std::array<float, 7>> X_WG;  ///< of each row: w, x, y, z, p
};

/// From a row on, an actor has another mesh, or is invisible.
struct Show {
  std::int64_t row = 0;
  std::size_t actor = 0;
  int mesh = -1;
};

/// From a row on, the score board has another text.
struct BoardChange {
  std::int64_t row = 0;
  std::vector<std::string> text;
};

/// From a row on, a ball has the first `kept` of its rings of oil, and then the added ones.
struct RingChange {
  std::int64_t row = 0;
  std::size_t actor = 0;  ///< the ball
  std::size_t kept = 0;
  nlohmann::json added;  ///< as of_rings()
};

/// Observes a session and stores what is visible and measured. Its memory is limited by the size of
/// a page: of a long session, it stores every n-th tick.
class Film : public Observer {
 public:
  /// @param recorded  bodies are shown as it has them where it has the tick; may be null
  /// @param ticks     that the session is going to have
  Film(const Looks& looks, const TrialSummary& trial, std::int64_t ticks, TrialPlayer* recorded);

  void start(const Session& session) override;
  /// @throws  as TrialPlayer::state
  void tick(const Session& session) override;

  std::int64_t every() const { return every_; }  ///< ticks from row to row
  std::int64_t rows() const { return rows_; }    ///< the last one is the last tick's
  const std::vector<Actor>& actors() const { return actors_; }
  const std::vector<Show>& shows() const { return shows_; }
  const std::vector<BoardChange>& board_changes() const { return board_changes_; }
  const std::vector<RingChange>& ring_changes() const { return ring_changes_; }
  std::int64_t contacts_left_out() const { return contacts_left_out_; }

  /// Poses, series, contacts, and the clocks of each tracker; to be asked for at the end, once.
  std::vector<Table> take_tables();

 private:
  void draw(const Session& session, const TickState* recorded);
  void note_rings(const nlohmann::json& rings, std::size_t ball);
  void measure(const Session& session, const TickState* recorded);
  void note_contacts(const Session& session);
  void note_clocks(const Session& session);
  void drop_weak_contacts();

  const Looks& looks_;
  TrialPlayer* recorded_;
  std::int64_t ticks_, every_, rows_ = 0;
  std::vector<Actor> actors_;
  std::vector<int> seen_as_;                                       ///< mesh of each actor
  std::map<std::pair<std::uint32_t, int>, std::size_t> actor_of_;  ///< by id, and which of that id
  std::vector<Show> shows_;
  std::vector<BoardChange> board_changes_;
  std::vector<RingChange> ring_changes_;
  std::size_t ringed_ = 0;  ///< the ball with rings in the last row
  nlohmann::json rings_ = nlohmann::json::array();
  Table series_, contacts_;
  std::int64_t contacts_left_out_ = 0;

  struct Clock {
    Table table;
    std::int64_t every = 1,
                 left = 0;          ///< samples of a group, and those of the one that is not full
    std::array<float, 3> latest{};  ///< of that group
  };
  static void end_group(Clock& clock);
  std::map<devices::Device, Clock> clocks_;
  struct Hand {
    Time time{};
    Vec3 p_W = Vec3::Zero();
  };
  std::vector<Hand> hand_;  ///< of the last ticks, oldest first
};

}  // namespace headpin::scene
