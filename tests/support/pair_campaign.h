#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/non_colliding.h"

/// Random pairs of shapes, each answer of `closest_points` held against a proof of its own.
namespace headpin::engine::test {

enum class Form { sphere, ellipsoid, cylinder, cone, box, hull };
inline constexpr std::array kForms = {Form::sphere, Form::ellipsoid, Form::cylinder,
                                      Form::cone,   Form::box,       Form::hull};
const char* name(Form form);

/// What came of the pairs of two forms. Every kind of fault counts pairs, not answers.
struct Tally {
  std::int64_t pairs = 0, meeting = 0, shallow = 0, capped = 0;
  std::int64_t phantoms = 0;  ///< said to meet, more than 1e-6 of the size apart
  std::int64_t lost = 0;  ///< said to be apart, without a plane between them to 1e-9 of both sizes
  std::int64_t disagreed = 0;  ///< another verdict from a kept normal, gap over 1e-6 of the size
  std::int64_t deep = 0;  ///< shallow, cold: over 1.01 times the least depth and 1e-8 of the size
  std::int64_t deep_kept = 0;  ///< the same from a kept normal
  std::int64_t loose = 0;      ///< apart by less than the margin, and that is not the distance
  double worst = 1.0;          ///< depth over least depth, where a smaller one was found
  std::string example;         ///< the first fault, to make it again

  std::int64_t faults() const { return phantoms + lost + disagreed + deep + deep_kept + loose; }
};

/// `pairs` of two forms, either first: aspect ratios to 100, scales 1e-3 to 1e3, in four kinds of
/// places: faces, sides and rims facing each other at gaps and depths of 1e-7 to 0.1 of the size;
/// first contacts 0.5 to 5 % deep; axes along or against each other, to the last bit or nearly;
/// anywhere.
///
/// Each pair is asked cold, and warm with the normal it was left with, with that of a place a
/// little off, and with one of chance. Proofs are the test's own: a plane between the two by
/// `support`, a point of both by `contains`, and a polytope of points of A - B that holds a ball.
Tally try_pairs(Form a, Form b, std::int64_t pairs, std::uint64_t seed);

}  // namespace headpin::engine::test
