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

std::uint32_t hash(std::int32_t x, std::int32_t y, std::int32_t z) {
  return static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
         static_cast<std::uint32_t>(z) * 83492791u;
}

}  // namespace

const std::vector<Pair>& BroadPhase::find_pairs(std::span<const Capsule> bounds_W,
                                                std::span<const std::uint8_t> moving,
                                                double margin) {
  pairs_.clear();
  found_.clear();
  const std::size_t n = bounds_W.size();
  const auto moves = [&](std::size_t i) { return moving.empty() || moving[i] != 0; };
  if (n < 2 || (!moving.empty() && std::find(moving.begin(), moving.end(), 1) == moving.end())) {
    return pairs_;
  }

  boxes_.resize(n);
  double extent = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Capsule& c = bounds_W[i];
    const Vec3 r = Vec3::Constant(c.radius + 0.5 * margin);
    boxes_[i] = {c.a.cwiseMin(c.b) - r, c.a.cwiseMax(c.b) + r};
    extent += (boxes_[i].high - boxes_[i].low).maxCoeff();
  }
  const auto meet = [&](std::uint32_t i, std::uint32_t j) {
    const Box &a = boxes_[i], &b = boxes_[j];
    return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all() &&
           distance(bounds_W[i], bounds_W[j]) <= margin;
  };
  if (n <= kFew) {
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = i + 1; j < n; ++j) {
        if ((moves(i) || moves(j)) && meet(i, j)) pairs_.push_back({i, j});
      }
    }
    return pairs_;
  }
  // Twice the usual body: most then lie in one to four cells.
  const double cell = std::max(2.0 * extent / static_cast<double>(n), 1e-9);
  const double inverse = 1.0 / cell;
  const auto coordinate = [&](double x) {
    return static_cast<std::int32_t>(std::clamp(std::floor(x * inverse), -1e9, 1e9));
  };

  unsorted_.clear();
  large_.clear();
  for (std::uint32_t i = 0; i < n; ++i) {
    const Box& box = boxes_[i];
    if (!((box.high - box.low).maxCoeff() <= 4.0 * cell)) {
      large_.push_back(i);
      continue;
    }
    const Cell low{coordinate(box.low.x()), coordinate(box.low.y()), coordinate(box.low.z())};
    const Cell high{coordinate(box.high.x()), coordinate(box.high.y()), coordinate(box.high.z())};
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        for (std::int32_t x = low.x; x <= high.x; ++x) unsorted_.push_back({i, {x, y, z}});
      }
    }
  }

  // Counting sort by slot; bodies stay in order inside a slot.
  std::uint32_t slots = 16;
  while (slots < 2 * unsorted_.size()) slots *= 2;
  slots_.assign(slots + 1, 0);
  const auto slot = [&](const Cell& c) { return hash(c.x, c.y, c.z) & (slots - 1); };
  for (const Entry& e : unsorted_) ++slots_[slot(e.cell) + 1];
  for (std::uint32_t k = 0; k < slots; ++k) slots_[k + 1] += slots_[k];
  count_.assign(slots_.begin(), slots_.end() - 1);
  entries_.resize(unsorted_.size());
  for (const Entry& e : unsorted_) entries_[count_[slot(e.cell)]++] = e;

  for (std::uint32_t k = 0; k < slots; ++k) {
    for (std::uint32_t i = slots_[k]; i < slots_[k + 1]; ++i) {
      for (std::uint32_t j = i + 1; j < slots_[k + 1]; ++j) {
        const Entry &a = entries_[i], &b = entries_[j];
        if (a.cell.x != b.cell.x || a.cell.y != b.cell.y || a.cell.z != b.cell.z) continue;
        if (!moves(a.body) && !moves(b.body)) continue;
        // Both may share several cells: only the lowest of what the boxes share reports them.
        const Vec3 low = boxes_[a.body].low.cwiseMax(boxes_[b.body].low);
        if (coordinate(low.x()) != a.cell.x || coordinate(low.y()) != a.cell.y ||
            coordinate(low.z()) != a.cell.z) {
          continue;
        }
        if (meet(a.body, b.body)) found_.push_back({a.body, b.body});
      }
    }
  }
  for (const std::uint32_t i : large_) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const bool twice = j < i && std::binary_search(large_.begin(), large_.end(), j);
      if (j == i || twice || (!moves(i) && !moves(j))) continue;
      if (meet(i, j)) found_.push_back({std::min(i, j), std::max(i, j)});
    }
  }

  // By first body: counting sort; by second: few, so insertion.
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
  return pairs_;
}

}  // namespace headpin::engine
