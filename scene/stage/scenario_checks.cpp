#include "scene/stage/scenario_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "scene/stage/bodies.h"
#include "scene/stage/room.h"

namespace headpin::scene {

namespace {

/// A height that is given twice may differ only by rounding [m].
constexpr double kSame = 1e-3;
/// Counts as no gap: rounding of a sum [m].
constexpr double kNone = 1e-9;
constexpr double kRounded = 1e-6;  // of a mesh in single precision [m]

/// "rack.spots" of "rack.spots[2]".
std::string array_of(const std::string& key) {
  return key.substr(0, key.find('['));
}

/// "lane.toml:3" for the first of the keys that is in the text, "lane.toml" if none is.
std::string place(std::string_view where, const Lines& lines,
                  const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    if (const auto found = lines.find(key); found != lines.end()) {
      return fmt::format("{}:{}", where, found->second);
    }
  }
  return std::string(where);
}

class Checker {
 public:
  Checker(const Scenario& scenario, std::string_view where, const Lines& lines)
      : s_(scenario), where_(where), lines_(lines) {
    for (const SkittlePart& part : s_.skittle.parts) widest_ = std::max(widest_, part.radius);
  }

  void check_all() const {
    check_rates();
    check_parts();
    check_profile();
    check_weight();
    check_room();
    check_oil();
    check_spots();
    check_ball();
    check_core();
    if (s_.version.buttons) check_buttons();
  }

 private:
  /// @param others  keys with which it does not agree; the user may have set one of them instead
  [[noreturn]] void refuse(const std::string& key, const std::string& what,
                           std::vector<std::string> others = {}) const {
    refuse_key(where_, lines_, key, what, std::move(others));
  }

  void check_rates() const {
    if (s_.rates.physics_hz % 120 != 0) {
      refuse("rates.physics_hz",
             fmt::format("must be a multiple of 120, found {}", s_.rates.physics_hz));
    }
  }

  /// Checks that the parts of a skittle leave no gap from the base to the top.
  void check_parts() const {
    const std::vector<SkittlePart>& parts = s_.skittle.parts;
    std::vector<std::size_t> upwards(parts.size());
    std::iota(upwards.begin(), upwards.end(), 0u);
    std::ranges::stable_sort(upwards, {}, [&](std::size_t i) { return parts[i].low; });
    double top = 0.0;
    for (const std::size_t i : upwards) {
      const bool is_mesh = parts[i].shape == PartShape::polyhedron;
      if (parts[i].low > top + (is_mesh ? kRounded : kNone)) {
        refuse(fmt::format("skittle.parts[{}]", i + 1),
               top == 0.0
                   ? fmt::format("must begin at the base, 0; found {} as the lowest", parts[i].low)
                   : fmt::format("must leave no gap, found one from {} to {}", top, parts[i].low));
      }
      top = std::max(top, parts[i].high);
    }
    if (std::abs(top - s_.skittle.height) > kSame) {
      refuse("skittle.height",
             fmt::format("must be that of its parts, {:.6g}; found {:.6g}", top, s_.skittle.height),
             {"skittle.parts"});
    }
  }

  /// A skittle that is not round must be weighed to know whether it stands on its spot.
  void check_weight() const {
    const auto is_mesh = [](const SkittlePart& part) {
      return part.shape == PartShape::polyhedron;
    };
    if (std::ranges::none_of(s_.skittle.parts, is_mesh)) return;
    try {
      skittle_body(s_);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format(
          "{}: {}",
          place(where_, lines_, {"skittle.parts", array_of("skittle.parts"), "skittle.weighed"}),
          error.what()));
    }
  }

  void check_profile() const {
    const std::vector<Vec2>& profile = s_.skittle.profile;
    const auto key = [](std::size_t i) { return fmt::format("skittle.profile[{}]", i + 1); };
    if (profile.size() < 3) {
      refuse("skittle.profile", fmt::format("must be 3 points or more, found {}", profile.size()));
    }
    for (std::size_t i = 0; i < profile.size(); ++i) {
      if (profile[i].y() < 0.0) {
        refuse(key(i), fmt::format("must have radii of 0 or more, found {}", profile[i].y()));
      }
      if (i > 0 && !(profile[i].x() > profile[i - 1].x())) {
        refuse(key(i), fmt::format("must rise from point to point, found {} after {}",
                                   profile[i].x(), profile[i - 1].x()));
      }
    }
    if (s_.skittle.weighed == Weighed::profile &&
        std::ranges::none_of(profile, [](const Vec2& p) { return p.y() > kNone; })) {
      refuse("skittle.profile", "must have a radius above 0, found 0 for all points");
    }
    if (std::abs(profile.front().x()) > kSame) {
      refuse(key(0), fmt::format("must begin at the base, 0; found {}", profile.front().x()));
    }
    if (std::abs(profile.back().x() - s_.skittle.height) > kSame) {
      refuse(key(profile.size() - 1),
             fmt::format("must end at the skittle's height, {}; found {}", s_.skittle.height,
                         profile.back().x()),
             {"skittle.height"});
    }
  }

  void check_room() const {
    if (s_.lane.width >= s_.room.width) {
      refuse("lane.width", fmt::format("must be less than the room's, {}; found {}", s_.room.width,
                                       s_.lane.width));
    }
    if (s_.room.solid_ceiling && s_.skittle.height >= s_.room.height) {
      refuse("skittle.height",
             fmt::format("must be less than the room's, {}, under a solid ceiling; found {}",
                         s_.room.height, s_.skittle.height),
             {"room.height", "room.solid_ceiling"});
    }
    if (s_.lane.gutter_depth > 0.0) check_gutters();
  }

  /// Checks gutters that have depth. Painted gutters may be anywhere.
  void check_gutters() const {
    const Lane& lane = s_.lane;
    constexpr double kNarrowest = 0.02, kShallowest = 0.005;
    if (lane.gutter_depth < kShallowest) {
      refuse("lane.gutter_depth",
             fmt::format("must be 0, for a painted gutter, or {} and more; found {}", kShallowest,
                         lane.gutter_depth));
    }
    const double widest = 0.5 * (s_.room.width - lane.width) - (lane.kick_backs ? 0.15 : 0.01);
    if (!(lane.gutter_width >= kNarrowest && lane.gutter_width <= widest)) {
      refuse(
          "lane.gutter_width",
          fmt::format("must be {} to {:.4g}, between the lane and {}, where gutters have a depth; "
                      "found {}",
                      kNarrowest, widest, lane.kick_backs ? "the kick-backs" : "the wall",
                      lane.gutter_width),
          {"lane.gutter_depth", "lane.width", "lane.kick_backs", "room.width"});
    }
    const double side = 0.5 * lane.width - widest_;
    for (std::size_t i = 0; i < s_.rack.spots.size(); ++i) {
      if (std::abs(s_.rack.spots[i].x()) <= side) continue;
      refuse(fmt::format("rack.spots[{}]", i + 1),
             fmt::format("must stand on the lane beside its gutters: x within {:.4g}, found {:.4g}",
                         side, s_.rack.spots[i].x()),
             {"lane.width", "lane.gutter_depth"});
    }
  }

  /// Checks that the zones of an oil pattern lie on the lane before the skittles, one beside another.
  void check_oil() const {
    if (s_.lane.oil.wear > 0.0 && s_.lane.oil.zones.empty()) {
      refuse("lane.oil.wear",
             fmt::format("must be 0 on a lane without zones of oil, found {}", s_.lane.oil.wear),
             {"lane.oil.zones"});
    }
    const double deck = room_measures(s_).deck_begin();
    std::size_t number = 0;
    for (const OilZone& z : s_.lane.oil.zones) {
      const std::string key = key_of_zone(++number);
      if (z.first_board > z.last_board) {
        refuse(key, fmt::format("must have first_board at or before last_board, found {} and {} in "
                                "zone {}",
                                z.first_board, z.last_board, number));
      }
      if (!(z.from < z.to)) {
        refuse(key, fmt::format("must have from below to, found {} and {} in zone {}", z.from, z.to,
                                number));
      }
      if (z.to > deck) {
        refuse(key,
               fmt::format("must end before the skittles, at {:.6g} m; found {} in zone {}", deck,
                           z.to, number),
               {"lane.head_pin"});
      }
    }
    check_oil_has_no_hole(oil_by_place());
  }

  /// A pattern as a table: the number of the zone of each board, for each distance at which a zone
  /// begins or ends; 0 for none.
  struct OilTable {
    std::vector<double> distances;
    std::vector<std::array<std::size_t, kBoards>> zones;  // from each distance to the next one
  };

  static std::string key_of_zone(std::size_t number) {
    return fmt::format("lane.oil.zones[{}]", number);
  }

  OilTable oil_by_place() const {
    OilTable table;
    for (const OilZone& z : s_.lane.oil.zones) {
      table.distances.insert(table.distances.end(), {z.from, z.to});
    }
    std::ranges::sort(table.distances);
    table.zones.resize(table.distances.size());
    std::size_t number = 0;
    for (const OilZone& z : s_.lane.oil.zones) {
      ++number;
      for (std::size_t row = 0; row < table.distances.size(); ++row) {
        if (table.distances[row] < z.from || table.distances[row] >= z.to) continue;
        for (std::int64_t board = z.first_board; board <= z.last_board; ++board) {
          std::size_t& zone = table.zones[row][static_cast<std::size_t>(board - 1)];
          if (zone != 0) {
            refuse(key_of_zone(number),
                   fmt::format("must not overlap, found zones {} and {} on board {} at {} m", zone,
                               number, board, table.distances[row]));
          }
          zone = number;
        }
      }
    }
    return table;
  }

  /// Refuses places without oil that have some on both sides, along a board or across the lane.
  void check_oil_has_no_hole(const OilTable& table) const {
    struct Cell {
      std::size_t row, board;
    };
    const auto check_line = [&](std::size_t count, auto&& cell_at) {
      std::size_t last = count;  // with oil
      for (std::size_t k = 0; k < count; ++k) {
        const Cell cell = cell_at(k);
        const std::size_t zone = table.zones[cell.row][cell.board];
        if (zone == 0) continue;
        if (last < count && k > last + 1) {
          const Cell hole = cell_at(last + 1);
          refuse(key_of_zone(zone),
                 fmt::format("must leave no hole, found one before zone {}: board {} at {} m", zone,
                             hole.board + 1, table.distances[hole.row]));
        }
        last = k;
      }
    };
    const std::size_t rows = table.zones.size();
    for (std::size_t row = 0; row < rows; ++row) {
      check_line(kBoards, [&](std::size_t board) { return Cell{row, board}; });
    }
    for (std::size_t board = 0; board < kBoards; ++board) {
      check_line(rows, [&](std::size_t row) { return Cell{row, board}; });
    }
  }

  void check_spots() const {
    const std::vector<Vec2>& spots = s_.rack.spots;
    const double beside = 0.5 * s_.room.width - widest_;
    const double behind = widest_ - s_.room.behind, ahead = s_.room.ahead - widest_;
    for (std::size_t i = 0; i < spots.size(); ++i) {
      const Vec2 p(spots[i].x(), s_.lane.head_pin + spots[i].y());
      if (std::abs(p.x()) > beside || p.y() > ahead || p.y() < behind) {
        refuse(fmt::format("rack.spots[{}]", i + 1),
               fmt::format("must stand clear of the walls: x from {:.4g} to {:.4g}, lane.head_pin "
                           "+ y from {:.4g} to {:.4g}; found {:.4g} and {:.4g}",
                           -beside, beside, behind, ahead, p.x(), p.y()),
               {"lane.head_pin", "room.width", "room.ahead", "room.behind"});
      }
    }
    if (s_.lane.kick_backs) check_between_kick_backs();
    // Sorted by x, so that only neighbours are compared; there may be ten thousand.
    std::vector<std::size_t> order(spots.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return spots[i].x(); });
    for (auto a = order.begin(); a != order.end(); ++a) {
      for (auto b = a + 1; b != order.end(); ++b) {
        if (spots[*b].x() - spots[*a].x() >= 2.0 * widest_) break;
        const double apart = (spots[*b] - spots[*a]).norm();
        if (apart < 2.0 * widest_) {
          const auto [first, second] = std::minmax(*a, *b);
          refuse(fmt::format("rack.spots[{}]", second + 1),
                 fmt::format("must be {:.4g} apart, as wide as a skittle is; found spots {} and {} "
                             "{:.4g} apart",
                             2.0 * widest_, first + 1, second + 1, apart));
        }
      }
    }
  }

  void check_between_kick_backs() const {
    const RoomMeasures room = room_measures(s_);
    const double beside = room.kick_back_side() - widest_;
    for (std::size_t i = 0; i < s_.rack.spots.size(); ++i) {
      const Vec2& spot = s_.rack.spots[i];
      const bool before = room.head_pin + spot.y() < room.portal() - widest_;
      if (before || std::abs(spot.x()) <= beside) continue;
      refuse(fmt::format("rack.spots[{}]", i + 1),
             fmt::format("must stand between the kick-backs: x within {:.4g}, found {:.4g}", beside,
                         spot.x()),
             {"lane.kick_backs", "lane.width", "lane.gutter_width"});
    }
  }

  void check_ball() const {
    const double r = s_.ball.radius;
    const Vec3& home = s_.ball.home;
    const Room& room = s_.room;
    const auto within = [&](const char* axis, double value, double low, double high) {
      if (value >= low && value <= high) return;
      refuse("ball.home",
             fmt::format("must hold the ball clear of floor, walls and ceiling: {} from {:.4g} to "
                         "{:.4g}, found {:.4g}",
                         axis, low, high, value),
             {"ball.radius", "room.width", "room.height", "room.behind", "room.ahead"});
    };
    within("x", home.x(), r - 0.5 * room.width, 0.5 * room.width - r);
    within("y", home.y(), r - room.behind, room.ahead - r);
    within("z", home.z(), r, room.height - r);
    for (std::size_t i = 0; i < s_.rack.spots.size(); ++i) {
      const Vec2 spot(s_.rack.spots[i].x(), s_.lane.head_pin + s_.rack.spots[i].y());
      if ((home.head<2>() - spot).norm() < r + widest_ && home.z() < s_.skittle.height + r) {
        refuse(
            "ball.home",
            fmt::format("must hold the ball clear of the skittles, found it in skittle {}", i + 1));
      }
    }
  }

  /// Checks the core of a ball: that it is one, and that it has axes.
  void check_core() const {
    const Ball& ball = s_.ball;
    if (ball.rg == 0.0) {
      if (ball.differential == 0.0 && ball.intermediate == 0.0) return;
      refuse("ball.rg", "must be above 0 where the ball has a differential, found 0",
             {"ball.differential", "ball.intermediate"});
    }
    if (ball.rg >= ball.radius) {
      refuse("ball.rg", fmt::format("must be less than the ball's radius, {}; found {}",
                                    ball.radius, ball.rg));
    }
    if (ball.intermediate > ball.differential) {
      refuse("ball.intermediate",
             fmt::format("must be at most ball.differential, {}; found {}", ball.differential,
                         ball.intermediate),
             {"ball.differential"});
    }
    check_moments(ball.rg, ball.rg + ball.differential - ball.intermediate,
                  ball.rg + ball.differential);
    constexpr double kShortest = 1e-3;
    if (ball.pin.norm() < kShortest) refuse("ball.pin", "must be a direction, found none");
    if (ball.mass_bias.cross(ball.pin.normalized()).norm() < kShortest) {
      refuse("ball.mass_bias", "must be another direction than ball.pin, found the same",
             {"ball.pin"});
    }
  }

  /// Checks that a solid of the ball's size can have these radii of gyration about its three axes.
  void check_moments(double low, double middle, double high) const {
    const double a = low * low, b = middle * middle, c = high * high, r = s_.ball.radius;
    constexpr double kRounding = 1e-9;
    if (c > (a + b) * (1.0 + kRounding)) {
      refuse("ball.differential",
             fmt::format(
                 "must leave no moment of inertia above the sum of the two others; found radii of "
                 "gyration of {:.4g}, {:.4g} and {:.4g}",
                 low, middle, high),
             {"ball.rg", "ball.intermediate"});
    }
    if (a + b + c > 2.0 * r * r) {
      refuse("ball.rg",
             fmt::format(
                 "must be of matter inside the ball: at most {:.4g} about all axes for a radius of "
                 "{}; found {:.4g}, {:.4g} and {:.4g}",
                 std::sqrt(2.0 / 3.0) * r, r, low, middle, high),
             {"ball.radius", "ball.differential"});
    }
  }

  /// Checks that a text gives the materials of both versions: only the experimenter can choose
  /// them.
  void check_materials_of_versions() const {
    if (!lines_.contains("version.buttons")) return;
    for (const char* key : {"version.red.elasticity", "version.red.friction",
                            "version.blue.elasticity", "version.blue.friction"}) {
      if (lines_.contains(key)) continue;
      refuse(key, "must be a number from 0 to 1, because the scenario has buttons; found none",
             {"version.buttons"});
    }
  }

  void check_buttons() const {
    check_materials_of_versions();
    for (const auto& [key, cap] :
         {std::pair{"version.red.iterations", s_.version.red.iterations},
          std::pair{"version.blue.iterations", s_.version.blue.iterations}}) {
      constexpr int kLeast = 5;  // as for collision.iterations
      if (cap != 0 && cap < kLeast) {
        refuse(key, fmt::format("must be 0, or a cap from {} to 20; found {}", kLeast, cap),
               {"version.buttons"});
      }
    }
    const Room& room = s_.room;
    const double r = s_.version.radius;
    for (const auto& [key, p] : {std::pair{"version.red.button", s_.version.red.button},
                                 std::pair{"version.blue.button", s_.version.blue.button}}) {
      constexpr double kLowest = 0.3, kHighest = 2.2;  // heights that a hand can reach
      const bool inside = std::abs(p.x()) <= 0.5 * room.width - r && p.y() >= r - room.behind &&
                          p.y() <= room.ahead - r && p.z() >= kLowest && p.z() <= kHighest;
      if (inside) continue;
      refuse(
          key,
          fmt::format("must be within a hand's reach in the room: x within {:.4g}, y from {:.4g} "
                      "to {:.4g}, z from {} to {}; found {:.4g}, {:.4g}, {:.4g}",
                      0.5 * room.width - r, r - room.behind, room.ahead - r, kLowest, kHighest,
                      p.x(), p.y(), p.z()),
          {"version.buttons", "version.radius", "room.width", "room.behind", "room.ahead"});
    }
    if ((s_.version.red.button - s_.version.blue.button).norm() < 2.0 * r + 0.05) {
      refuse("version.blue.button",
             fmt::format("must be {:.4g} or more from the red one", 2.0 * r + 0.05),
             {"version.red.button", "version.radius"});
    }
  }

  const Scenario& s_;
  std::string_view where_;
  const Lines& lines_;
  double widest_ = 0.0;
};

}  // namespace

void check(const Scenario& scenario, std::string_view where, const Lines& lines) {
  Checker(scenario, where, lines).check_all();
}

void refuse_key(std::string_view where, const Lines& lines, const std::string& key,
                const std::string& what, std::vector<std::string> others) {
  others.insert(others.begin(), {key, array_of(key)});
  throw std::invalid_argument(
      fmt::format("{}: {} {}", place(where, lines, others), array_of(key), what));
}

}  // namespace headpin::scene
