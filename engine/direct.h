#pragma once

#include "engine/sustained_rows.h"

/// Direct solution of an island: all its contacts at once. Private to the engine.
///
/// For limits of friction that are held, the velocities v of an island after the step are the
/// minimum of a convex function (Anitescu 2006; Castro, Permenter and Han 2022):
///
///     (v - v0) M (v - v0) / 2 + the cost of the impulses x(v),
///     x(v) = the part of x0 - (J v - allowed) / c inside the limits
///
/// where v0 are the velocities under the impulses x0 of before. The compliance c makes the problem
/// well-posed where contacts depend on each other, and x0 takes its effect away: repeated, this is
/// the proximal point method, which ends at rigid contacts. Newton's method finds each minimum; it
/// factorises a matrix of 6 x 6 blocks, one for each body and each two bodies that touch.
namespace headpin::engine::detail {

/// Chooses the order in which the bodies of an island are eliminated.
///
/// @return  whether the cost is small enough for a direct solution
bool plan_direct(const Island& s, Direct& direct);

/// Solves an island that `plan_direct` has planned, with its present loads as limits of friction.
/// If Newton's method does not converge, it changes nothing.
///
/// @param compliance  of contacts, as a part of the velocity that a unit impulse brings
/// @param residual    error of the velocities [m/s]
/// @return  number of Newton's steps, 0 if it did not converge
int solve_directly(const Island& s, Direct& direct, double compliance, double residual);

}  // namespace headpin::engine::detail
