#include "scene/record/first_difference.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace headpin::scene {

namespace {

bool same_bits(const BodyState& a, const BodyState& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) ==
           0;
  };
  return equal(a.X_WB.p, b.X_WB.p) && equal(a.X_WB.q.coeffs(), b.X_WB.q.coeffs()) &&
         equal(a.V_WB.v, b.V_WB.v) && equal(a.V_WB.w, b.V_WB.w) && a.asleep == b.asleep;
}

/// Both sessions have all bodies, so their states have the same hash if they are equal.
std::optional<std::string> different_body_of_all(const TickState& a, const TickState& b,
                                                 std::span<const std::string> names) {
  const std::size_t bodies = std::min(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < bodies; ++i) {
    if (!same_bits(a.bodies[i], b.bodies[i])) {
      return i < names.size() ? names[i] : fmt::format("body {}", i);
    }
  }
  if (a.hash != b.hash || a.bodies.size() != b.bodies.size()) return std::string();
  return std::nullopt;
}

std::optional<std::string> different_body(const TickState& a, const TickState& b,
                                          const SharedBodies& shared) {
  if (shared.all()) return different_body_of_all(a, b, shared.names);
  for (std::size_t i = 0; i < shared.names.size(); ++i) {
    const std::size_t in_a = shared.in_a[i], in_b = shared.in_b[i];
    if (in_a >= a.bodies.size() || in_b >= b.bodies.size()) continue;
    if (!same_bits(a.bodies[in_a], b.bodies[in_b])) return shared.names[i];
  }
  return std::nullopt;
}

}  // namespace

SharedBodies shared_bodies(std::span<const std::string> a, std::span<const std::string> b) {
  SharedBodies shared;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = std::ranges::find(b, a[i]);
    if (found == b.end()) {
      shared.only_in_a.push_back(a[i]);
      continue;
    }
    shared.names.push_back(a[i]);
    shared.in_a.push_back(i);
    shared.in_b.push_back(static_cast<std::size_t>(found - b.begin()));
  }
  for (const std::string& name : b) {
    if (std::ranges::find(a, name) == a.end()) shared.only_in_b.push_back(name);
  }
  return shared;
}

std::optional<FirstDifference> compare(const TickState& a, const TickState& b,
                                       const SharedBodies& shared) {
  const std::optional<std::string> body = different_body(a, b, shared);
  if (!body) return std::nullopt;
  return FirstDifference{a.tick, a.time, *body};
}

std::optional<FirstDifference> compare(const NextState& a, const NextState& b,
                                       const SharedBodies& shared) {
  std::optional<TickState> of_a = a(), of_b = b();
  while (of_a && of_b && of_a->tick == of_b->tick) {
    if (auto difference = compare(*of_a, *of_b, shared)) return difference;
    of_a = a();
    of_b = b();
  }
  if (!of_a && !of_b) return std::nullopt;
  const bool only_in_a = !of_b || (of_a && of_a->tick < of_b->tick);
  const TickState& extra = only_in_a ? *of_a : *of_b;
  return FirstDifference{extra.tick, extra.time, "",
                         only_in_a ? FirstDifference::Lacks::b : FirstDifference::Lacks::a};
}

nlohmann::json to_json(const FirstDifference& difference) {
  return {
      {"tick", difference.tick}, {"time_s", seconds(difference.time)}, {"body", difference.body}};
}

}  // namespace headpin::scene
