#include "study/allotment.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "base/random.h"

namespace headpin::study {

namespace {

// Purposes of random numbers.
constexpr std::uint64_t kPlaces = 101, kOrders = 102;

template <typename T>
void shuffle(std::span<T> all, Random& random) {
  for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random.next() % i]);
}

/// The row of every place of a block; rows with the same changed parameter are next to each other.
std::vector<std::size_t> rows_of_block(const Design& design) {
  std::vector<std::size_t> rows(design.rows.size()), places;
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return design.rows[row].changed; });
  for (const std::size_t row : rows) {
    places.insert(places.end(), static_cast<std::size_t>(design.rows[row].people), row);
  }
  return places;
}

/// Order and colour of every place, as two bits. In each pair of places, both bits are opposite.
std::vector<unsigned> orders_of_block(const Design& design, const std::vector<std::size_t>& rows,
                                      std::uint64_t seed, std::int64_t block) {
  Random random(seed, kOrders, static_cast<std::uint64_t>(block / 4));
  unsigned pair = random.next() & 1;
  std::vector<unsigned> orders;
  for (std::size_t begin = 0; begin < rows.size();) {
    const std::size_t changed = design.rows[rows[begin]].changed;
    std::size_t end = begin;
    while (end < rows.size() && design.rows[rows[end]].changed == changed) ++end;
    while (orders.size() < end) {
      const unsigned one = pair ^ (random.next() & 1 ? 3u : 0u);
      orders.push_back(one);
      if (orders.size() < end) orders.push_back(one ^ 3u);
      pair ^= 1u;
    }
    shuffle(std::span(orders).subspan(begin, end - begin), random);
    begin = end;
  }
  for (unsigned& order : orders) order ^= static_cast<unsigned>(block % 4);
  return orders;
}

}  // namespace

Allotted allot(const Design& design, std::uint64_t seed, std::int64_t place) {
  const std::vector<std::size_t> rows = rows_of_block(design);
  const auto size = static_cast<std::int64_t>(rows.size());
  const std::int64_t block = place / size;
  const std::vector<unsigned> orders = orders_of_block(design, rows, seed, block);
  std::vector<std::size_t> at(rows.size());
  std::iota(at.begin(), at.end(), std::size_t{0});
  Random random(seed, kPlaces, static_cast<std::uint64_t>(block));
  shuffle(std::span(at), random);
  const std::size_t which = at[static_cast<std::size_t>(place % size)];
  return {rows[which], (orders[which] & 1) != 0, (orders[which] & 2) != 0};
}

}  // namespace headpin::study
