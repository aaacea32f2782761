#include "engine/broad_phase.h"

#include <algorithm>
#include <cmath>

namespace headpin::engine {

double distance(const Capsule& a, const Capsule& b) {
  // Closest points of two segments, p = a.a + s u and q = b.a + t v, s and t in [0, 1].
  const Vec3 u = a.b - a.a, v = b.b - b.a, r = a.a - b.a;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double ur = u.dot(r), vr = v.dot(r);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-12 * uu * vv ? std::clamp((uv * vr - ur * vv) / det, 0.0, 1.0) : 0.0;
  double t = vv > 0.0 ? (uv * s + vr) / vv : 0.0;
  if (t < 0.0 || t > 1.0 || !(vv > 0.0)) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0.0 ? std::clamp((uv * t - ur) / uu, 0.0, 1.0) : 0.0;
  }
  return (r + s * u - t * v).norm() - a.radius - b.radius;
}

namespace {

/// So many bodies are compared directly, each with each: quicker than any grid.
constexpr std::size_t kFew = 24;

/// Coordinate of the cell in which a coordinate lies.
std::int32_t cell_of(double x, double cells_per_metre) {
  const double c = std::clamp(x * cells_per_metre, -1e9, 1e9);
  const auto towards_zero = static_cast<std::int32_t>(c);
  return towards_zero - (c < towards_zero ? 1 : 0);
}

/// Place of a cell in a grid of powers of two that the world is wrapped round.
struct Slot {
  std::uint32_t bits[3];
  std::uint32_t operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const auto wrap = [&](std::int32_t c, int k) {
      return static_cast<std::uint32_t>(c) & ((1u << bits[k]) - 1u);
    };
    return wrap(x, 0) | wrap(y, 1) << bits[0] | wrap(z, 2) << (bits[0] + bits[1]);
  }
};

}  // namespace

const std::vector<Pair>& BroadPhase::find_pairs(std::span<const Capsule> bounds_W,
                                                std::span<const std::uint8_t> moving, double margin,
                                                std::span<const Box> limits_W, Crew* crew) {
  Crew alone;
  if (!crew) crew = &alone;
  pairs_.clear();
  found_.clear();
  const Bodies bodies{bounds_W, moving, margin, limits_W};
  if (bounds_W.size() < 2 ||
      (!moving.empty() && std::find(moving.begin(), moving.end(), 1) == moving.end())) {
    boxes_.clear();
    return pairs_;
  }
  const double extent = make_boxes(bodies, *crew);
  if (bounds_W.size() <= kFew) {
    compare_all(bodies);
    return pairs_;
  }
  // Three times the usual body: most then lie in one or two cells.
  make_grid(std::max(3.0 * extent / static_cast<double>(bounds_W.size()), 1e-9), *crew);
  sort_into_slots();
  compare_in_slots(bodies, *crew);
  compare_large(bodies);
  sort_pairs();
  return pairs_;
}

/// @return  sum of the boxes' largest extents [m]
double BroadPhase::make_boxes(const Bodies& bodies, Crew& crew) {
  boxes_.resize(bodies.bounds_W.size());
  const Vec3 slack = Vec3::Constant(0.5 * bodies.margin);
  crew.share_range(boxes_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      boxes_[i] = box_around(bodies.bounds_W[i], 0.5 * bodies.margin);
      if (bodies.limits_W.empty()) continue;
      boxes_[i].low = boxes_[i].low.cwiseMax(bodies.limits_W[i].low - slack);
      boxes_[i].high = boxes_[i].high.cwiseMin(bodies.limits_W[i].high + slack);
    }
  });
  double extent = 0.0;
  for (const Box& box : boxes_) extent += (box.high - box.low).maxCoeff();
  return extent;
}

void BroadPhase::compare_all(const Bodies& bodies) {
  slots_.clear();
  const auto n = static_cast<std::uint32_t>(boxes_.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) {
      if (bodies.any_moves(i, j) && boxes_[i].meets(boxes_[j]) && bodies.meet(i, j)) {
        pairs_.push_back({i, j});
      }
    }
  }
}

/// Gives each body the cells that it covers, and chooses the size of the grid.
///
/// @param cell  edge of a cell [m]
void BroadPhase::make_grid(double cell, Crew& crew) {
  cells_per_metre_ = 1.0 / cell;
  const auto n = static_cast<std::uint32_t>(boxes_.size());
  cells_.resize(n);
  large_.clear();
  crew.share_range(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        cells_[i].low[k] = cell_of(boxes_[i].low[k], cells_per_metre_);
        cells_[i].high[k] = cell_of(boxes_[i].high[k], cells_per_metre_);
      }
    }
  });
  std::int32_t least[3] = {}, most[3] = {};
  bool any = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!((boxes_[i].high - boxes_[i].low).maxCoeff() <= 3.0 * cell)) {
      large_.push_back(i);
      continue;
    }
    const Cells& c = cells_[i];
    for (int k = 0; k < 3; ++k) {
      least[k] = any ? std::min(least[k], c.low[k]) : c.low[k];
      most[k] = any ? std::max(most[k], c.high[k]) : c.high[k];
    }
    any = true;
  }
  // The number of cells along each axis is a power of two, as wide as the bodies are spread, but the
  // grid has no more than four cells a body. A wider world wraps round it: cells that share a slot
  // cost comparisons, not errors.
  std::fill_n(bits_, 3, 0u);
  for (std::uint32_t slots = 1; slots < 4 * n; slots *= 2) {
    int widest = 0;
    double width[3];
    for (int k = 0; k < 3; ++k) {
      width[k] =
          std::ldexp(1.0 + most[k] - static_cast<double>(least[k]), -static_cast<int>(bits_[k]));
      if (width[k] > width[widest]) widest = k;
    }
    if (width[widest] <= 1.0) break;
    ++bits_[widest];
  }
}

/// Counting sort of the bodies by slot. Inside a slot they stay in order.
void BroadPhase::sort_into_slots() {
  const Slot slot{{bits_[0], bits_[1], bits_[2]}};
  unsorted_.clear();
  const std::uint32_t slots = 1u << (bits_[0] + bits_[1] + bits_[2]);
  slots_.assign(slots + 1, 0);
  std::size_t next_large = 0;
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    if (next_large < large_.size() && large_[next_large] == i) {
      ++next_large;
      continue;
    }
    const Cells& c = cells_[i];
    for (std::int32_t z = c.low[2]; z <= c.high[2]; ++z) {
      for (std::int32_t y = c.low[1]; y <= c.high[1]; ++y) {
        for (std::int32_t x = c.low[0]; x <= c.high[0]; ++x) {
          unsorted_.push_back({i, slot(x, y, z)});
          ++slots_[unsorted_.back().slot + 1];
        }
      }
    }
  }
  for (std::uint32_t k = 0; k < slots; ++k) slots_[k + 1] += slots_[k];
  count_.assign(slots_.begin(), slots_.end() - 1);
  entries_.resize(unsorted_.size());
  for (const Entry& e : unsorted_) entries_[count_[e.slot]++] = e.body;
}

void BroadPhase::compare_in_slot(const Bodies& bodies, std::uint32_t k,
                                 std::vector<Pair>& found) const {
  const Slot slot{{bits_[0], bits_[1], bits_[2]}};
  for (std::uint32_t i = slots_[k]; i < slots_[k + 1]; ++i) {
    for (std::uint32_t j = i + 1; j < slots_[k + 1]; ++j) {
      const std::uint32_t a = entries_[i], b = entries_[j];
      if (a == b || !bodies.any_moves(a, b) || !boxes_[a].meets(boxes_[b])) continue;
      // Two bodies may share several cells. Only the lowest of those that both boxes cover reports
      // them.
      const Cells &ca = cells_[a], &cb = cells_[b];
      if (slot(std::max(ca.low[0], cb.low[0]), std::max(ca.low[1], cb.low[1]),
               std::max(ca.low[2], cb.low[2])) != k) {
        continue;
      }
      if (bodies.meet(a, b)) found.push_back({a, b});
    }
  }
}

void BroadPhase::compare_in_slots(const Bodies& bodies, Crew& crew) {
  const std::size_t slots = slots_.size() - 1;
  const std::size_t parts = crew.threads() < 2 ? 1 : 1 + entries_.size() / Crew::kRange;
  if (found_in_.size() < parts) found_in_.resize(parts);
  crew.share(parts, [&](std::size_t part, std::size_t) {
    std::vector<Pair>& found = found_in_[part];
    found.clear();
    for (std::size_t k = part * slots / parts; k < (part + 1) * slots / parts; ++k) {
      compare_in_slot(bodies, static_cast<std::uint32_t>(k), found);
    }
  });
  for (std::size_t part = 0; part < parts; ++part) {
    found_.insert(found_.end(), found_in_[part].begin(), found_in_[part].end());
  }
}

/// Compares the bodies that cover many cells with all others.
void BroadPhase::compare_large(const Bodies& bodies) {
  for (const std::uint32_t i : large_) {
    for (std::uint32_t j = 0; j < boxes_.size(); ++j) {
      const bool twice = j < i && std::binary_search(large_.begin(), large_.end(), j);
      if (j == i || twice || !bodies.any_moves(i, j)) continue;
      if (boxes_[i].meets(boxes_[j]) && bodies.meet(i, j)) {
        found_.push_back({std::min(i, j), std::max(i, j)});
      }
    }
  }
}

/// By the first body with a counting sort, then by the second with insertion, as they are few.
void BroadPhase::sort_pairs() {
  const std::size_t n = boxes_.size();
  count_.assign(n + 1, 0);
  for (const Pair& p : found_) ++count_[p.first + 1];
  for (std::size_t i = 0; i < n; ++i) count_[i + 1] += count_[i];
  pairs_.resize(found_.size());
  for (const Pair& p : found_) pairs_[count_[p.first]++] = p;
  for (std::size_t i = 1; i < pairs_.size(); ++i) {
    for (std::size_t j = i; j > 0 && pairs_[j] < pairs_[j - 1]; --j) {
      std::swap(pairs_[j], pairs_[j - 1]);
    }
  }
  // Wrapped cells can report a pair twice.
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

void BroadPhase::find_near(const Capsule& bounds_W, std::vector<std::uint32_t>& out) const {
  out.clear();
  const Box box = box_around(bounds_W, 0.0);
  const auto test = [&](std::uint32_t i) {
    if (box.meets(boxes_[i])) out.push_back(i);
  };
  std::int32_t low[3], high[3];
  double cells = 1.0;
  for (int k = 0; k < 3; ++k) {
    low[k] = cell_of(box.low[k], cells_per_metre_);
    high[k] = cell_of(box.high[k], cells_per_metre_);
    cells *= 1.0 + high[k] - static_cast<double>(low[k]);
  }
  if (slots_.empty() || cells > static_cast<double>(boxes_.size())) {
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) test(i);
    return;
  }
  for (const std::uint32_t i : large_) test(i);
  const Slot slot{{bits_[0], bits_[1], bits_[2]}};
  for (std::int32_t z = low[2]; z <= high[2]; ++z) {
    for (std::int32_t y = low[1]; y <= high[1]; ++y) {
      for (std::int32_t x = low[0]; x <= high[0]; ++x) {
        const std::uint32_t k = slot(x, y, z);
        for (std::uint32_t e = slots_[k]; e < slots_[k + 1]; ++e) test(entries_[e]);
      }
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

}  // namespace headpin::engine
