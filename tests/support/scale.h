#pragma once

/// Long laws run on a part of their cases under sanitizers and without optimisation.
#if defined(HEADPIN_SANITIZED) || !defined(NDEBUG)
inline constexpr bool kThorough = false;
#else
inline constexpr bool kThorough = true;
#endif

/// A number of cases: all, or a tenth of them where long laws run on a part.
constexpr int cases(int all) {
  return kThorough ? all : (all + 9) / 10;
}
