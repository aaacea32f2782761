#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/play/score.h"

/// The measures of a session that a study compares.
namespace headpin::study {

/// Measures of one version.
struct VersionMeasures {
  int games = 0, games_over = 0;   ///< begun; played to their end
  int skittles = 0;                ///< as the sheets of all these games count them
  int throws = 0, fouls = 0;       ///< in all of them
  double release_speed_sum = 0.0;  ///< of its throws [m/s]
  double head_path_m = 0.0,
         hand_path_m = 0.0;  ///< in the world, of places a tenth of a second apart
  /// What flew at the player; got out of its way, where the approach ended before the version.
  int approaches = 0, evaded = 0;
  std::int64_t ticks = 0;

  std::optional<double> release_speed() const {
    if (throws == 0) return std::nullopt;
    return release_speed_sum / throws;
  }
  /// Not so if the version was played more than once, or not to its end.
  bool is_one_whole_game() const { return games <= 1 && games_over == games; }
};

struct SessionMeasures {
  std::map<std::string, VersionMeasures> versions;  ///< red, blue
  std::vector<std::string> order;                   ///< order in which they began
  std::int64_t unsolved_islands = 0;
  std::vector<scene::ThrowRow> throws;
  std::string state_hash, game_hash;
  double duration_s = 0.0;
};

/// Observes a session that is played or simulated again.
class Measurer : public scene::Observer {
 public:
  void tick(const scene::Session& session) override;

  /// The measures, at the end.
  SessionMeasures measures(const scene::Session& session) const;

 private:
  void add_paths(const scene::Session& session, VersionMeasures& version);

  SessionMeasures so_far_;
  scene::Score score_;
  std::string version_;
  std::optional<Vec3> head_W_, hand_W_;
};

}  // namespace headpin::study
