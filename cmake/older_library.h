#pragma once

#include <version>

/// The algorithms over ranges and the cast of bits that our sources use, for a standard library that
/// has none yet, as that of Debian 12's emscripten; the former from its algorithms over iterators.
#ifndef __cpp_lib_ranges

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace std::ranges {

template <typename R, typename T, typename P = std::identity>
auto find(R&& range, const T& value, P of = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& x) { return std::invoke(of, x) == value; });
}

template <typename R, typename F, typename P = std::identity>
auto find_if(R&& range, F is, P of = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& x) { return std::invoke(is, std::invoke(of, x)); });
}

template <typename R, typename F, typename P = std::identity>
bool all_of(R&& range, F is, P of = {}) {
  return std::all_of(std::begin(range), std::end(range),
                     [&](const auto& x) { return std::invoke(is, std::invoke(of, x)); });
}

template <typename R, typename F>
bool any_of(R&& range, F is) {
  return std::any_of(std::begin(range), std::end(range),
                     [&](const auto& x) { return std::invoke(is, x); });
}

template <typename R, typename F>
bool none_of(R&& range, F is) {
  return !any_of(range, is);
}

template <typename R, typename F>
auto count_if(R&& range, F is) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](const auto& x) { return std::invoke(is, x); });
}

template <typename A, typename B>
bool equal(A&& a, B&& b) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b));
}

template <typename R, typename T>
void fill(R&& range, const T& value) {
  std::fill(std::begin(range), std::end(range), value);
}

template <typename R, typename O>
void copy(R&& range, O out) {
  std::copy(std::begin(range), std::end(range), out);
}

template <typename R, typename O, typename F>
void transform(R&& range, O out, F of) {
  std::transform(std::begin(range), std::end(range), out,
                 [&](const auto& x) { return std::invoke(of, x); });
}

template <typename R>
void reverse(R&& range) {
  std::reverse(std::begin(range), std::end(range));
}

template <typename R, typename C = std::less<>, typename P = std::identity>
void sort(R&& range, C before = {}, P of = {}) {
  std::sort(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return std::invoke(before, std::invoke(of, a), std::invoke(of, b));
  });
}

template <typename R, typename C = std::less<>, typename P = std::identity>
void stable_sort(R&& range, C before = {}, P of = {}) {
  std::stable_sort(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return std::invoke(before, std::invoke(of, a), std::invoke(of, b));
  });
}

template <typename R, typename I, typename C = std::less<>, typename P = std::identity>
void nth_element(R&& range, I nth, C before = {}, P of = {}) {
  std::nth_element(std::begin(range), nth, std::end(range), [&](const auto& a, const auto& b) {
    return std::invoke(before, std::invoke(of, a), std::invoke(of, b));
  });
}

template <typename R, typename T, typename C = std::less<>, typename P = std::identity>
auto upper_bound(R&& range, const T& value, C before = {}, P of = {}) {
  return std::upper_bound(
      std::begin(range), std::end(range), value,
      [&](const auto& x, const auto& y) { return std::invoke(before, x, std::invoke(of, y)); });
}

template <typename R, typename T, typename C = std::less<>, typename P = std::identity>
auto lower_bound(R&& range, const T& value, C before = {}, P of = {}) {
  return std::lower_bound(
      std::begin(range), std::end(range), value,
      [&](const auto& x, const auto& y) { return std::invoke(before, std::invoke(of, x), y); });
}

}  // namespace std::ranges

#endif

#ifndef __cpp_lib_bit_cast

namespace std {

template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}

}  // namespace std

#endif
