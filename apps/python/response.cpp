#include "apps/python/response.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include <pybind11/eigen.h>

namespace headpin::python {

namespace {

using engine::Coefficients;
using engine::Encounter;

[[noreturn]] void refuse_impulse(const std::string& found) {
  throw std::invalid_argument("response: expected an impulse of three finite numbers, found " +
                              found);
}

Vec3 call(const py::function& law, const Encounter& e, const Coefficients& c) {
  const py::gil_scoped_acquire lock;
  const py::object given = law(e.u_W, e.K_W, e.n_AB_W, c.elasticity, c.friction);
  py::detail::make_caster<Vec3> impulse;
  if (!impulse.load(given, true)) refuse_impulse(py::repr(given).cast<std::string>());
  const Vec3 F = py::detail::cast_op<const Vec3&>(impulse);
  if (!F.allFinite()) refuse_impulse(py::repr(given).cast<std::string>());
  return F;
}

using CLaw = void (*)(const double* u, const double* K, const double* N, double elasticity,
                      double friction, double* impulse);

Vec3 call(CLaw law, const Encounter& e, const Coefficients& c) {
  Vec3 F = Vec3::Zero();
  law(e.u_W.data(), e.K_W.data(), e.n_AB_W.data(), c.elasticity, c.friction, F.data());
  if (!F.allFinite()) refuse_impulse("others from the C function");
  return F;
}

/// The number as an address; nothing for True and False, and where no address is so large.
std::optional<std::uintptr_t> address_of(const py::object& law) {
  if (!py::isinstance<py::int_>(law) || py::isinstance<py::bool_>(law)) return std::nullopt;
  static_assert(sizeof(std::uintptr_t) == sizeof(unsigned long long));
  const std::uintptr_t address = PyLong_AsUnsignedLongLong(law.ptr());
  if (PyErr_Occurred() == nullptr) return address;
  PyErr_Clear();  // the words are those for other kinds
  return std::nullopt;
}

/// The law whose sliding is used.
const engine::Response& sliding_named(const std::string& name) {
  try {
    return engine::response_named(name);
  } catch (const std::invalid_argument& error) {
    const std::string words = error.what();  // response: expected ...
    throw std::invalid_argument("sliding" + words.substr(std::min(words.find(':'), words.size())));
  }
}

}  // namespace

std::shared_ptr<const engine::Response> own_response(const py::object& law,
                                                     const std::optional<std::string>& sliding) {
  engine::Response own;
  own.name = "custom";
  own.sliding = sliding_named(sliding.value_or("paper")).sliding;
  if (law.is_none() || py::isinstance<py::str>(law)) {
    if (!sliding) return nullptr;
    throw std::invalid_argument(
        "sliding: expected a law of response of your own beside it, found response=" +
        py::repr(law).cast<std::string>() + "; a named response has its own sliding");
  }
  own.keeps = "what its function keeps";
  if (const std::optional<std::uintptr_t> address = address_of(law)) {
    if (*address == 0) throw std::invalid_argument("response: the address of its function is 0");
    const auto function = reinterpret_cast<CLaw>(*address);
    own.impulse = [function](const Encounter& e, const Coefficients& c) {
      return call(function, e, c);
    };
  } else if (PyCallable_Check(law.ptr()) != 0) {
    own.impulse = [function = py::reinterpret_borrow<py::function>(law)](
                      const Encounter& e, const Coefficients& c) { return call(function, e, c); };
  } else {
    throw std::invalid_argument(
        "response: expected a name, a function or the address of a C function, found " +
        py::repr(law).cast<std::string>());
  }
  return std::make_shared<const engine::Response>(std::move(own));
}

}  // namespace headpin::python
