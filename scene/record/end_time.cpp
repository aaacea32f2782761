#include "scene/record/end_time.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::scene {

Time end_time(double end_s, std::string_view where) {
  if (std::abs(end_s) < 4e9) return microseconds(end_s);
  throw std::invalid_argument(fmt::format("{}: end_s: expected seconds, found {}", where, end_s));
}

}  // namespace headpin::scene
