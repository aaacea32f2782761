#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/python/module.h"
#include "engine/response.h"

namespace headpin::python {

/// A law of response of the caller's own, and how sliding continues at lasting contacts.
///
/// @param law      a function (u, K, N, elasticity, friction) -> impulse; an int, the address of a C
///   function `void (const double u[3], const double K[9], const double N[3], double elasticity,
///   double friction, double impulse[3])`; or none of the caller's own: a name, or None
/// @param sliding  name of the law whose sliding is used; without one, paper
/// @return  a law called "custom", destroyed with the interpreter's lock; nothing for a named law and None
/// @throws std::invalid_argument  for another kind of law, an unknown name of `sliding`, and one beside a
///   law that is not the caller's own
std::shared_ptr<const engine::Response> own_response(const py::object& law,
                                                     const std::optional<std::string>& sliding);

}  // namespace headpin::python
