#include "scene/stage/chosen_checks.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "scene/scenario/rules.h"
#include "scene/stage/scenario_checks.h"

namespace headpin::scene {

namespace {

class ChosenChecker {
 public:
  ChosenChecker(const Scenario& scenario, const ScenarioText& text)
      : s_(scenario), text_(text), lines_(text.one_line ? Lines{} : text.lines) {}

  void check_all() const {
    if (text_.names("rig")) check_rig();
    if (text_.names("game")) check_rules();
    if (text_.names("release")) check_release();
    if (text_.names("hmd")) check_picture();
    if (s_.version.buttons && (text_.names("version") || text_.names("room"))) check_ceiling();
  }

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& what,
                           std::vector<std::string> others) const {
    refuse_key(text_.where, lines_, key, what, std::move(others));
  }

  void check_rig() const {
    if (s_.rig.head_station == s_.rig.hand_station) {
      refuse("rig.hand_station",
             fmt::format("must be another than rig.head_station, found {} for both",
                         s_.rig.hand_station),
             {"rig.head_station"});
    }
  }

  void check_rules() const {
    const GameRules& game = s_.game;
    if (rules_of(game.rules).bonuses && game.balls > 2) {
      refuse("game.balls",
             fmt::format("must be 1 or 2 with game.rules \"{}\", found {}", name_of(game.rules),
                         game.balls),
             {"game.rules"});
    }
  }

  /// The added spin is about the direction of the throw, and a ball at rest has none.
  void check_release() const {
    if (s_.release.speed > 0.0 || s_.release.spin == 0.0) return;
    refuse("release.spin",
           fmt::format("must be 0 with release.speed 0, because a ball at rest has no direction "
                       "to spin about; found {}",
                       s_.release.spin),
           {"release.speed"});
  }

  /// Each edge of an eye's picture may be near its axis, but not two opposite ones.
  void check_picture() const {
    constexpr double kNarrowest = 1.0;  // as for the fields of view [degrees]
    constexpr double kRounding = 1e-9;
    const auto check = [&](const std::string& key, double edge, const std::string& other_key,
                           double other_edge, const std::string& both) {
      if (edge + other_edge >= kNarrowest - kRounding) return;
      refuse(key,
             fmt::format("must be {} degree or more together with {}, found {} and {}", kNarrowest,
                         other_key, edge, other_edge),
             {other_key, both});
    };
    const render::Edges deg = s_.hmd.optics.edges_deg();
    check("hmd.outer_deg", deg.outer, "hmd.inner_deg", deg.inner, "hmd.horizontal_fov_deg");
    check("hmd.up_deg", deg.up, "hmd.down_deg", deg.down, "hmd.vertical_fov_deg");
  }

  void check_ceiling() const {
    constexpr double kRounding = 1e-9;  // [m]
    const double highest = s_.room.height - s_.version.radius;
    for (const auto& [key, z] : {std::pair{"version.red.button", s_.version.red.button.z()},
                                 std::pair{"version.blue.button", s_.version.blue.button.z()}}) {
      if (z <= highest + kRounding) continue;
      refuse(key,
             fmt::format("must be below the ceiling at room.height: z at most {:.4g}, found {:.4g}",
                         highest, z),
             {"room.height", "version.radius"});
    }
  }

  const Scenario& s_;
  const ScenarioText& text_;
  Lines lines_;  ///< none where the text is one line
};

}  // namespace

void check_chosen(const Scenario& scenario, const ScenarioText& text) {
  ChosenChecker(scenario, text).check_all();
}

}  // namespace headpin::scene
