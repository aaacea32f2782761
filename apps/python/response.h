#pragma once

#include <memory>
#include <string>

#include "apps/python/module.h"
#include "engine/response.h"

namespace headpin::python {

/// The law whose sliding is used.
/// @throws std::invalid_argument  for an unknown name
const engine::Response& sliding_named(const std::string& name);

/// A law of response of the caller's own, and how sliding continues at lasting contacts.
///
/// @param law      a function (u, K, N, elasticity, friction) -> impulse; or an int, the address of
///   a C function `void (const double u[3], const double K[9], const double N[3], double
///   elasticity, double friction, double impulse[3])`
/// @param sliding  name of the law whose sliding is used
/// @return  a law called "custom"; destroyed with the interpreter's lock
/// @throws std::invalid_argument  for another kind of law, or an unknown name
std::shared_ptr<const engine::Response> own_response(const py::object& law,
                                                     const std::string& sliding);

}  // namespace headpin::python
