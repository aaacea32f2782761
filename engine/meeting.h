#pragma once

#include <limits>
#include <optional>

#include "engine/touching.h"

/// When and where two bodies meet within a step. Private to the engine.
namespace headpin::engine::detail {

inline constexpr double kMeets = 1e-6;  // gap at which two surfaces count as met [m]
inline constexpr double kNever = std::numeric_limits<double>::infinity();

struct Meeting {
  ContactPoint point;
  double time = 0.0;      ///< from the start of the step [s]
  double approach = 0.0;  ///< [m/s]
};

/// The earliest meeting among the touch's present points that approach faster than `threshold`.
std::optional<Meeting> soonest(const World& world, const Flight& flight, const Touches& touches,
                               const Touch& touch, double threshold);

/// Follows both paths within the step to where the surfaces meet faster than `threshold`.
///
/// At the start of the step they may be centimetres apart, and the normal some degrees off.
/// @param touches  gets the new points at the end
/// @param touch    with points of the start of the step; gets those of the meeting
/// @return         none when they pass each other, or meet more slowly or later
std::optional<Meeting> find_meeting(const World& world, const Flight& flight, Touches& touches,
                                    Touch& touch, double threshold);

/// Removes the points that are apart and approach faster than `threshold`.
void leave_out_fast(const World& world, const Flight& flight, Touches& touches, Touch& touch,
                    double threshold);

/// In the paper's mode, bodies that are apart have no contact points. Follows those of a candidate, or parts of
/// them, that have no touch, from time `t` to the end of the step, and adds their touches if they meet as an
/// impact.
///
/// @param had  the candidate's touches are those from this number on
/// @return     how many were added
std::size_t look_ahead(const World& world, const Flight& flight, std::uint32_t candidate, double t,
                       std::size_t had, Touches& touches);

/// Whether two surfaces that are apart at the end of the step meet after it, as an impact.
bool lands_later(const World& world, const Flight& flight, const Touch& touch,
                 const ContactPoint& p);

/// Time for which the points of a touch are valid: until its bodies have turned far, or may have passed through
/// each other unseen [s].
double trusted_for(const World& world, const Flight& flight, const Touch& touch);

}  // namespace headpin::engine::detail
