#include "scene/record/throw_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/record/table_fields.h"

namespace headpin::scene {

namespace {

/// A number that counts from 1; 0 is not known.
TableValue counted(int number) {
  return number > 0 ? TableValue(std::int64_t{number}) : TableValue();
}

/// A number of a ball's way.
template <auto Of>
TableValue of_path(const ThrowRow& r) {
  return r.path ? maybe(Of(*r.path)) : TableValue();
}

/// A number of the release, or of the entry.
template <double Delivered::*Member>
TableValue of_release(const ThrowRow& r) {
  return r.path ? TableValue(r.path->release.*Member) : TableValue();
}
template <double Delivered::*Member>
TableValue of_entry(const ThrowRow& r) {
  return r.path && r.path->entry ? TableValue((*r.path->entry).*Member) : TableValue();
}

template <double LanePlace::*Member>
TableValue of_breakpoint(const ThrowRow& r) {
  return r.path && r.path->breakpoint ? TableValue((*r.path->breakpoint).*Member) : TableValue();
}

/// The words of coaches. Boards count from the right gutter.
std::vector<TableField<ThrowRow>> lane_fields() {
  return {
      {"board", "number", "",
       "board of the ball's centre at its release: 1 is at the right gutter, 20 in the middle; "
       "empty in older trials, like all that follows but touched and leave",
       of_release<&Delivered::board>},
      {"launch_angle_deg", "number", "degree",
       "direction of its level velocity then, to the right of the lane's axis",
       of_release<&Delivered::angle_deg>},
      {"level_speed_mps", "number", "m/s", "its level speed then", of_release<&Delivered::speed>},
      {"revs_per_min", "number", "1/min", "revolutions per minute of its spin then",
       of_release<&Delivered::revs_per_min>},
      {"axis_rotation_deg", "number", "degree",
       "axis rotation then: 0 rolls ahead, 90 has all its level spin to hook to the left, -90 to the "
       "right, 180 spins back",
       of_release<&Delivered::rotation_deg>},
      {"axis_tilt_deg", "number", "degree", "tilt of the spin's axis out of the level then",
       of_release<&Delivered::tilt_deg>},
      {"loft_end_m", "number", "m",
       "distance from the foul line at which the ball first touched the lane",
       of_path<[](const BallPath& p) { return p.loft_end; }>},
      {"skid_end_m", "number", "m",
       "distance at which its direction had changed by 1 degree since then: until here it skidded",
       of_path<[](const BallPath& p) { return p.skid_end; }>},
      {"hook_end_m", "number", "m",
       "distance at which its lowest point slipped by less than 2 % of its speed: from here it "
       "rolled",
       of_path<[](const BallPath& p) { return p.hook_end; }>},
      {"breakpoint_board", "number", "",
       "board at which its velocity first turned to the other side of the lane",
       of_breakpoint<&LanePlace::board>},
      {"breakpoint_m", "number", "m", "distance of this place",
       of_breakpoint<&LanePlace::distance>},
      {"entry_board", "number", "",
       "board of its centre just before its first skittle, or where it passed the head pin's spot if "
       "it touched none on its way ahead; empty if it had left the lane sideways before",
       of_entry<&Delivered::board>},
      {"entry_revs_per_min", "number", "1/min", "revolutions per minute of its spin there",
       of_entry<&Delivered::revs_per_min>},
      {"exit_board", "number", "",
       "board at which it left the lane behind the skittles; empty if it was beside the lane by then",
       of_path<[](const BallPath& p) { return p.exit_board; }>},
      {"gutter_m", "number", "m",
       "distance at which it left the lane sideways before its entry; empty if it did so only after "
       "it had met its first skittle or passed the head pin's spot",
       of_path<[](const BallPath& p) { return p.gutter; }>},
      {"flare_mm", "number", "mm",
       "track flare: largest distance on the ball between its first ring of oil and a later one; "
       "empty with fewer than two rings, and in older trials",
       of_path<[](const BallPath& p) { return p.flare_mm; }>},
      {"touched", "text", "",
       "numbers of the skittles that the ball touched, in this order: 1-3-5-9; if it is taken up and thrown "
       "again without a game, of those that it had touched before, at most its first one",
       [](const ThrowRow& r) -> TableValue {
         return fmt::format("{}", fmt::join(r.touched, "-"));
       }},
      {"leave", "text", "",
       "numbers of the skittles that stood when the ball was counted, and of those that were set up again "
       "at once, after a foul or for a stray ball: 4-7; empty after a strike and without a game",
       [](const ThrowRow& r) { return maybe(r.leave); }}};
}

}  // namespace

std::vector<TableField<ThrowRow>> throw_fields() {
  using Row = ThrowRow;
  return std::vector<TableField<Row>>{
             {"version", "text", "",
              "version of the game: red or blue; empty if there are no versions",
              [](const Row& r) -> TableValue { return r.version; }},
             {"frame", "whole", "", "frame of the game, from 1; empty if the throw was not counted",
              [](const Row& r) { return counted(r.frame); }},
             {"ball", "whole", "", "ball of the frame, from 1; empty if the throw was not counted",
              [](const Row& r) { return counted(r.ball); }},
             {"body", "text", "", "name of the ball",
              [](const Row& r) -> TableValue { return r.body; }},
             {"release_time_s", "number", "s",
              "when the ball left the hand in the session: rig.delay_s after trigger_time_s; the time "
              "of the tick with hand.release_at = sample and in older trials",
              [](const Row& r) -> TableValue { return r.release; }},
             {"trigger_time_s", "number", "s",
              "time at which the trigger was released, as its device measured it; empty in older "
              "trials, like the vectors",
              [](const Row& r) { return maybe(r.trigger_s); }}} +
         maybe_vector_fields<[](const Row& r) { return r.p_WB; }, Row>(
             "x_m", "y_m", "z_m", "m", "centre of the ball at release_time_s, in the world") +
         maybe_vector_fields<[](const Row& r) { return r.v_WB; }, Row>(
             "vx_mps", "vy_mps", "vz_mps", "m/s", "velocity of the ball at release_time_s") +
         maybe_vector_fields<[](const Row& r) { return r.w_WB; }, Row>(
             "wx_radps", "wy_radps", "wz_radps", "rad/s",
             "angular velocity of the ball at release_time_s") +
         std::vector<TableField<Row>>{
             {"speed_mps", "number", "m/s", "speed of the ball at its release",
              [](const Row& r) -> TableValue { return r.speed; }},
             {"known", "text", "",
              "how the release is known: tracked, extrapolated or impossible; empty if the trial "
              "does not say",
              [](const Row& r) -> TableValue { return r.known; }},
             {"extrapolated_s", "number", "s",
              "time over which the hand's motion was extrapolated from its nearest sample",
              [](const Row& r) { return maybe(r.extrapolated_s); }},
             {"samples_left_out", "whole", "",
              "samples of the hand that were left out because they disagree with their neighbours",
              [](const Row& r) { return maybe(r.left_out); }},
             {"entry_time_s", "number", "s",
              "time at which the ball touched its first skittle, before it was taken up again; empty if it "
              "touched none",
              [](const Row& r) { return maybe(r.entry); }},
             {"entry_speed_mps", "number", "m/s", "speed of the ball just before that",
              [](const Row& r) { return maybe(r.entry_speed); }},
             {"entry_angle_deg", "number", "degree",
              "direction of its horizontal velocity just before that, to the right of the lane's "
              "axis",
              [](const Row& r) { return maybe(r.entry_angle_deg); }},
             {"felled_by_ball", "whole", "",
              "skittles that the ball knocked down, not as a stray ball: in a game until it was "
              "counted, else until the next throw",
              [](const Row& r) { return maybe(r.felled_by_ball); }},
             {"felled_by_hand", "whole", "",
              "skittles that the hand, or what it carried, knocked down in this time",
              [](const Row& r) { return maybe(r.felled_by_hand); }},
             {"counted", "whole", "",
              "skittles that the score sheet counts (after a foul perhaps 0); empty without a game",
              [](const Row& r) { return maybe(r.counted); }},
             {"foul", "yes/no", "",
              "whether the ball was released beyond the foul line; empty if the trial does not say",
              [](const Row& r) { return maybe(r.foul); }}} +
         lane_fields();
}

std::vector<std::pair<std::string, TableValue>> lane_values(const ThrowRow& row) {
  std::vector<std::pair<std::string, TableValue>> values;
  for (const TableField<ThrowRow>& field : lane_fields())
    values.emplace_back(field.name, field.value(row));
  return values;
}

}  // namespace headpin::scene
