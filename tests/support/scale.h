#pragma once

/// Long laws run on a part of their cases under sanitizers and without optimisation.
#if defined(HEADPIN_SANITIZED) || !defined(NDEBUG)
inline constexpr bool kThorough = false;
#else
inline constexpr bool kThorough = true;
#endif
