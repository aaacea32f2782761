#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/play/score.h"
#include "sweep/apart.h"

namespace headpin::sweep {

/// A column of the results of a replay.
struct ResultColumn {
  const char* name;  ///< with the unit last
  const char* unit;  ///< empty where there is none
  const char* meaning;
};

/// All of them; the last one is `error`.
const std::vector<ResultColumn>& result_columns();

/// Sums up a session as it runs.
class Result : public scene::Observer {
 public:
  /// @param recorded  places under the trial's own condition, which must outlive this; null: unknown
  /// @param rates     of that condition
  Result(const Frames* recorded, const scene::Rates& rates) : recorded_(recorded), rates_(rates) {}

  void tick(const scene::Session& session) override;

  /// Cells in the order of result_columns(); an empty cell where there is no such number.
  std::vector<std::string> cells(const scene::Session& session) const;

 private:
  /// The recorded places at the time of this tick, if they are known.
  const Frames::value_type* recorded_now(const scene::Session& session) const;

  const Frames* recorded_;
  scene::Rates rates_;
  std::optional<double> apart_arcmin_;
  scene::Score score_;
  std::int64_t last_awake_ = 0;  ///< tick
};

/// The cells of a replay that could not be made.
std::vector<std::string> failed_cells(const std::string& reason);

}  // namespace headpin::sweep
