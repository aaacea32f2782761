#pragma once

// Full inlining saves a third of the time of a search, and a tenth of a step in the solution of
// islands. In a sanitizer build it costs minutes, because every copy has its own checks; there the
// compiler decides.
#ifdef HEADPIN_SANITIZED
#define HEADPIN_INLINE
#define HEADPIN_FLATTEN
#else
#define HEADPIN_INLINE __attribute__((always_inline))
#define HEADPIN_FLATTEN __attribute__((flatten))
#endif

/// For functions that run rarely or have many callers. With a copy in every caller, the search takes
/// half as long again to compile.
#define HEADPIN_OUT_OF_LINE __attribute__((noinline))
